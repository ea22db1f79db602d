"""The failures of a suite's runs: what they are, and in how many runs of a scenario each occurs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from drivora_service.oracles.verdict import Severity
from drivora_service.oracles.verdicts.accountability import (
    Accountability,
    accountability,
    strongest_of,
)
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    FailureDefinition,
    KnownFailure,
    agents_of,
)
from drivora_service.oracles.verdicts.failure_facts import failure_sentence
from drivora_service.oracles.verdicts.violation_magnitude import (
    Magnitude,
    add_run,
    beyond_bound,
    join_in_run,
    magnitudes_of,
)
from drivora_service.runs.run_report import RunStatus
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_results import SuiteResults, SuiteRun

AGENT_FAILED = "agent_failed"
"""Name, in place of an oracle's, of the failure that an ADS itself failed."""

METRIC_PREFIX = "metric "
"""Beginning of the name, in place of an oracle's, of a metric outside its bounds."""

_RANK = {severity: rank for rank, severity in enumerate(Severity)}


@dataclass(frozen=True, slots=True, kw_only=True, order=True)
class FailureKey:
    """The identity of a failure: two versions of an ADS fail in the same way if it is the same.

    Place and time do not belong to it, as both differ a little between versions.

    Attributes:
        scenario: Name of the scenario.
        oracle: Violated oracle; ``agent_failed``; or ``metric NAME``.
        ego: Id of the ego; "" if it is of none.
        counterpart: Id of the other actor; "" without one.
    """

    scenario: str
    oracle: str
    ego: str = ""
    counterpart: str = ""

    def __str__(self) -> str:
        """Returns the failure in words."""
        ego = f" of {self.ego}" if self.ego else ""
        other = f" with {self.counterpart}" if self.counterpart else ""
        return f"{self.scenario}: {self.oracle.replace('_', ' ')}{ego}{other}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """A failure in the runs of a scenario.

    Attributes:
        runs: Runs in which it occurs.
        of: Judged runs of the scenario.
        accountability: The strongest of its violations.
        severity: The gravest of its violations.
        sentence: Facts of its first violation.
        time: Simulated seconds of that; ``None`` if it has none.
        run_id: First run in which it occurs.
        seeds: Seeds of the runs in which it occurs.
        severities: The gravest severity of its violations in each of these runs.
        magnitudes: How severe it is in each of these runs, by every measure that all of them have.
    """

    key: FailureKey
    runs: int
    of: int
    accountability: Accountability
    severity: Severity
    sentence: str
    time: float | None
    run_id: str
    seeds: tuple[int, ...]
    severities: tuple[Severity, ...] = ()
    magnitudes: tuple[Magnitude, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownOccurrence:
    """A known failure, and the number of runs of its scenario in which it occurs."""

    scenario: str
    known: KnownFailure
    runs: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What the runs of a suite show.

    Attributes:
        failures: Those that count, by key, in the order of the suite.
        known: Known failures of the ADSs of the runs.
        judged: Judged runs of each scenario, runs of an ADS that failed among them.
        unfinished: Runs that were not judged for another reason.
        preventable: Judged runs with a violation that is not the fault of the ego, but avoidable,
            whether it counts or not.
        definitions: What counts as a failure in each scenario.
    """

    failures: Mapping[FailureKey, Failure]
    known: tuple[KnownOccurrence, ...]
    judged: Mapping[str, int]
    unfinished: tuple[SuiteRun, ...]
    preventable: int
    definitions: Mapping[str, FailureDefinition]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Event:
    """One violation, or its like, of a run."""

    key: FailureKey
    accountability: Accountability
    severity: Severity
    sentence: str
    time: float | None
    magnitudes: tuple[Magnitude, ...] = ()


def find_failures(
    results: SuiteResults,
    scenarios: Mapping[str, SuiteScenario],
    *,
    gate: FailureDefinition = DEFAULT_DEFINITION,
) -> Found:
    """Finds the failures in the runs of a suite.

    Args:
        results: The runs.
        scenarios: Expectations by the name of the scenario.
        gate: What counts as a failure in scenarios that do not say it themselves.
    """
    failures: dict[FailureKey, Failure] = {}
    known: list[KnownOccurrence] = []
    judged: dict[str, int] = {}
    unfinished: list[SuiteRun] = []
    preventable = 0
    definitions: dict[str, FailureDefinition] = {}
    for name, runs in results.of_scenario().items():
        scenario = scenarios[name]
        judgeable = [run for run in runs if is_judged(run)]
        unfinished += [run for run in runs if not is_judged(run)]
        judged[name] = len(judgeable)
        definition = definitions[name] = scenario.definition(gate)
        preventable += sum(definition.is_preventable(run.violations) for run in judgeable)
        events = [(run, _first_of_each(_events(run, scenario, definition))) for run in judgeable]
        known += _find_known_occurrences(scenario, events)
        for run, found in events:
            for event in found:
                key = event.key
                if not definition.knows(key.oracle, key.ego, key.counterpart, run.agents):
                    before = failures.get(key)
                    failures[key] = _add_event(before, event, run, of=len(judgeable))
    return Found(
        failures=failures,
        known=tuple(known),
        judged=judged,
        unfinished=tuple(unfinished),
        preventable=preventable,
        definitions=definitions,
    )


def is_judged(run: SuiteRun) -> bool:
    """Returns whether a run says something about its ADS: it ended, or the ADS failed in it."""
    return run.status in (RunStatus.FINISHED, RunStatus.AGENT_FAILED)


def is_seedless(runs: Iterable[SuiteRun]) -> bool:
    """Returns whether judged runs under different seeds are the same; not for one run.

    Their traces have different hashes, since the seed belongs to the scenario; runs are the same if
    all that was measured of them is, to the last bit.
    """
    judged = [run for run in runs if is_judged(run)]
    return len(judged) > 1 and all(
        (run.status, run.cause, run.metrics, run.violations, run.sim_time_s)
        == (first.status, first.cause, first.metrics, first.violations, first.sim_time_s)
        for first, run in pairwise(judged)
    )


def _events(
    run: SuiteRun,
    scenario: SuiteScenario,
    definition: FailureDefinition,
) -> Iterable[_Event]:
    if run.status is RunStatus.AGENT_FAILED:
        yield _Event(
            key=FailureKey(scenario=run.scenario, oracle=AGENT_FAILED),
            accountability=Accountability.NOT_JUDGED,
            severity=Severity.CRITICAL,
            sentence=f"The ADS failed ({run.cause}): {run.message}",
            time=None,
        )
        return
    # Known failures are events, too: it is counted how often they occur.
    for verdict in run.violations:
        degree = accountability(verdict)
        if definition.looks_at(verdict) and definition.counts_degree(degree):
            yield _Event(
                key=FailureKey(
                    scenario=run.scenario,
                    oracle=verdict.oracle,
                    ego=verdict.ego,
                    counterpart=verdict.counterpart,
                ),
                accountability=degree,
                severity=verdict.severity,
                sentence=failure_sentence(verdict, town=run.town),
                time=verdict.time,
                magnitudes=magnitudes_of(verdict),
            )
    for name, bounds in scenario.metrics.items():
        value = run.value_of(name)
        if value is not None and not bounds.hold(value):
            yield _Event(
                key=FailureKey(scenario=run.scenario, oracle=METRIC_PREFIX + name),
                accountability=Accountability.NOT_JUDGED,
                severity=Severity.MINOR,
                sentence=f"{name} is {value:g}, and {bounds} is expected.",
                time=None,
                magnitudes=(beyond_bound(value, low=bounds.at_least, high=bounds.at_most),),
            )


def _first_of_each(events: Iterable[_Event]) -> list[_Event]:
    """Joins the violations of one failure in one run: its first one, and the gravest degrees."""
    first: dict[FailureKey, _Event] = {}
    for event in events:
        before = first.setdefault(event.key, event)
        if before is not event:
            first[event.key] = replace(
                before,
                accountability=_stronger(before.accountability, event.accountability),
                severity=_graver(before.severity, event.severity),
                magnitudes=join_in_run(before.magnitudes, event.magnitudes),
            )
    return list(first.values())


def _add_event(before: Failure | None, event: _Event, run: SuiteRun, *, of: int) -> Failure:
    seeds = () if run.seed is None else (run.seed,)
    if before is None:
        return Failure(
            key=event.key,
            runs=1,
            of=of,
            accountability=event.accountability,
            severity=event.severity,
            sentence=event.sentence,
            time=event.time,
            run_id=run.run_id,
            seeds=seeds,
            severities=(event.severity,),
            magnitudes=event.magnitudes,
        )
    return replace(
        before,
        runs=before.runs + 1,
        accountability=_stronger(before.accountability, event.accountability),
        severity=_graver(before.severity, event.severity),
        seeds=before.seeds + seeds,
        severities=(*before.severities, event.severity),
        magnitudes=add_run(before.magnitudes, event.magnitudes),
    )


def _find_known_occurrences(
    scenario: SuiteScenario, events: Sequence[tuple[SuiteRun, Sequence[_Event]]]
) -> Iterable[KnownOccurrence]:
    for known in scenario.known_failures:
        concerned = [one for one in events if known.is_of(agents_of("", one[0].agents))]
        if concerned:
            runs = sum(
                any(
                    known.is_of(agents_of(e.key.ego, run.agents))
                    and known.covers(e.key.oracle, e.key.ego, e.key.counterpart)
                    for e in found
                )
                for run, found in concerned
            )
            yield KnownOccurrence(scenario=scenario.name, known=known, runs=runs)


def _stronger(one: Accountability, two: Accountability) -> Accountability:
    return strongest_of((one, two)) or one


def _graver(one: Severity, two: Severity) -> Severity:
    return min(one, two, key=_RANK.__getitem__)
