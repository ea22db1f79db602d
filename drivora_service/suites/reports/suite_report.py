"""What the reports of a suite show: the decision of the gate, and a row for each scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime

from drivora_service.store.suites.suite_records import ScenarioState
from drivora_service.suites.gate.gate_decision import ClassifiedFailure, Decision
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_failures import is_judged, is_seedless
from drivora_service.suites.suite_results import SuiteResults, SuiteRun

SCORE = "driving_score"
"""Metric that reports show of each scenario."""


STATES_IN_WORDS: Mapping[ScenarioState, str] = {
    ScenarioState.FAILS_GATE: "fails the gate",
    ScenarioState.NOT_JUDGED: "not judged",
    ScenarioState.FLAKY: "flaky",
    ScenarioState.FAILS: "fails, as accepted",
    ScenarioState.KNOWN: "known failures only",
    ScenarioState.PASSES: "passes",
}
"""States of scenarios as reports name them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioRow:
    """A scenario in a report.

    Attributes:
        failing: Judged runs with a failure that counts: the most frequent one.
        judged: Judged runs.
        score: Mean driving score; ``None``: not measurable.
        failures: What fails in it now.
        known: Reasons of known failures that occur.
        gone: Known failures that do not occur any more.
        unfinished: Runs that were not judged.
        is_seedless: All runs are the same, whatever their seeds; false for a single run.
    """

    name: str
    tags: tuple[str, ...]
    state: ScenarioState
    failing: int
    judged: int
    score: float | None
    failures: tuple[ClassifiedFailure, ...]
    known: tuple[str, ...]
    gone: tuple[str, ...]
    unfinished: tuple[SuiteRun, ...]
    runs: tuple[SuiteRun, ...]
    is_seedless: bool

    @property
    def seconds(self) -> float:
        """Seconds that its runs took."""
        return sum(run.wall_time_s or 0.0 for run in self.runs)


@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteReport:
    """All that the reports of a suite show.

    Attributes:
        created_at: With its time zone.
        baseline: Name of the baseline's file; "" without one.
        baseline_subject: The ADS of the baseline with its parameters and versions; "" likewise.
        pictures: SVG of runs, by run id.
    """

    results: SuiteResults
    decision: Decision
    rows: tuple[ScenarioRow, ...]
    created_at: datetime
    baseline: str = ""
    baseline_subject: str = ""
    pictures: Mapping[str, bytes] = field(default_factory=dict)

    @property
    def baseline_words(self) -> str:
        """The file of the baseline, and whose failures it has; "" without one."""
        of = f" (of {self.baseline_subject})" if self.baseline_subject else ""
        return f"{self.baseline}{of}" if self.baseline else ""

    @property
    def subject(self) -> str:
        """The ADS with its parameters, in words."""
        configuration = self.results.configuration
        if configuration is not None:
            return f"{configuration.words} ({configuration.id})"
        agent = self.results.agent or "ADSs of the scenarios"
        return ", ".join((agent, *self.results.agent_parameters))


def make_report(
    results: SuiteResults,
    scenarios: Mapping[str, SuiteScenario],
    decision: Decision,
    *,
    created_at: datetime,
    baseline: str = "",
    baseline_subject: str = "",
    pictures: Mapping[str, bytes] | None = None,
) -> SuiteReport:
    """Returns the report of a suite; see :class:`SuiteReport`."""
    failures: dict[str, list[ClassifiedFailure]] = {}
    for one in decision.failures:
        if one.now is not None:
            failures.setdefault(one.key.scenario, []).append(one)
    return SuiteReport(
        results=results,
        decision=decision,
        rows=tuple(
            _row(scenarios[name], runs, failures.get(name, []), decision)
            for name, runs in results.of_scenario().items()
        ),
        created_at=created_at,
        baseline=baseline,
        baseline_subject=baseline_subject,
        pictures=pictures or {},
    )


def _row(
    scenario: SuiteScenario,
    runs: list[SuiteRun],
    failures: list[ClassifiedFailure],
    decision: Decision,
) -> ScenarioRow:
    judged = [run for run in runs if is_judged(run)]
    known = [one for one in decision.known if one.scenario == scenario.name]
    scores = [score for run in judged if (score := run.metrics.get(SCORE)) is not None]
    unfinished = tuple(run for run in decision.unfinished if run.scenario == scenario.name)
    return ScenarioRow(
        name=scenario.name,
        tags=scenario.tags,
        state=_state(failures, known=any(one.runs for one in known), unfinished=bool(unfinished)),
        failing=max((one.in_runs.runs for one in failures), default=0),
        judged=len(judged),
        score=sum(scores) / len(scores) if scores else None,
        failures=tuple(failures),
        known=tuple(one.known.reason for one in known if one.runs),
        gone=tuple(one.known.reason for one in known if not one.runs),
        unfinished=unfinished,
        runs=tuple(runs),
        is_seedless=is_seedless(runs),
    )


def _state(failures: list[ClassifiedFailure], *, known: bool, unfinished: bool) -> ScenarioState:
    if any(one.fails for one in failures):
        return ScenarioState.FAILS_GATE
    if unfinished:
        return ScenarioState.NOT_JUDGED
    if any(one.in_runs.runs < one.in_runs.of for one in failures):
        return ScenarioState.FLAKY
    if failures:
        return ScenarioState.FAILS
    return ScenarioState.KNOWN if known else ScenarioState.PASSES
