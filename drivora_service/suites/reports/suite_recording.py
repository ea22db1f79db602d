"""What the store keeps of a run of a suite: the decision, and what became of each scenario."""

from __future__ import annotations

from drivora_service.store.suites.suite_records import (
    ScenarioState,
    SuiteDecision,
    SuiteEstimate,
    SuiteOutcome,
)
from drivora_service.suites.gate.gate_decision import ClassifiedFailure
from drivora_service.suites.gate.occurrence_statistics import Interval, mean_of_repetitions, share
from drivora_service.suites.reports.suite_report import ScenarioRow, SuiteReport

_PASSING = frozenset({ScenarioState.PASSES, ScenarioState.KNOWN})
_CONFIDENCE = 0.95
_MOST_FAILURES = 20
"""Sentences of a scenario; further failures of it are left out."""


def decision_of(report: SuiteReport) -> SuiteDecision:
    """Returns the decision on a run of a suite, with its pass rate and its score."""
    results, decision = report.results, report.decision
    passing = sum(row.state in _PASSING for row in report.rows)
    scores = [row.score for row in report.rows if row.score is not None]
    configuration = results.configuration
    return SuiteDecision(
        suite=results.suite,
        agent=results.agent,
        agent_parameters=results.agent_parameters,
        configuration="" if configuration is None else configuration.words,
        configuration_id="" if configuration is None else configuration.id,
        fails=decision.fails,
        sentence=decision.sentence,
        reasons=decision.reasons,
        counts={str(which): count for which, count in decision.counts.items() if count},
        baseline=report.baseline,
        scenarios=len(report.rows),
        passing=passing,
        judged_runs=decision.judged_runs,
        pass_rate=_estimate(share(passing, len(report.rows))),
        # Scenarios are the observations: the interval is that of other scenarios like these.
        score=_estimate(mean_of_repetitions(scores, confidence=_CONFIDENCE)) if scores else None,
        versions=results.versions,
        definition=decision.definition.words,
    )


def outcomes_of(report: SuiteReport) -> tuple[SuiteOutcome, ...]:
    """Returns what became of each scenario, in the order of the suite."""
    return tuple(_outcome(row) for row in report.rows)


def _outcome(row: ScenarioRow) -> SuiteOutcome:
    failing = [one.now.run_id for one in row.failures if one.now is not None]
    made = [run.run_id for run in row.runs if run.run_id]
    sentences = [_describe(one) for one in row.failures]
    sentences += [f"{run.status.replace('_', ' ')}: {run.message}" for run in row.unfinished]
    return SuiteOutcome(
        scenario=row.name,
        state=row.state,
        failing=row.failing,
        judged=row.judged,
        score=row.score,
        run_id=next(iter([*failing, *made]), ""),
        failures=tuple(sentences[:_MOST_FAILURES]),
    )


def _describe(one: ClassifiedFailure) -> str:
    growth = f" It is {one.growth}." if one.growth else ""
    return f"{one.key.oracle.replace('_', ' ')}: {one.sentence}{growth}"


def _estimate(interval: Interval) -> SuiteEstimate:
    return SuiteEstimate(mean=interval.mean, low=interval.low, high=interval.high)
