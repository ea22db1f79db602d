"""Suite files and gate files that are named on the command line."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from drivora_service.cli.scenarios.file_problems import read_both_or_exit
from drivora_service.cli.scenarios.listed_scenarios import ListFile, expand_list, read_list_draft
from drivora_service.cli.scenarios.scenario_files import SUFFIXES
from drivora_service.errors import ConfigurationError, InvalidDocument
from drivora_service.known_names import advise_name
from drivora_service.scenario.plain_data import plain_data
from drivora_service.scenario.scenario_schema import schema_directory
from drivora_service.store.campaigns.study_records import LONGEST_LABEL
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gate_reading import read_gate_document
from drivora_service.suites.suite import Suite
from drivora_service.suites.suite_reading import read_suite
from drivora_service.suites.suite_results import SuiteResults

_NAMES = ("suite.yaml", "suite.yml", "suite.json")


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownNames:
    """The names that a suite or a gate may use: of oracles and of metrics."""

    oracles: Collection[str]
    metrics: Collection[str]


def with_names_of(results: SuiteResults, known: KnownNames) -> KnownNames:
    """Returns known names with those of results, whose packages need not be installed here."""
    return KnownNames(
        oracles=tuple(dict.fromkeys((*known.oracles, *sorted(results.judged_by)))),
        metrics=tuple(dict.fromkeys((*known.metrics, *sorted(results.measured)))),
    )


class NotedNames(Collection[str]):
    """Names that accept any other name, and remember those that they do not have.

    Attributes:
        missing: The other names, each once.
    """

    def __init__(self, known: Collection[str]) -> None:
        """Takes the names that there are."""
        self._known = known
        self.missing: dict[str, None] = {}

    def __contains__(self, name: object) -> bool:
        """Returns true; remembers a name that is not among the known ones."""
        if name not in self._known:
            self.missing[str(name)] = None
        return True

    def __iter__(self) -> Iterator[str]:
        """Yields the known names."""
        return iter(self._known)

    def __len__(self) -> int:
        """Returns the number of the known names."""
        return len(self._known)


def describe_missing_oracles(names: Iterable[str]) -> Iterator[str]:
    """Yields a note for each oracle of a suite that is not installed."""
    for name in names:
        yield f"note: oracle {name!r} is not installed; without its package the suite cannot be run"


def names_of_installation(data_dir: Path | None = None) -> KnownNames:
    """Returns the names that this installation knows, with the laws beside a data folder."""
    from drivora_service.cli.application.installation import oracle_catalogue, settings_for
    from drivora_service.metrics.catalogue import MetricCatalogue

    oracles = oracle_catalogue(settings_for(data_dir))
    return KnownNames(oracles=oracles.names(), metrics=MetricCatalogue().names())


def shipped_suites() -> Path:
    """Returns the folder of the shipped suites, a folder each."""
    return schema_directory() / "suites"


def read_suite_path(path: Path, known: KnownNames) -> Suite:
    """Reads a suite.

    Args:
        path: A suite file; a folder with one (``suite.yaml``); a folder of scenario files, or one
            such file, which is then a suite without expectations of its own; or the name of a
            shipped suite, if there is nothing of that name in the current folder.
        known: Names that it may use.

    Raises:
        ConfigurationError: There is no such file.
        InvalidDocument: It has problems; each is named with its place in its file.
    """
    file = _list_file(path)
    try:
        suite = read_suite(file.content, oracles=known.oracles, metrics=known.metrics)
    except InvalidDocument as error:
        raise file.in_file(error) from error
    if file.problems:
        raise InvalidDocument(file.problems)
    return suite


def read_suite_and_gate(
    suite: Path, gate: Path | None, known: KnownNames
) -> tuple[Suite, GateDocument]:
    """Reads a suite and a gate file; prints the problems of both and ends the command if any.

    Raises:
        ConfigurationError: One of them cannot be read.
    """
    return read_both_or_exit(
        (suite, lambda: read_suite_path(suite, known)),
        (gate or "the gate", lambda: read_gate_path(gate, known)),
    )


def read_gate_path(path: Path | None, known: KnownNames) -> GateDocument:
    """Reads a gate file; ``None``: the default gate.

    Raises:
        ConfigurationError: It cannot be read.
        InvalidDocument: It has problems; each is named with its place.
    """
    if path is None:
        return GateDocument()
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read: {error.strerror}") from error
    language: Literal["json", "yaml"] = "json" if path.suffix.lower() == ".json" else "yaml"
    return read_gate_document(data, oracles=known.oracles, metrics=known.metrics, format=language)


def _list_file(path: Path) -> ListFile:
    if path.is_dir():
        for name in _NAMES:
            if (path / name).is_file():
                return _suite_file(path / name)
        return _bare(path.resolve().name, ".", path)
    if not path.is_file():
        shipped = sorted(one.parent.name for one in shipped_suites().glob("*/suite.yaml"))
        if str(path) in shipped:
            return _list_file(shipped_suites() / path)
        raise ConfigurationError(
            f"there is no suite {path}; {advise_name(str(path), shipped, word='shipped')}. Name a "
            "file, a folder, or a shipped suite"
        )
    if path.suffix.lower() not in SUFFIXES:
        raise ConfigurationError(
            f"{path} is no suite: a file ends with one of {', '.join(sorted(SUFFIXES))}"
        )
    if path.suffix.lower() == ".xml" or not _lists_scenarios(path):
        return _bare(path.stem, path.name, path.parent)
    return _suite_file(path)


def _suite_file(path: Path) -> ListFile:
    return read_list_draft(path, what="a suite", name_key="name", longest_name=LONGEST_LABEL)


def _bare(name: str, files: str, folder: Path) -> ListFile:
    content: dict[str, Any] = {"name": name[:LONGEST_LABEL], "scenarios": [files]}
    return expand_list(content, folder=folder, name_key="name", longest_name=LONGEST_LABEL)


def _lists_scenarios(path: Path) -> bool:
    """Returns whether a file is a suite and no scenario."""
    language: Literal["json", "yaml"] = "json" if path.suffix.lower() == ".json" else "yaml"
    try:
        content, _ = plain_data(path.read_bytes(), language)
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read: {error.strerror}") from error
    return "scenarios" in content
