"""Scenario files and folders that are named on the command line."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from drivora_service.errors import ConfigurationError, InvalidDocument, Problem
from drivora_service.known_names import similar_names
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.importers.reading import read_scenarios

SUFFIXES = frozenset({".json", ".yaml", ".yml", ".xml"})


_RESULTS = {
    "campaign.json": {"tester", "budget", "failures"},
    "cards.json": {"cards"},
    "comparison.json": {"baseline"},
}
"""Files that commands write, by name, with keys that no scenario has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioFile:
    """A scenario that was found.

    Attributes:
        name: Unique among those that were read together; good for a file name.
        path: Path of its file.
        notes: Remarks of the importer on dropped or interpreted parts.
    """

    name: str
    path: Path
    document: ScenarioDocument
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class UnreadableFile:
    """A file that holds no scenario, and why."""

    path: Path
    problems: tuple[Problem, ...]


def find_files(paths: Sequence[Path]) -> tuple[Path, ...]:
    """Returns the files themselves, and those inside folders, in order of name.

    Raises:
        ConfigurationError: Paths do not exist, of which all are named, or a folder holds no
            scenario file.
    """
    found: list[Path] = []
    missing = [path for path in paths if not path.exists()]
    if missing:
        raise ConfigurationError("\n".join(map(describe_missing, missing)))
    for path in paths:
        if path.is_dir():
            files = sorted(p for p in path.rglob("*") if p.suffix.lower() in SUFFIXES)
            inside = [file for file in files if not describe_results_file(file)]
            if files and not inside:
                raise ConfigurationError(
                    f"{path} holds results and no scenario: {', '.join(f.name for f in files[:5])}"
                )
            if not inside:
                raise ConfigurationError(
                    f"{path} holds no scenario file ({', '.join(sorted(SUFFIXES))})"
                )
            found += inside
        else:
            found.append(path)
    return tuple(found)


def describe_missing(path: Path) -> str:
    """Returns the message for a path that does not exist, with a name that is there instead."""
    folder = path.parent
    if not folder.is_dir():
        return f"there is no file {path}: there is no folder {folder}"
    # Endings are alike without being meant.
    names = {one.stem: one.name for one in sorted(folder.iterdir(), reverse=True)}
    close = similar_names(path.stem, names)
    meant = f"; did you mean {str(folder / names[close[0]])!r}?" if close else ""
    return f"there is no file {path}{meant}"


def describe_unreadable(path: Path, error: OSError) -> str:
    """Returns the message for a file that cannot be read."""
    if isinstance(error, FileNotFoundError):
        return describe_missing(path)
    return f"{path} cannot be read: {error.strerror}"


def read_files(
    paths: Sequence[Path], *, agent: str
) -> tuple[tuple[ScenarioFile, ...], tuple[UnreadableFile, ...]]:
    """Reads every scenario of files of any known format.

    Args:
        paths: Files and folders.
        agent: Drives egos of formats that name no agent of the catalogue.

    Raises:
        ConfigurationError: A path cannot be used at all. If some do not exist, the problems of the
            others are named, too.
    """
    missing = [path for path in paths if not path.exists()]
    if missing:
        there = [path for path in paths if path.exists()]
        _, unreadable_files = read_files(there, agent=agent)
        lines = [describe_missing(path) for path in missing]
        lines += [
            f"{one.path}: {problem.pointer or '/'}: {problem.message}"
            for one in unreadable_files
            for problem in one.problems
        ]
        raise ConfigurationError("\n".join(lines))
    scenarios: list[ScenarioFile] = []
    unreadable: list[UnreadableFile] = []
    taken: set[str] = set()
    for path in find_files(paths):
        try:
            result = describe_results_file(path)
            if result:
                raise InvalidDocument((Problem(pointer="", code="no_scenario", message=result),))
            imported = read_scenarios(path.read_bytes(), name=path.stem, agent=agent or "idm")
        except InvalidDocument as error:
            unreadable.append(UnreadableFile(path=path, problems=error.problems))
            continue
        except OSError as error:
            raise ConfigurationError(describe_unreadable(path, error)) from error
        for scenario in imported:
            name = unique_name(scenario.name, taken)
            scenarios.append(
                ScenarioFile(name=name, path=path, document=scenario.document, notes=scenario.notes)
            )
    return tuple(scenarios), tuple(unreadable)


def describe_results_file(path: Path) -> str:
    """Says what a file of results is, which commands write beside scenarios; "" of any other."""
    if path.name.endswith(".report.json"):
        return "found the report of a run; run the scenario that it is about"
    keys = _RESULTS.get(path.name)
    if keys is None or not path.is_file():
        return ""
    try:
        content = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return ""
    if not isinstance(content, dict) or not keys <= content.keys():
        return ""
    return "found the results of a command of Drivora; run the scenarios beside it"


def unique_name(name: str, taken: set[str]) -> str:
    """Returns a name that is not taken, with a number at its end if need be, and takes it."""
    candidate, number = name, 2
    while candidate in taken:
        candidate, number = f"{name}-{number}", number + 1
    taken.add(candidate)
    return candidate
