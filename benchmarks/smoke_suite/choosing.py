"""The choice: scenarios that tell ADSs apart, of all networks, oracles and difficulties alike."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.smoke_suite.panel import PANEL, SLOW, Driver
from benchmarks.smoke_suite.searching import results_path
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.scenario.documents import ScenarioDocument, parse_document
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_failures import find_failures
from drivora_service.suites.suite_results import read_results

_ALIKE_M, _ALIKE_S = 10.0, 2.0
"""Failures at places and times that are the same when rounded to these are alike."""
_ARRIVAL = "destination"
"""Oracle of egos that do not arrive in time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spot:
    """A first failure: its oracle, and place and time in steps that are alike."""

    oracle: str
    place: tuple[int, ...]
    time: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A scenario that was found, and what the ADSs of the panel do in it.

    Attributes:
        failed_by: Labels of the ADSs that fail.
        oracles: Oracles that they violate.
        spots: For each ADS that fails, where and when it first does, roughly.
    """

    name: str
    document: ScenarioDocument
    failed_by: tuple[str, ...]
    oracles: tuple[str, ...]
    spots: tuple[Spot, ...]

    @property
    def town(self) -> str:
        """Name of its road network."""
        return self.document.map_region.town

    @property
    def place(self) -> str:
        """Network, oracle and road or junction of the failure that was found."""
        return re.sub(r"-\d+$", "", self.name)

    @property
    def tells_apart(self) -> bool:
        """Whether some of the panel fail and others do not.

        Where the worse version passes and the other one does not, chance decides.
        """
        is_chance = SLOW.agent in self.failed_by and SLOW.label not in self.failed_by
        return 0 < len(self.failed_by) < len(PANEL) and not is_chance

    @property
    def followed(self) -> Driver:
        """The ADS whose failure its minimal form keeps: the worse version where only that fails.

        Else the first one of the panel that fails.
        """
        if self.tells_the_slow_one:
            return SLOW
        return next(driver for driver in PANEL if driver.label in self.failed_by)

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
    spots: dict[str, list[Spot]] = {name: [] for name in paths}
    judged: Counter[str] = Counter()
    for driver in PANEL:
        results = read_results(results_path(work, suite, driver))
        found = find_failures(results, scenarios, gate=FailureDefinition(counts=Counted.ANY))
        judged.update(name for name, runs in found.judged.items() if runs)
        violations = {run.scenario: run.violations for run in results.runs}
        for key in found.failures:
            oracles[key.scenario][key.oracle] = None
            if driver.label not in failed[key.scenario]:
                failed[key.scenario][driver.label] = None
                of_key = (one for one in violations[key.scenario] if one.oracle == key.oracle)
                spots[key.scenario].append(_spot(key.oracle, next(of_key, None)))
    for name, document in documents.items():
        if judged[name] == len(PANEL):
            yield Candidate(
                name=name,
                document=document,
                failed_by=tuple(failed[name]),
                oracles=tuple(sorted(oracles[name])),
                spots=tuple(spots[name]),
            )


def _spot(failure: str, verdict: Verdict | None) -> Spot:
    """Returns the spot of a failure; the failure of an ADS itself has no verdict."""
    if verdict is None:
        return Spot(oracle=failure, place=(), time=0)
    return Spot(
        oracle=failure,
        place=tuple(round(value / _ALIKE_M) for value in verdict.location or ()),
        time=round((verdict.time or 0.0) / _ALIKE_S),
    )


def smaller(pool: Collection[Candidate], minimal: Collection[Candidate]) -> list[Candidate]:
    """Returns each scenario that has a minimal form: in that form if it tells as much.

    A minimal form may end too early for an ADS that does not fail to arrive.
    """
    original = {one.name: one for one in pool}
    return [
        small
        if small.tells_apart
        and small.tells_the_slow_one == original[small.name].tells_the_slow_one
        and _ARRIVAL not in set(small.oracles) - set(original[small.name].oracles)
        else original[small.name]
        for small in minimal
    ]


def choose(pool: Collection[Candidate], *, size: int) -> list[Candidate]:
    """Chooses scenarios in which some of the panel fail and others do not.

    One after the other, the scenario is taken whose network, place, violated oracles, and number
    and set of failing ADSs are the rarest among those that were taken before. One in which the same
    ADSs fail at the same places as in another is not taken.
    """
    left = [one for one in pool if one.tells_apart]
    chosen: list[Candidate] = []
    taken: Counter[object] = Counter()
    while left and len(chosen) < size:
        best = max(left, key=lambda one: sum(1.0 / (1 + taken[f]) for f in _features(one)))
        left.remove(best)
        if (best.town, best.failed_by, best.spots) in taken:
            continue
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
        (one.town, one.failed_by, one.spots),
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
