"""Found failures as scenarios of a suite."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.suites.suite_documents import ExpectationsDocument
from drivora_service.suites.suite_exporting import FoundScenario, export_scenarios, slug, tag
from drivora_service.suites.suite_reading import read_suite
from drivora_service.suites.suite_results import scenario_hash
from tests.suites.made_results import DOCUMENT


def found(seed: int, **changes: object) -> FoundScenario:
    values = {
        "stem": "town-collision",
        "document": DOCUMENT.model_copy(update={"seed": seed}),
        "tags": ("collision", "found-by-random"),
        "definition": FailureDefinition(counts=Counted.AT_FAULT, oracles=("collision",)),
        "comment": "Collided. Found by random.",
    }
    return FoundScenario(**(values | changes))  # type: ignore[arg-type]  # values by name


def documents(folder: Path) -> dict[str, ScenarioDocument]:
    return {
        path.name: parse_document(path.read_bytes(), "json")
        for path in sorted((folder / "scenarios").iterdir())
    }


def test_a_new_suite_lists_its_scenarios_by_a_pattern(tmp_path: Path) -> None:
    done = export_scenarios(tmp_path / "suite", [found(1), found(2)], name="found")
    assert [path.name for path in done.added] == ["town-collision-1.json", "town-collision-2.json"]
    assert done.is_new
    content = yaml.safe_load((tmp_path / "suite" / "suite.yaml").read_text())
    assert content == {"name": "found", "scenarios": ["scenarios/*.json"]}
    read = read_suite(
        {
            "name": "found",
            "scenarios": [
                {"name": name, "document": one.model_dump(exclude_none=True, mode="json")}
                for name, one in documents(tmp_path / "suite").items()
            ],
        },
        oracles=["collision"],
        metrics=[],
    )
    assert {one.oracles for one in read.scenarios} == {frozenset({"collision"})}
    assert {one.counts for one in read.scenarios} == {Counted.AT_FAULT}
    assert {one.tags for one in read.scenarios} == {("collision", "found-by-random")}
    # What is expected of an ADS is no part of what is driven.
    assert scenario_hash(read.scenarios[0].document) == scenario_hash(found(1).document)


def test_no_scenario_is_added_twice_and_none_is_changed(tmp_path: Path) -> None:
    export_scenarios(tmp_path, [found(1), found(1)], name="found")
    (tmp_path / "suite.yaml").write_text("# mine\nname: mine\nscenarios: [scenarios/*.json]\n")
    before = {path.name: path.read_text() for path in (tmp_path / "scenarios").iterdir()}
    assert list(before) == ["town-collision-1.json"]
    again = found(1, comment="Found again.", tags=("other",))
    done = export_scenarios(tmp_path, [again, found(3)], name="found")
    assert ([path.name for path in done.added], done.known) == (["town-collision-2.json"], 1)
    assert not done.is_new
    assert (tmp_path / "suite.yaml").read_text().startswith("# mine")
    assert (tmp_path / "scenarios" / "town-collision-1.json").read_text() == before[
        "town-collision-1.json"
    ]


def test_scenarios_that_stay_and_count_other_failures_are_named(tmp_path: Path) -> None:
    export_scenarios(tmp_path, [found(1), found(2)], name="found")
    assert export_scenarios(tmp_path, [found(1), found(2)], name="found").kept == ()
    others = replace(
        found(2), definition=FailureDefinition(counts=Counted.ANY, oracles=("collision",))
    )
    before = (tmp_path / "scenarios" / "town-collision-2.json").read_text()
    done = export_scenarios(tmp_path, [found(1), others, others], name="found")
    assert [path.name for path in done.kept] == ["town-collision-2.json"]
    assert done.kept[0].read_text() == before


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "scenarios" / "other.json").write_text("{}")
    with pytest.raises(ConfigurationError, match=r"other.json cannot be read as a scenario"):
        export_scenarios(tmp_path, [found(1)], name="found")
    assert [path.name for path in tmp_path.rglob("*.json")] == ["other.json"]


@given(st.lists(st.text(), max_size=3))
def test_names_and_tags_are_good_for_files_and_suites(parts: list[str]) -> None:
    assert re.fullmatch(r"[a-z0-9]([a-z0-9-]{0,78}[a-z0-9])?", slug(parts))
    for part in parts:
        ExpectationsDocument(tags=(tag(part),))
