"""The decision of a gate on the results of a suite."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from drivora_service.oracles.verdicts.failure_definition import state_definition
from drivora_service.studies.comparison.sample_statistics import holm
from drivora_service.suites.gate.baseline import (
    Baseline,
    BaselineFailure,
    BaselineScenario,
    accepted_failures,
    measured,
)
from drivora_service.suites.gate.baseline_definitions import (
    check_definitions,
    find_comparable,
    leave_out_known,
)
from drivora_service.suites.gate.failure_classes import IN_ORDER, FailureClass
from drivora_service.suites.gate.gate_decision import (
    ClassifiedFailure,
    Decision,
    OverallAnswer,
    plural,
)
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gate_limits import limit_answers
from drivora_service.suites.gate.occurrence_statistics import (
    Occurrences,
    p_of_more,
    p_of_more_overall,
)
from drivora_service.suites.gate.severity_changes import SeveritySides, severity_changes
from drivora_service.suites.suite import SuiteScenario
from drivora_service.suites.suite_failures import FailureKey, Found, find_failures, is_seedless
from drivora_service.suites.suite_results import SuiteResults

_NEVER = Occurrences(runs=0, of=0)


def decide(
    results: SuiteResults,
    scenarios: Mapping[str, SuiteScenario],
    gate: GateDocument,
    baseline: Baseline | None,
) -> Decision:
    """Judges the results of a suite.

    Args:
        results: The runs.
        scenarios: Expectations by the name of the scenario.
        gate: What is asked of them.
        baseline: The failures that were accepted; ``None``: every failure is new.

    Raises:
        ConfigurationError: The baseline counts other failures.
    """
    if baseline is not None:
        check_definitions(baseline, results.scenarios, scenarios, gate.definition)
    found = find_failures(results, scenarios, gate=gate.definition)
    # Confirmations are runs of scenarios that have just failed: they say nothing on the whole.
    chosen = results.without_confirmations()
    comparable = leave_out_known(
        find_comparable(baseline, results.scenarios), results, found.definitions
    )
    overall = (
        None
        if baseline is None
        else _overall(find_failures(chosen, scenarios, gate=gate.definition), comparable, gate)
    )
    known = set() if baseline is None else set(baseline.scenarios)
    decision = Decision(
        reasons=(),
        failures=_classify_failures(found, comparable, gate),
        has_baseline=baseline is not None,
        limits=limit_answers(chosen, scenarios, gate, comparable),
        overall=overall,
        known=found.known,
        unfinished=found.unfinished,
        ignores_unfinished=gate.unfinished == "ignore",
        not_in_baseline=()
        if baseline is None
        else tuple(name for name in results.scenarios if name not in comparable),
        not_run=tuple(sorted(known - results.scenarios.keys())),
        scenarios=len(results.scenarios),
        failing_scenarios=len({key.scenario for key in found.failures}),
        judged_runs=sum(found.judged.values()),
        preventable_runs=found.preventable,
        definition=state_definition(replace(one, known=()) for one in found.definitions.values()),
    )
    return replace(decision, reasons=tuple(_reasons(decision)))


def to_confirm(decision: Decision, results: SuiteResults, *, times: int) -> tuple[str, ...]:
    """Returns the scenarios whose change against the baseline further runs should confirm.

    Those are scenarios with failures that are new, fixed, flaky and new, or more frequent or more
    severe in the few runs so far; and once more those with failures that are new, worse, still in
    every run or still more severe, if the runs depend on the seed, as chance makes some fail in
    every run.

    Args:
        decision: On the runs so far.
        results: The runs so far.
        times: Number of further runs.
    """
    runs = results.of_scenario()

    def is_open(one: ClassifiedFailure) -> bool:
        before, now = one.in_runs_before, one.in_runs
        if not before.of:
            return False
        # Runs that are not judged count, or it would not end.
        made = len(runs[one.key.scenario])
        is_more = now.runs == now.of and before.runs < before.of
        if made < 1 + times:
            is_steady = one.failure_class in (FailureClass.NEW, FailureClass.FIXED)
            return is_steady or not before.runs or is_more or one.may_be_more_severe
        return (
            (
                is_more
                or one.may_be_more_severe
                or one.failure_class in (FailureClass.NEW, FailureClass.WORSE)
            )
            and made < 1 + 2 * times
            and not is_seedless(runs[one.key.scenario])
        )

    return tuple(dict.fromkeys(one.key.scenario for one in decision.failures if is_open(one)))


def _classify_failures(
    found: Found, comparable: Mapping[str, BaselineScenario], gate: GateDocument
) -> tuple[ClassifiedFailure, ...]:
    before = accepted_failures(comparable)
    # Nothing is known now of scenarios without a judged run.
    keys = [
        key
        for key in dict.fromkeys((*found.failures, *before))
        if found.judged.get(key.scenario, 0)
    ]
    rows = [_row(key, found, before.get(key), comparable.get(key.scenario)) for key in keys]
    tested = [place for place, one in enumerate(rows) if _needs_test(one)]
    p_values = holm([p_of_more(rows[i].in_runs_before, rows[i].in_runs) for i in tested])
    for place, p in zip(tested, p_values, strict=True):
        rows[place] = replace(rows[place], p=p)
    sides = [
        SeveritySides(
            before=measured(one.before),
            now=measured(one.now),
            in_every_run=one.in_runs.runs == one.in_runs.of,
        )
        for one in rows
    ]
    changes = severity_changes(sides, alpha=gate.alpha)
    rows = [replace(one, severity=found) for one, found in zip(rows, changes, strict=True)]
    classes = [failure_class(one, alpha=gate.alpha) for one in rows]
    done = [
        replace(one, failure_class=which, fails=which in gate.fail_on)
        for one, which in zip(rows, classes, strict=True)
    ]
    order = {which: rank for rank, which in enumerate(IN_ORDER)}
    return tuple(sorted(done, key=lambda one: (order[one.failure_class], one.key)))


def _row(
    key: FailureKey,
    found: Found,
    before: BaselineFailure | None,
    scenario: BaselineScenario | None,
) -> ClassifiedFailure:
    now = found.failures.get(key)
    return ClassifiedFailure(
        key=key,
        failure_class=FailureClass.NEW,
        now=now,
        before=before,
        in_runs=Occurrences(runs=0 if now is None else now.runs, of=found.judged[key.scenario]),
        in_runs_before=_NEVER
        if scenario is None
        else Occurrences(runs=0 if before is None else before.runs, of=len(scenario.seeds)),
        p=None,
        fails=False,
    )


def _needs_test(one: ClassifiedFailure) -> bool:
    """Returns whether chance may explain that a failure occurs more often than before."""
    before, now = one.in_runs_before, one.in_runs
    is_some = now.runs > 0 and before.of > 0 and before.runs < before.of
    return is_some and not (before.runs == 0 and now.runs == now.of)


def failure_class(one: ClassifiedFailure, *, alpha: float) -> FailureClass:
    """Returns what has become of a failure.

    Args:
        one: The failure, with the p of its test if it needs one.
        alpha: The p below which a test is trusted.
    """
    before, now = one.in_runs_before, one.in_runs
    if before.of == 0:
        return FailureClass.NEW
    more = one.p is not None and one.p < alpha
    if before.runs == 0:
        return FailureClass.NEW if now.runs == now.of or more else FailureClass.FLAKY
    if now.runs == 0:
        always = before.runs == before.of
        return (
            FailureClass.FIXED if always or p_of_more(now, before) < alpha else FailureClass.FLAKY
        )
    if one.is_more_severe:
        return FailureClass.WORSE
    if before.runs == before.of:
        return FailureClass.SAME if now.runs == now.of else FailureClass.FLAKY
    return FailureClass.WORSE if more else FailureClass.FLAKY


def _overall(
    found: Found, comparable: Mapping[str, BaselineScenario], gate: GateDocument
) -> OverallAnswer | None:
    if gate.overall is None:
        return None
    now = dict.fromkeys(comparable, 0)
    for key, failure in found.failures.items():
        if key.scenario in now:
            now[key.scenario] = max(now[key.scenario], failure.runs)
    # The baseline keeps no single runs: the most frequent failure of a scenario stands for them,
    # before and now.
    pairs = [
        (
            Occurrences(
                runs=max((one.runs for one in scenario.failures), default=0),
                of=len(scenario.seeds),
            ),
            Occurrences(runs=now[name], of=found.judged[name]),
        )
        for name, scenario in comparable.items()
        if found.judged[name]
    ]
    p = p_of_more_overall(pairs)
    return OverallAnswer(
        before=_sum([pair[0] for pair in pairs]),
        now=_sum([pair[1] for pair in pairs]),
        p=p,
        fails=p is not None and p < gate.overall,
        scenarios=len(pairs),
        telling=sum(0 < one.runs < one.of for one in map(_sum, pairs)),
    )


def _sum(every: Sequence[Occurrences]) -> Occurrences:
    return Occurrences(runs=sum(one.runs for one in every), of=sum(one.of for one in every))


def _reasons(decision: Decision) -> Iterator[str]:
    failing = [one for one in decision.failures if one.fails]
    for which in IN_ORDER:
        named = [_name(one) for one in failing if one.failure_class is which]
        if named:
            noun = f"{which} failure" if decision.has_baseline else "failure"
            yield f"{plural(len(named), noun)}: {_few(named)}"
    for limit in decision.limits:
        if limit.fails:
            yield f"{limit.what}: {_value(limit.value)}; allowed: {limit.allowed}"
    overall = decision.overall
    if overall is not None and overall.fails:
        yield (
            f"failures of all scenarios together are more frequent: {overall.now.runs} of "
            f"{overall.now.of} runs, before {overall.before.runs} of {overall.before.of} "
            f"({overall.tested})"
        )
    if decision.unfinished and not decision.ignores_unfinished:
        named = [f"{run.scenario} ({run.status}: {run.cause})" for run in decision.unfinished]
        verb = "was" if len(named) == 1 else "were"
        yield f"{plural(len(named), 'run')} {verb} not judged: {_few(named)}"
    if not decision.judged_runs:
        yield "no run was judged"


def _name(one: ClassifiedFailure) -> str:
    """Returns the failure in words; one that is worse by its severity, with how much."""
    worse = ", ".join(change.words for change in one.severity if change.is_worse)
    return f"{one.key} (more severe: {worse})" if worse else str(one.key)


def _few(names: Sequence[str]) -> str:
    shown = "; ".join(names[:5])
    return shown if len(names) <= 5 else f"{shown}; and {len(names) - 5} more"


def _value(value: object) -> str:
    return "not measurable" if value is None else str(value)
