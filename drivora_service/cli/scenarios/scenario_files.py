"""Scenario files and folders that are named on the command line."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from drivora_service.cli.scenarios.other_files import NO_SCENARIO, describe_other_file
from drivora_service.cli.terminal.output import note
from drivora_service.errors import ConfigurationError, InvalidDocument, Problem
from drivora_service.known_names import similar_names
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.importers.reading import read_scenarios

SUFFIXES = frozenset({".json", ".yaml", ".yml", ".xml"})
_MOST_FOLDERS = 5
"""Folders that are listed by name."""

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

    @property
    def other(self) -> str:
        """What it is, with its path and the command that reads it; "" if that is not known."""
        first = self.problems[0]
        return f"{self.path} {first.message}" if first.code == NO_SCENARIO else ""


def find_files(paths: Sequence[Path]) -> tuple[Path, ...]:
    """Returns the files themselves, and those inside folders, in order of name.

    Raises:
        ConfigurationError: Paths do not exist, of which all are named, or a folder holds no
            scenario file.
    """
    missing = [path for path in paths if not path.exists()]
    if missing:
        raise ConfigurationError("\n".join(map(describe_missing, missing)))
    return tuple(file for file, _ in _find_files(paths))


def _find_files(paths: Sequence[Path]) -> Iterator[tuple[Path, Path | None]]:
    """Yields the files, each with the folder of ``paths`` that it was found in, if any."""
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
            yield from ((file, path) for file in inside)
        else:
            yield path, None


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
        paths: Files and folders. Files of campaigns, suites and the like in a folder are left out,
            each with a note on standard error.
        agent: Drives egos of formats that name no agent of the catalogue.

    Raises:
        ConfigurationError: A path cannot be used at all, or there is no scenario. If some paths do
            not exist, the problems of the others are named, too.
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
    for path, folder in _find_files(paths):
        try:
            result = describe_results_file(path)
            if result:
                raise _no_scenario(result)
            imported = read_scenarios(path.read_bytes(), name=path.stem, agent=agent or "idm")
        except InvalidDocument as error:
            other = describe_other_file(path)
            if other and folder is not None:
                note(f"skipped: {path} {other}")
                continue
            problems = _no_scenario(other).problems if other else error.problems
            unreadable.append(UnreadableFile(path=path, problems=problems))
            continue
        except OSError as error:
            raise ConfigurationError(describe_unreadable(path, error)) from error
        for scenario in imported:
            name = unique_name(scenario.name, taken)
            scenarios.append(
                ScenarioFile(name=name, path=path, document=scenario.document, notes=scenario.notes)
            )
    if paths and not scenarios and not unreadable:
        raise ConfigurationError(f"no scenario in {', '.join(map(str, paths))}")
    return tuple(scenarios), tuple(unreadable)


def folder_sentence(files: Sequence[ScenarioFile]) -> str:
    """Returns how many scenarios there are in which folders."""
    counts = Counter(str(file.path.parent) for file in files)
    listed = [f"{number} in {folder}" for folder, number in counts.items()]
    shown = ", ".join(listed[:_MOST_FOLDERS])
    more = len(listed) - _MOST_FOLDERS
    few = "1 scenario" if len(files) == 1 else f"{len(files)} scenarios"
    folders = "1 folder" if len(counts) == 1 else f"{len(counts)} folders"
    return f"{few} in {folders}: {shown}" + (f" and {more} more folders" if more > 0 else "")


def _no_scenario(message: str) -> InvalidDocument:
    return InvalidDocument((Problem(pointer="", code=NO_SCENARIO, message=message),))


def describe_results_file(path: Path) -> str:
    """Says what a file of results is, which commands write beside scenarios; "" of any other."""
    if path.name.endswith(".report.json"):
        return "is the report of a run; run the scenario that it is about"
    keys = _RESULTS.get(path.name)
    if keys is None or not path.is_file():
        return ""
    try:
        content = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return ""
    if not isinstance(content, dict) or not keys <= content.keys():
        return ""
    return "holds the results of a command of Drivora; run the scenarios beside it"


def unique_name(name: str, taken: set[str]) -> str:
    """Returns a name that is not taken, with a number at its end if need be, and takes it."""
    candidate, number = name, 2
    while candidate in taken:
        candidate, number = f"{name}-{number}", number + 1
    taken.add(candidate)
    return candidate
