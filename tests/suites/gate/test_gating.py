"""The decision of a gate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.verdict import Answer
from drivora_service.oracles.verdicts.failure_definition import Counted
from drivora_service.runs.run_report import RunStatus
from drivora_service.suites.gate.baseline import Baseline, make_baseline
from drivora_service.suites.gate.failure_classes import FailureClass
from drivora_service.suites.gate.gate_decision import Decision
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gating import decide, to_confirm
from drivora_service.suites.suite_failures import find_failures
from drivora_service.suites.suite_results import SuiteResults, SuiteRun
from tests.suites.made_results import counted, results_of, scenarios_of, suite_run, verdict

GATE = GateDocument()


def accepted(results: SuiteResults) -> Baseline:
    return make_baseline(
        results, find_failures(results, scenarios_of(results)), metrics=["driving_score"]
    )


def judged(now: Mapping[str, tuple[int, int]], before: Mapping[str, tuple[int, int]]) -> Decision:
    """Decides on failing runs of scenarios against those before."""
    results = results_of([run for name, (k, n) in now.items() for run in counted(name, k, n)])
    old = results_of([run for name, (k, n) in before.items() for run in counted(name, k, n)])
    return decide(results, scenarios_of(results), GATE, accepted(old))


def test_what_others_began_and_a_careful_driver_avoids_is_a_count_of_its_own() -> None:
    prevented = verdict(at_fault=False, avoidable=Answer.YES)
    results = results_of([suite_run("a", 0, prevented, prevented), suite_run("b", 0, verdict())])
    scenarios = scenarios_of(results)
    passing = decide(results, scenarios, GATE, None)
    assert (passing.preventable_runs, passing.failing_scenarios) == (1, 1)
    assert passing.sentence.endswith("; 1 run not at fault, but avoidable")
    # It can be what the gate fails for.
    strict = decide(results, scenarios, GateDocument(counts=Counted.PREVENTABLE), None)
    assert (strict.preventable_runs, strict.failing_scenarios) == (1, 2)


@pytest.mark.parametrize(
    ("before", "now", "expected"),
    [
        ((0, 1), (1, 1), FailureClass.NEW),
        ((0, 5), (5, 5), FailureClass.NEW),
        ((0, 20), (3, 5), FailureClass.NEW),
        ((0, 5), (2, 5), FailureClass.FLAKY),
        ((1, 1), (1, 1), FailureClass.SAME),
        ((5, 5), (5, 5), FailureClass.SAME),
        ((5, 5), (4, 5), FailureClass.FLAKY),
        ((2, 5), (3, 5), FailureClass.FLAKY),
        ((2, 5), (0, 1), FailureClass.FLAKY),
        ((1, 20), (5, 5), FailureClass.WORSE),
        ((5, 5), (0, 5), FailureClass.FIXED),
        ((1, 1), (0, 1), FailureClass.FIXED),
        ((19, 20), (0, 5), FailureClass.FIXED),
        ((1, 5), (0, 5), FailureClass.FLAKY),
    ],
)
def test_classes_of_failures(
    before: tuple[int, int], now: tuple[int, int], expected: FailureClass
) -> None:
    decision = judged({"a": now, "b": (0, 1)}, {"a": before, "b": (0, 1)})
    (one,) = decision.failures
    assert one.failure_class is expected
    fails = expected in (FailureClass.NEW, FailureClass.WORSE)
    assert decision.fails == one.fails == fails
    assert decision.counts[expected] == 1


def test_without_a_baseline_every_failure_counts() -> None:
    results = results_of(counted("a", 1, 5) + counted("b", 0, 5))
    decision = decide(results, scenarios_of(results), GATE, None)
    assert decision.fails
    assert [one.failure_class for one in decision.failures] == [FailureClass.NEW]
    assert decision.sentence == "Gate failed: 1 failure; 1 of 2 scenarios fail in 10 judged runs"
    assert decision.reasons == ("1 failure: a: collision of ego with npc",)


def test_failures_of_scenarios_that_the_baseline_does_not_know_are_new() -> None:
    decision = judged({"a": (0, 1), "b": (1, 1)}, {"a": (0, 1), "gone": (1, 1)})
    assert decision.not_in_baseline == ("b",)
    assert decision.not_run == ("gone",)
    assert [str(one.key) for one in decision.failures] == ["b: collision of ego with npc"]
    assert decision.fails


def test_a_changed_scenario_has_no_baseline() -> None:
    results = results_of(counted("a", 1, 1))
    baseline = accepted(results)
    changed = results_of(counted("a", 1, 1), scenarios={"a": "0" * 64})
    decision = decide(changed, scenarios_of(changed), GATE, baseline)
    assert decision.not_in_baseline == ("a",)
    assert decision.fails


def test_the_failure_that_replaces_another_is_new() -> None:
    before = results_of([suite_run("a", 0, verdict(counterpart="one"))])
    now = results_of([suite_run("a", 0, verdict(counterpart="two"))])
    decision = decide(now, scenarios_of(now), GATE, accepted(before))
    assert {one.failure_class for one in decision.failures} == {
        FailureClass.NEW,
        FailureClass.FIXED,
    }
    assert decision.fails


def test_runs_that_were_not_judged_fail_the_gate_and_hide_nothing() -> None:
    lost = suite_run("a", 0, status=RunStatus.TIMED_OUT, cause="wall_time_limit", seed=None)
    now = results_of([lost])
    before = results_of(counted("a", 1, 1))
    decision = decide(now, scenarios_of(now), GATE, accepted(before))
    assert decision.failures == ()
    assert decision.reasons == (
        "1 run was not judged: a (timed_out: wall_time_limit)",
        "no run was judged",
    )
    ignoring = GateDocument(unfinished="ignore")
    assert decide(now, scenarios_of(now), ignoring, None).reasons == ("no run was judged",)


def test_many_scenarios_that_fail_a_little_more_often_fail_the_gate_together() -> None:
    names = [f"s{number}" for number in range(40)]
    decision = judged(dict.fromkeys(names, (3, 5)), dict.fromkeys(names, (1, 5)))
    assert {one.failure_class for one in decision.failures} == {FailureClass.FLAKY}
    assert decision.overall is not None
    assert decision.overall.fails
    (reason,) = decision.reasons
    assert reason.startswith(
        "failures of all scenarios together are more frequent: 120 of 200 runs, before 40 of 200"
    )


def test_confirmations_do_not_count_for_the_whole() -> None:
    runs = [*counted("a", 1, 1), *counted("b", 0, 1)]
    again = [suite_run("a", number, verdict()) for number in range(1, 5)]
    results = results_of(runs, repetitions=1).with_runs(again)
    old = results_of([*counted("a", 0, 1), *counted("b", 0, 1)])
    decision = decide(results, scenarios_of(results), GATE, accepted(old))
    assert [one.in_runs.of for one in decision.failures] == [5]
    assert decision.overall is not None
    assert decision.overall.now.of == 2


def asked(
    now: Mapping[str, tuple[int, int]],
    before: Mapping[str, tuple[int, int]],
    *,
    depends_on_seed: bool = False,
) -> set[str]:
    """Returns the scenarios that are to be confirmed by four runs."""
    runs = [run for name, (k, n) in now.items() for run in counted(name, k, n)]
    if depends_on_seed:
        runs = [by_chance(run) for run in runs]
    results = results_of(runs)
    old = results_of([run for name, (k, n) in before.items() for run in counted(name, k, n)])
    decision = decide(results, scenarios_of(results), GATE, accepted(old))
    return set(to_confirm(decision, results, times=4))


def by_chance(run: SuiteRun) -> SuiteRun:
    """Returns a run with a length of its own."""
    return replace(run, sim_time_s=10.0 + run.repetition)


def test_changes_against_the_baseline_are_confirmed() -> None:
    now = {"new": (1, 1), "fixed": (0, 1), "same": (1, 1), "unknown": (1, 1)}
    before = {"new": (0, 1), "fixed": (1, 1), "same": (1, 1)}
    assert asked(now, before) == {"new", "fixed"}
    assert asked({"rare": (2, 3), "flaky": (2, 3)}, {"rare": (0, 3), "flaky": (1, 3)}) == {"rare"}


def test_a_failure_of_some_runs_that_is_in_every_run_now_is_confirmed() -> None:
    assert asked({"a": (1, 1)}, {"a": (1, 5)}) == {"a"}
    assert asked({"a": (1, 2)}, {"a": (1, 5)}) == set()
    assert asked({"a": (1, 1)}, {"a": (5, 5)}) == set()


def test_confirmations_that_are_not_judged_are_not_asked_for_again() -> None:
    old = results_of(counted("a", 0, 1))
    again = [suite_run("a", number, status=RunStatus.TIMED_OUT) for number in range(1, 5)]
    results = results_of(counted("a", 1, 1)).with_runs(again)
    decision = decide(results, scenarios_of(results), GATE, accepted(old))
    asked_again = to_confirm(decision, results, times=4)
    further = [suite_run("a", number, status=RunStatus.TIMED_OUT) for number in range(5, 9)]
    results = results.with_runs(further)
    decision = decide(results, scenarios_of(results), GATE, accepted(old))
    assert asked_again == ("a",)
    assert to_confirm(decision, results, times=4) == ()


@pytest.mark.parametrize("before", [{"a": (0, 1)}, {"a": (1, 5)}], ids=["new", "worse"])
def test_a_failure_that_depends_on_the_seed_is_confirmed_twice(
    before: dict[str, tuple[int, int]],
) -> None:
    assert asked({"a": (5, 5)}, before, depends_on_seed=True) == {"a"}
    assert asked({"a": (5, 5)}, before) == set()
    assert asked({"a": (4, 5)}, before, depends_on_seed=True) == set()
    assert asked({"a": (9, 9)}, before, depends_on_seed=True) == set()


@given(
    st.dictionaries(
        st.sampled_from("abcdef"),
        st.tuples(st.integers(0, 3), st.just(3)),
        min_size=1,
    )
)
def test_results_pass_against_themselves(counts: dict[str, tuple[int, int]]) -> None:
    decision = judged(counts, counts)
    assert not decision.fails
    expected = {FailureClass.SAME, FailureClass.FLAKY}
    assert {one.failure_class for one in decision.failures} <= expected


@pytest.mark.parametrize("runs", [1, 3])
def test_an_unchanged_ads_with_flaky_failures_rarely_fails_the_gate(runs: int) -> None:
    """Of 40 gates with 100 scenarios, 30 of them flaky, at most one may fail."""
    rng = np.random.default_rng(11)
    failed = missed = 0
    for _ in range(40):
        rates = np.where(np.arange(100) < 30, rng.uniform(0.02, 0.9, 100), 0.0)
        before = {f"s{i}": (int(rng.binomial(5, rate)), 5) for i, rate in enumerate(rates)}
        now = {f"s{i}": (int(rng.binomial(runs, rate)), runs) for i, rate in enumerate(rates)}
        baseline = baseline_of(before)
        failed += confirmed_gate(rng, baseline, now, rates)
        # A regression: three further scenarios fail always.
        rates[97:] = 1.0
        worse = now | {f"s{i}": (runs, runs) for i in range(97, 100)}
        missed += not confirmed_gate(rng, baseline, worse, rates)
    assert failed <= 1
    assert missed == 0


def baseline_of(before: Mapping[str, tuple[int, int]]) -> Baseline:
    """Returns the baseline of failing runs of scenarios."""
    runs = [run for name, (k, n) in before.items() for run in counted(name, k, n)]
    return accepted(results_of(runs))


def confirmed_gate(
    rng: np.random.Generator,
    baseline: Baseline,
    now: Mapping[str, tuple[int, int]],
    rates: np.ndarray,
) -> bool:
    """Returns whether the gate fails after the confirmations that it asks for."""
    runs = [run for name, (k, n) in now.items() for run in counted(name, k, n)]
    results = results_of(runs)
    while True:
        decision = decide(results, scenarios_of(results), GATE, baseline)
        names = to_confirm(decision, results, times=GATE.confirm)
        if not names:
            return decision.fails
        again = []
        for name in names:
            first = len(results.of_scenario()[name])
            failing = rng.random(GATE.confirm) < rates[int(name[1:])]
            again += [
                by_chance(suite_run(name, first + number, *([verdict()] if fails else [])))
                for number, fails in enumerate(failing)
            ]
        results = results.with_runs(again)
