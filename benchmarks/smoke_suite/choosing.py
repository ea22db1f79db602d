"""The choice: scenarios that tell ADSs apart, of all networks, oracles and difficulties alike."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.smoke_suite.panel import PANEL, SLOW
from benchmarks.smoke_suite.searching import results_path
from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.suites.counted import Counted
from drivora_service.suites.failures import find_failures
from drivora_service.suites.results import read_results
from drivora_service.suites.suite import SuiteScenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A scenario that was found, and what the ADSs of the panel do in it.

    Attributes:
        failed_by: Labels of the ADSs that fail.
        oracles: Oracles that they violate.
    """

    name: str
    document: ScenarioDocument
    failed_by: tuple[str, ...]
    oracles: tuple[str, ...]

    @property
    def town(self) -> str:
        """Name of its road network."""
        return self.document.map_region.town

    @property
    def place(self) -> str:
        """Network, oracle and road or junction of the failure that was found."""
        return re.sub(r"-\d+$", "", self.name)

    @property
    def ads_failing(self) -> tuple[str, ...]:
        """The ADSs that fail, without the worse version of one of them."""
        return tuple(label for label in self.failed_by if label != SLOW.label)

    @property
    def tells_the_slow_one(self) -> bool:
        """Whether the ADS passes and its worse version does not."""
        return SLOW.label in self.failed_by and SLOW.agent not in self.failed_by


def candidates(work: Path, suite: str) -> Iterator[Candidate]:
    """Yields the scenarios of a suite in which every ADS of the panel could be judged."""
    paths = {path.stem: path for path in sorted((work / suite / "scenarios").glob("*.json"))}
    documents = {name: parse_document(path.read_bytes(), "json") for name, path in paths.items()}
    scenarios = {
        name: SuiteScenario(name=name, document=document) for name, document in documents.items()
    }
    failed: dict[str, dict[str, None]] = {name: {} for name in paths}
    oracles: dict[str, dict[str, None]] = {name: {} for name in paths}
    judged: Counter[str] = Counter()
    for driver in PANEL:
        results = read_results(results_path(work, suite, driver))
        found = find_failures(results, scenarios, counted=Counted.ANY)
        judged.update(name for name, runs in found.judged.items() if runs)
        for key in found.failures:
            oracles[key.scenario][key.oracle] = None
            failed[key.scenario][driver.label] = None
    for name, document in documents.items():
        if judged[name] == len(PANEL):
            yield Candidate(
                name=name,
                document=document,
                failed_by=tuple(failed[name]),
                oracles=tuple(sorted(oracles[name])),
            )


def choose(pool: Collection[Candidate], *, size: int) -> list[Candidate]:
    """Chooses scenarios in which some of the panel fail and others do not.

    One after the other, the scenario is taken whose network, place, violated oracles, and number
    and set of failing ADSs are the rarest among those that were taken before.
    """
    left = [one for one in pool if 0 < len(one.failed_by) < len(PANEL)]
    chosen: list[Candidate] = []
    taken: Counter[object] = Counter()
    while left and len(chosen) < size:
        best = max(left, key=lambda one: sum(1.0 / (1 + taken[f]) for f in _features(one)))
        left.remove(best)
        chosen.append(best)
        taken.update(_features(best))
    return sorted(chosen, key=lambda one: one.name)


def _features(one: Candidate) -> tuple[object, ...]:
    return (
        one.town,
        one.place,
        one.oracles,
        len(one.failed_by),
        one.failed_by,
        ("slow", one.tells_the_slow_one),
    )


def table(chosen: Sequence[Candidate]) -> str:
    """Returns how the scenarios are distributed, as Markdown."""
    most = len(PANEL) - 1
    lines: list[str] = []
    for title, counts in (
        ("network", Counter(one.town for one in chosen)),
        ("violated oracle", Counter(oracle for one in chosen for oracle in one.oracles)),
        (f"failing ADSs, of {most}", Counter(len(one.ads_failing) for one in chosen)),
        ("failing ADS", Counter(label for one in chosen for label in one.failed_by)),
    ):
        lines += [f"| {title} | scenarios |", "|---|---|"]
        lines += [f"| {name} | {count} |" for name, count in sorted(counts.items())]
        lines.append("")
    return "\n".join(lines)
