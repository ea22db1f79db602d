"""Found failures as scenarios of a suite: files that carry what is expected in them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from drivora_service.errors import ConfigurationError, InvalidDocument
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.scenario.documents import ScenarioDocument, document_text, parse_document
from drivora_service.suites.suite_documents import EXTENSION
from drivora_service.suites.suite_results import scenario_hash

_FOLDER = "scenarios"
_SUITE_FILE = "suite.yaml"
_LONGEST_NAME = 80


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundScenario:
    """A scenario in which a failure was found.

    Attributes:
        stem: Beginning of its name; a number makes it unique.
        tags: Words by which it can be chosen.
        definition: What counts as a failure in it: what its campaign counted.
        comment: Where it comes from, and what happened.
    """

    stem: str
    document: ScenarioDocument
    tags: tuple[str, ...]
    definition: FailureDefinition
    comment: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Exported:
    """What was written to a suite.

    Attributes:
        added: Files of new scenarios.
        known: Scenarios that the suite had already.
        suite_file: The file of the suite.
        is_new: Whether that was written, too.
    """

    added: tuple[Path, ...]
    known: int
    suite_file: Path
    is_new: bool


def export_scenarios(folder: Path, scenarios: Iterable[FoundScenario], *, name: str) -> Exported:
    """Adds scenarios to a suite; those that it has stay as they are, and none is added twice.

    Args:
        folder: Folder of the suite, with ``suite.yaml`` and ``scenarios``; made if it is missing.
        scenarios: The scenarios.
        name: Name of a new suite.

    Raises:
        ConfigurationError: The folder holds a file that cannot be read as a scenario.
        OSError: A file cannot be written.
    """
    inside = folder / _FOLDER
    known = _read_hashes(inside)
    taken = {path.stem for path in inside.glob("*")} if inside.is_dir() else set()
    inside.mkdir(parents=True, exist_ok=True)
    added: list[Path] = []
    repeated = 0
    for one in scenarios:
        digest = scenario_hash(one.document)
        if digest in known:
            repeated += 1
            continue
        known.add(digest)
        path = inside / f"{_unique(one.stem, taken)}.json"
        path.write_text(document_text(_with_expectations(one)))
        added.append(path)
    suite_file = folder / _SUITE_FILE
    is_new = not suite_file.exists()
    if is_new:
        content: Mapping[str, Any] = {"name": name, "scenarios": [f"{_FOLDER}/*.json"]}
        suite_file.write_text(yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True))
    return Exported(added=tuple(added), known=repeated, suite_file=suite_file, is_new=is_new)


def slug(parts: Sequence[str]) -> str:
    """Returns words as a name that is good for a file."""
    text = re.sub(r"[^a-z0-9]+", "-", "-".join(parts).lower()).strip("-")
    return text[:_LONGEST_NAME].rstrip("-") or "scenario"


def tag(text: str) -> str:
    """Returns a text as a tag."""
    return re.sub(r"[^A-Za-z0-9_.:-]+", "-", text).strip("-")[:64] or "-"


def _with_expectations(one: FoundScenario) -> ScenarioDocument:
    expected: dict[str, Any] = {"tags": list(one.tags), "counts": str(one.definition.counts)}
    if one.definition.oracles is not None:
        expected["oracles"] = list(one.definition.oracles)
    expected["comment"] = one.comment
    extensions = {**one.document.extensions, EXTENSION: expected}
    return one.document.model_copy(update={"extensions": extensions})


def _read_hashes(folder: Path) -> set[str]:
    known: set[str] = set()
    for path in sorted(folder.glob("*.json")) if folder.is_dir() else ():
        try:
            known.add(scenario_hash(parse_document(path.read_bytes(), "json")))
        except (InvalidDocument, OSError, json.JSONDecodeError) as error:
            raise ConfigurationError(
                f"{path} cannot be read as a scenario, so that it is not known whether it is "
                f"there already: {error}"
            ) from error
    return known


def _unique(stem: str, taken: set[str]) -> str:
    number = 1
    while f"{stem}-{number}" in taken:
        number += 1
    name = f"{stem}-{number}"
    taken.add(name)
    return name
