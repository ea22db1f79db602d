"""The answers to the limits of a gate: runs with violations, and means of metrics."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import accountability
from drivora_service.oracles.verdicts.failure_definition import Counted, FailureDefinition
from drivora_service.suites.gate.baseline import METRIC_DIGITS, BaselineScenario
from drivora_service.suites.gate.gate_decision import LimitAnswer
from drivora_service.suites.gate.gate_documents import (
    GateDocument,
    LimitDocument,
    MetricLimitDocument,
)
from drivora_service.suites.gate.occurrence_statistics import Interval, mean_of_repetitions
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_failures import is_judged
from drivora_service.suites.suite_results import SuiteResults, SuiteRun


def limit_answers(
    results: SuiteResults,
    scenarios: Mapping[str, SuiteScenario],
    gate: GateDocument,
    baseline: Mapping[str, BaselineScenario],
) -> tuple[LimitAnswer, ...]:
    """Compares runs with the limits of a gate.

    Args:
        results: The runs, without confirmations.
        scenarios: Expectations by the name of the scenario; known failures do not count.
        gate: The limits.
        baseline: What was accepted, by scenario.
    """
    judged = [run for run in results.runs if is_judged(run)]
    answers = [_violations_answer(one, judged, scenarios, gate) for one in gate.limits]
    for one in gate.metrics:
        answers += _metric_answers(one, judged, gate, baseline)
    return tuple(answers)


def _violations_answer(
    limit: LimitDocument,
    runs: Sequence[SuiteRun],
    scenarios: Mapping[str, SuiteScenario],
    gate: GateDocument,
) -> LimitAnswer:
    failing = [
        any(
            _is_limited(verdict, limit, scenarios[run.scenario].definition(gate.definition), run)
            for verdict in run.violations
        )
        for run in runs
    ]
    what = _describe_limit(limit)
    if limit.most_scenarios is not None:
        count = len({run.scenario for run, fails in zip(runs, failing, strict=True) if fails})
        return LimitAnswer(
            what=f"scenarios with {what}",
            value=Interval(mean=float(count)),
            allowed=f"at most {limit.most_scenarios}",
            fails=count > limit.most_scenarios,
        )
    most = limit.most_share or 0.0
    share = _over_repetitions(runs, [float(one) for one in failing], confidence=gate.confidence)
    return LimitAnswer(
        what=f"share of runs with {what}",
        value=share,
        allowed=f"at most {most:g}",
        fails=share is not None and share.least > most,
        is_uncertain=share is not None and share.mean > most >= share.least,
    )


def _is_limited(
    verdict: Verdict, limit: LimitDocument, scenario: FailureDefinition, run: SuiteRun
) -> bool:
    # What a limit does not name is as in the definition of the scenario.
    degrees = limit.accountability
    definition = FailureDefinition(
        counts=scenario.counts if degrees is None else Counted.ANY,
        oracles=limit.oracles or scenario.oracles,
        known=scenario.known,
    )
    return (
        definition.is_failure(verdict, run.agents)
        and (limit.severity is None or verdict.severity in limit.severity)
        and (degrees is None or accountability(verdict) in degrees)
    )


def _describe_limit(limit: LimitDocument) -> str:
    severity = f"{' or '.join(limit.severity)} " if limit.severity else ""
    oracles = " or ".join(limit.oracles or ("violation",)).replace("_", " ")
    degrees = ", ".join(limit.accountability or ("counted",)).replace("_", " ")
    return f"{severity}{oracles} ({degrees})"


def _metric_answers(
    limit: MetricLimitDocument,
    runs: Sequence[SuiteRun],
    gate: GateDocument,
    baseline: Mapping[str, BaselineScenario],
) -> Iterator[LimitAnswer]:
    name = limit.metric
    if limit.at_least is not None or limit.at_most is not None:
        measured = [run for run in runs if run.value_of(name) is not None]
        values = [run.value_of(name) or 0.0 for run in measured]
        mean = _over_repetitions(measured, values, confidence=gate.confidence)
        yield _compare_with_bounds(f"mean {name}", mean, low=limit.at_least, high=limit.at_most)
    if limit.most_drop is not None or limit.most_rise is not None:
        measured = [
            run
            for run in runs
            if run.value_of(name) is not None
            and name in baseline.get(run.scenario, _NOTHING).metrics
        ]
        changes = [
            (run.value_of(name) or 0.0) - baseline[run.scenario].metrics[name] for run in measured
        ]
        change = _over_repetitions(measured, changes, confidence=gate.confidence)
        yield _compare_with_bounds(
            f"change of mean {name}",
            change,
            # Not -most_drop, which is -0 for 0.
            low=None if limit.most_drop is None else 0.0 - limit.most_drop,
            high=limit.most_rise,
            slack=10.0**-METRIC_DIGITS,
        )


_NOTHING = BaselineScenario(sha256="", seeds=())


def _compare_with_bounds(
    what: str,
    value: Interval | None,
    *,
    low: float | None,
    high: float | None,
    slack: float = 0.0,
) -> LimitAnswer:
    """Compares a value with bounds, which it may miss by no more than its own error, ``slack``."""
    allowed = " and ".join(
        text
        for text in (
            "" if low is None else f"at least {low:g}",
            "" if high is None else f"at most {high:g}",
        )
        if text
    )
    if value is None:
        return LimitAnswer(what=what, value=None, allowed=allowed, fails=True)
    least = -math.inf if low is None else low - slack
    most = math.inf if high is None else high + slack
    fails = value.most < least or value.least > most
    return LimitAnswer(
        what=what,
        value=value,
        allowed=allowed,
        fails=fails,
        is_uncertain=not least <= value.mean <= most and not fails,
    )


def _over_repetitions(
    runs: Sequence[SuiteRun],
    values: Sequence[float],
    *,
    confidence: float,
) -> Interval | None:
    """Returns the mean over repetitions of a value of their runs; ``None`` without any run."""
    by_repetition: dict[int, list[float]] = {}
    for run, value in zip(runs, values, strict=True):
        by_repetition.setdefault(run.repetition, []).append(value)
    if not by_repetition:
        return None
    means = [_mean(one) for one in by_repetition.values()]
    return mean_of_repetitions(means, confidence=confidence)


def _mean(values: Sequence[float]) -> float:
    return math.fsum(values) / len(values)
