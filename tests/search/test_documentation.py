"""The reference names every tester, mutation and selection, and every parameter."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from drivora_service.parameters import describe_parameters
from drivora_service.search.catalogue import BUILT_IN, BUILT_IN_MUTATIONS, BUILT_IN_SELECTIONS
from drivora_service.search.plugin import TesterPlugin


@pytest.mark.parametrize("plugin", BUILT_IN, ids=lambda plugin: plugin.name)
def test_the_page_of_a_tester_names_its_parameters_and_their_defaults(
    plugin: TesterPlugin[Any], repository: Path
) -> None:
    page = repository / "docs" / "reference" / "testers" / f"{plugin.name}.md"
    rows = re.findall(r"^\| `(\w+)` \| ([^|]*) \|", page.read_text(), re.MULTILINE)
    for field in fields(plugin.parameters):
        written = [default.split()[0] for name, default in rows if name == field.name]
        assert any(_says(word, field.default) for word in written), (field.name, written)


@pytest.mark.parametrize("plugin", BUILT_IN, ids=lambda plugin: plugin.name)
def test_the_page_of_a_tester_names_the_bounds_of_whole_numbers(
    plugin: TesterPlugin[Any], repository: Path
) -> None:
    page = repository / "docs" / "reference" / "testers" / f"{plugin.name}.md"
    rows = page.read_text().splitlines()
    for one in describe_parameters(plugin.parameters):
        if one.schema.get("type") == "integer":
            bound = "[the budget](index.md#bounds) and " if "x-within-budget" in one.schema else ""
            said = f"at most {bound}{one.schema['maximum']:,} |"
            assert any(row.startswith(f"| `{one.name}` |") and said in row for row in rows), one


def _says(word: str, default: object) -> bool:
    if isinstance(default, bool) or not isinstance(default, int | float):
        return word.lower() == str(default).lower()
    try:
        return float(word.replace(",", "")) == pytest.approx(default, rel=1e-3)
    except ValueError:
        return False


def test_the_index_names_every_tester_mutation_and_selection(repository: Path) -> None:
    index = (repository / "docs" / "reference" / "testers" / "index.md").read_text()
    testers = set(re.findall(r"^\| \[`([\w-]+)`\]\(\1\.md\) \|", index, re.MULTILINE))
    assert testers == {plugin.name for plugin in BUILT_IN}
    for heading, plugins in (
        ("### Mutations", BUILT_IN_MUTATIONS),
        ("### Selections", BUILT_IN_SELECTIONS),
    ):
        section = index.split(heading)[1].split("##")[0]
        named = set(re.findall(r"^\| `([\w-]+)` \|", section, re.MULTILINE))
        assert named == {plugin.name for plugin in plugins}
