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
        kept: Those of them that count other failures than was asked for, as their files say.
        suite_file: The file of the suite.
        is_new: Whether that was written, too.
    """

    added: tuple[Path, ...]
    known: int
    kept: tuple[Path, ...]
    suite_file: Path
    is_new: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class _Known:
    """A scenario of the suite, with what its file says on failures: `counts` and `oracles`."""

    path: Path
    expected: Mapping[str, Any]


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
    known = _read_known(inside)
    taken = {path.stem for path in inside.glob("*")} if inside.is_dir() else set()
    inside.mkdir(parents=True, exist_ok=True)
    added: list[Path] = []
    kept: dict[Path, None] = {}
    repeated = 0
    for one in scenarios:
        digest = scenario_hash(one.document)
        if digest in known:
            repeated += 1
            if known[digest].expected != _counted(one.definition):
                kept[known[digest].path] = None
            continue
        path = inside / f"{_unique(one.stem, taken)}.json"
        known[digest] = _Known(path=path, expected=_counted(one.definition))
        path.write_text(document_text(_with_expectations(one)))
        added.append(path)
    suite_file = folder / _SUITE_FILE
    is_new = not suite_file.exists()
    if is_new:
        content: Mapping[str, Any] = {"name": name, "scenarios": [f"{_FOLDER}/*.json"]}
        suite_file.write_text(yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True))
    return Exported(
        added=tuple(added),
        known=repeated,
        kept=tuple(kept),
        suite_file=suite_file,
        is_new=is_new,
    )


def slug(parts: Sequence[str]) -> str:
    """Returns words as a name that is good for a file."""
    text = re.sub(r"[^a-z0-9]+", "-", "-".join(parts).lower()).strip("-")
    return text[:_LONGEST_NAME].rstrip("-") or "scenario"


def tag(text: str) -> str:
    """Returns a text as a tag."""
    return re.sub(r"[^A-Za-z0-9_.:-]+", "-", text).strip("-")[:64] or "-"


def _with_expectations(one: FoundScenario) -> ScenarioDocument:
    expected = {"tags": list(one.tags), **_counted(one.definition), "comment": one.comment}
    extensions = {**one.document.extensions, EXTENSION: expected}
    return one.document.model_copy(update={"extensions": extensions})


def _counted(definition: FailureDefinition) -> dict[str, Any]:
    """Returns what counts as a failure, as the file of a scenario says it."""
    counts = {"counts": str(definition.counts)}
    if definition.oracles is None:
        return counts
    return {**counts, "oracles": sorted(definition.oracles)}


def _read_known(folder: Path) -> dict[str, _Known]:
    """Returns the scenarios that are there by their hashes."""
    known: dict[str, _Known] = {}
    for path in sorted(folder.glob("*.json")) if folder.is_dir() else ():
        try:
            document = parse_document(path.read_bytes(), "json")
        except (InvalidDocument, OSError, json.JSONDecodeError) as error:
            raise ConfigurationError(
                f"{path} cannot be read as a scenario, so that it is not known whether it is "
                f"there already: {error}"
            ) from error
        known.setdefault(scenario_hash(document), _Known(path=path, expected=_expected(document)))
    return known


def _expected(document: ScenarioDocument) -> dict[str, Any]:
    """Returns what a scenario says itself on what counts as a failure in it."""
    carried = document.extensions.get(EXTENSION)
    if not isinstance(carried, Mapping):
        return {}
    said: dict[str, Any] = {
        key: carried[key] for key in ("counts", "oracles") if carried.get(key) is not None
    }
    oracles = said.get("oracles")
    return said if not isinstance(oracles, list) else {**said, "oracles": sorted(map(str, oracles))}


def _unique(stem: str, taken: set[str]) -> str:
    number = 1
    while f"{stem}-{number}" in taken:
        number += 1
    name = f"{stem}-{number}"
    taken.add(name)
    return name
