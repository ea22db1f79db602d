"""Failures that are clearly more severe than in the baseline."""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from drivora_service.errors import ConfigurationError
from drivora_service.oracles.verdict import Answer, Severity, Verdict
from drivora_service.suites.gate.baseline import (
    Baseline,
    baseline_changes,
    make_baseline,
)
from drivora_service.suites.gate.baseline_files import baseline_text, read_baseline
from drivora_service.suites.gate.failure_classes import FailureClass
from drivora_service.suites.gate.gate_decision import ClassifiedFailure, Decision
from drivora_service.suites.gate.gate_documents import GateDocument
from drivora_service.suites.gate.gating import decide, to_confirm
from drivora_service.suites.gate.severity_changes import p_of_greater
from drivora_service.suites.suite import MetricBounds
from drivora_service.suites.suite_failures import find_failures
from drivora_service.suites.suite_results import SuiteResults, SuiteRun
from tests.suites.made_results import results_of, scenarios_of, suite_run, verdict

GATE = GateDocument()
TOUCH, CRASH = 1.0, 15.0


def crash(speed: float, **changes: Any) -> Verdict:
    """Returns an avoidable collision at a relative speed."""
    return verdict(evidence={"relative_speed": speed, "counterpart_role": "npc_vehicle"}, **changes)


def off_road(depth: float, seconds: float) -> Verdict:
    return verdict(
        "off_road",
        counterpart="",
        severity=Severity.MAJOR,
        avoidable=None,
        evidence={"distance": depth, "duration": seconds},
    )


def runs_at(
    speeds: Sequence[float | None], scenario: str = "a", *, first: int = 0
) -> list[SuiteRun]:
    """Returns runs with a collision at a speed each; ``None``: a run without one."""
    return [
        suite_run(
            scenario,
            first + number,
            *(() if speed is None else (crash(speed),)),
            sim_time_s=10.0 + first + number,
        )
        for number, speed in enumerate(speeds)
    ]


def accepted(results: SuiteResults, **changes: Any) -> Baseline:
    scenarios = scenarios_of(results, **changes)
    return make_baseline(results, find_failures(results, scenarios), metrics=())


def compared(before: Sequence[SuiteRun], now: Sequence[SuiteRun], **changes: Any) -> Decision:
    old, new = results_of(before), results_of(now)
    return decide(new, scenarios_of(new, **changes), GATE, accepted(old, **changes))


def only(decision: Decision) -> ClassifiedFailure:
    (one,) = decision.failures
    return one


def class_of(before: Sequence[float | None], now: Sequence[float | None]) -> FailureClass:
    return only(compared(runs_at(before), runs_at(now))).failure_class


def test_an_accepted_touch_does_not_hide_a_crash() -> None:
    decision = compared(runs_at([TOUCH]), runs_at([CRASH]))
    one = only(decision)
    assert one.failure_class is FailureClass.WORSE
    assert decision.fails
    assert one.growth == "more severe: impact speed 1.0 → 15.0 m/s"
    assert one.change == (
        "fails in 1 of 1 run, before in 1 of 1 run; more severe: impact speed 1.0 → 15.0 m/s"
    )
    assert decision.reasons == (
        "1 worse failure: a: collision of ego with npc (more severe: impact speed 1.0 → 15.0 m/s)",
    )


def test_a_failure_off_the_road_that_grows_is_worse() -> None:
    now = [suite_run("a", 0, off_road(0.5, 1.1))]
    one = only(compared([suite_run("a", 0, off_road(0.3, 0.0))], now))
    assert one.failure_class is FailureClass.WORSE
    assert one.growth == ("more severe: depth 0.30 → 0.50 m, duration 0.0 → 1.1 s")
    assert only(compared(now, now)).failure_class is FailureClass.SAME


@pytest.mark.parametrize(
    ("before", "now", "expected"),
    [
        ([TOUCH], [TOUCH + 1.9], FailureClass.SAME),
        ([10.0], [12.4], FailureClass.SAME),
        ([10.0], [12.5], FailureClass.WORSE),
        ([CRASH], [TOUCH], FailureClass.SAME),
        ([TOUCH] * 10, [CRASH] * 9, FailureClass.WORSE),
        # One unlucky run.
        ([TOUCH] * 5, [CRASH, *[TOUCH] * 4], FailureClass.SAME),
        ([TOUCH] * 5, [CRASH, *[None] * 8], FailureClass.FLAKY),
        ([TOUCH] * 5, [CRASH, *[TOUCH] * 100], FailureClass.SAME),
        # Runs that differ from seed to seed: the baseline says how much.
        ([TOUCH, 5.0, CRASH], [CRASH], FailureClass.SAME),
        ([TOUCH], [CRASH, 9.0, 4.0, CRASH, 6.0], FailureClass.SAME),
        (
            [TOUCH, 2.0, 4.0, 6.0, 5.0],
            [12.0, 15.0, 9.0, 14.0, 3.0, 15.0, 16.0, 11.0, 15.0],
            "worse",
        ),
        # All now are worse, by more than the runs of a side differ; and by less.
        ([TOUCH, 4.0], [CRASH, 12.0, 18.0], FailureClass.WORSE),
        ([TOUCH, 9.0], [12.0, CRASH, 18.0], FailureClass.SAME),
        # It occurs in some runs, before and now.
        ([TOUCH, TOUCH, None], [CRASH, CRASH, None], FailureClass.FLAKY),
        ([TOUCH] * 6 + [None] * 4, [CRASH] * 6 + [None] * 3, FailureClass.WORSE),
    ],
)
def test_classes_by_the_speed_of_impact(
    before: list[float | None], now: list[float | None], expected: FailureClass
) -> None:
    assert class_of(before, now) is FailureClass(expected)


def test_a_growth_that_may_be_chance_is_shown_with_its_test() -> None:
    before, now = [1.0, 2.0, 4.0, 6.0, 15.0], [12.0, 15.0, 2.0, 14.0, 3.0]
    one = only(compared(runs_at(before), runs_at(now)))
    assert one.failure_class is FailureClass.SAME
    assert one.growth == (
        "more severe, perhaps by chance: impact speed 4.0 → 12.0 m/s (p 0.26, one-sided rank test "
        "of Mann and Whitney, corrected by Holm)"
    )


def test_a_graver_class_of_the_oracle_is_worse() -> None:
    def blocking(severity: Severity) -> list[SuiteRun]:
        found = verdict("junction_blocking", severity=severity, evidence={"duration": 12.0})
        return [suite_run("a", 0, found)]

    one = only(compared(blocking(Severity.MINOR), blocking(Severity.MAJOR)))
    assert one.failure_class is FailureClass.WORSE
    assert one.growth == "more severe: severity class minor → major"
    back = only(compared(blocking(Severity.MAJOR), blocking(Severity.MINOR)))
    assert back.failure_class is FailureClass.SAME


def test_a_metric_further_beyond_its_bound_is_worse() -> None:
    bounds = {"driving_score": MetricBounds(at_least=60.0)}
    runs = {
        score: [suite_run("a", 0, metrics={"driving_score": score})] for score in (55.0, 54.0, 20.0)
    }
    decision = compared(runs[55.0], runs[20.0], metrics=bounds)
    assert only(decision).failure_class is FailureClass.WORSE
    assert "value beyond its bound 5.0 → 40.0" in only(decision).growth
    assert only(compared(runs[55.0], runs[54.0], metrics=bounds)).failure_class is FailureClass.SAME


def test_an_avoidability_that_changes_is_mentioned_and_no_class() -> None:
    def collisions(avoidable: Answer) -> list[SuiteRun]:
        return [suite_run("a", 0, crash(TOUCH, avoidable=avoidable))]

    before, now = collisions(Answer.NOT_MEASURABLE), collisions(Answer.YES)
    one = only(compared(before, now))
    assert one.failure_class is FailureClass.SAME
    assert one.change.endswith("; was at fault, avoidable or not: not measurable, is at fault")


@given(st.lists(st.none() | st.floats(0.0, 30.0), min_size=1, max_size=6))
def test_results_are_not_worse_than_themselves(speeds: list[float | None]) -> None:
    decision = compared(runs_at(speeds), runs_at(speeds))
    assert not decision.fails
    assert all(not one.is_more_severe and not one.growth for one in decision.failures)


def test_a_failure_that_is_more_severe_is_confirmed_twice() -> None:
    old = accepted(results_of(runs_at([TOUCH] * 5)))
    results = results_of(runs_at([CRASH]))
    asked = []
    for _ in range(4):
        decision = decide(results, scenarios_of(results), GATE, old)
        names = to_confirm(decision, results, times=4)
        asked.append(names)
        made = len(results.runs)
        if names:
            results = results.with_runs(runs_at([CRASH] * 4, first=made))
    assert asked == [("a",), ("a",), (), ()]
    assert (
        only(decide(results, scenarios_of(results), GATE, old)).failure_class is FailureClass.WORSE
    )


def test_one_unlucky_run_is_confirmed_and_no_alarm() -> None:
    old = accepted(results_of(runs_at([TOUCH] * 5)))
    results = results_of(runs_at([CRASH]))
    assert to_confirm(decide(results, scenarios_of(results), GATE, old), results, times=4) == ("a",)
    results = results.with_runs(runs_at([TOUCH] * 4, first=1))
    decision = decide(results, scenarios_of(results), GATE, old)
    assert only(decision).failure_class is FailureClass.SAME
    assert to_confirm(decision, results, times=4) == ()


@dataclass(frozen=True, kw_only=True)
class Varying:
    """An ADS whose collisions vary in their speed, more in some scenarios than in others."""

    rng: np.random.Generator
    scales: Sequence[float]
    spreads: Sequence[float]
    crashes: bool = False

    def drive(self, number: int, count: int) -> list[float]:
        if self.crashes and number == 0:
            return [60.0] * count
        factors = np.exp(self.spreads[number] * self.rng.standard_normal(count))
        speeds: list[float] = (self.scales[number] * factors).tolist()
        return speeds


def test_an_ads_whose_failures_vary_in_severity_rarely_fails_the_gate() -> None:
    """Of 40 gates with 40 failures that vary, at most one may fail; a regression fails each."""
    rng = np.random.default_rng(5)
    failed = missed = 0
    for _ in range(40):
        ads = Varying(
            rng=rng,
            scales=[2.0, *rng.uniform(1.0, 8.0, 39)],
            spreads=[0.6, *rng.choice([0.0, 0.2, 0.6, 1.0], 39)],
        )
        old = accepted(results_of([run for i in range(40) for run in runs_of(ads, i, 5)]))
        failed += fails_confirmed(old, ads)
        missed += not fails_confirmed(old, replace(ads, crashes=True))
    assert failed <= 1
    assert missed == 0


def runs_of(ads: Varying, number: int, count: int, *, first: int = 0) -> list[SuiteRun]:
    return runs_at(ads.drive(number, count), f"s{number}", first=first)


def fails_confirmed(baseline: Baseline, ads: Varying) -> bool:
    """Returns whether the gate fails after the confirmations that it asks for."""
    results = results_of([run for number in range(40) for run in runs_of(ads, number, 1)])
    while True:
        decision = decide(results, scenarios_of(results), GATE, baseline)
        names = to_confirm(decision, results, times=GATE.confirm)
        if not names:
            return decision.fails
        for name in names:
            made = len(results.of_scenario()[name])
            results = results.with_runs(runs_of(ads, int(name[1:]), GATE.confirm, first=made))


def test_a_baseline_keeps_the_severity_of_its_failures(tmp_path: Path) -> None:
    results = results_of(runs_at([TOUCH, 2.0, None]))
    baseline = accepted(results)
    path = tmp_path / "baseline.json"
    path.write_text(baseline_text(baseline))
    assert read_baseline(path) == baseline
    (failure,) = baseline.scenarios["a"].failures
    assert [one.values for one in failure.magnitudes] == [(TOUCH, 2.0)]
    assert failure.severities == (Severity.CRITICAL, Severity.CRITICAL)


def test_a_baseline_without_severities_is_read_and_nothing_is_compared(tmp_path: Path) -> None:
    content = json.loads(baseline_text(accepted(results_of(runs_at([TOUCH])))))
    for key in ("severities", "magnitudes"):
        del content["scenarios"]["a"]["failures"][0][key]
    del content["configuration"]
    path = tmp_path / "old.json"
    path.write_text(json.dumps(content))
    now = results_of(runs_at([CRASH]))
    one = only(decide(now, scenarios_of(now), GATE, read_baseline(path)))
    assert one.failure_class is FailureClass.SAME
    assert one.growth == ""


def test_a_baseline_whose_values_are_not_those_of_its_runs_is_refused(tmp_path: Path) -> None:
    content = json.loads(baseline_text(accepted(results_of(runs_at([TOUCH])))))
    content["scenarios"]["a"]["failures"][0]["magnitudes"][0]["values"] = []
    path = tmp_path / "wrong.json"
    path.write_text(json.dumps(content))
    with pytest.raises(ConfigurationError, match="impact_speed has 0 values"):
        read_baseline(path)


def test_accepting_a_more_severe_failure_shows_it() -> None:
    old, new = (accepted(results_of(runs_at([speed]))) for speed in (TOUCH, CRASH))
    (change,) = baseline_changes(old, new)
    assert change.before == "fails in 1 of 1"
    assert change.after == "fails in 1 of 1; more severe: impact speed 1.0 → 15.0 m/s"
    (back,) = baseline_changes(new, old)
    assert back.after == "fails in 1 of 1; less severe: impact speed 15.0 → 1.0 m/s"
    assert not list(baseline_changes(old, old))


def test_accepting_another_accountability_shows_it() -> None:
    old, new = (
        accepted(results_of([suite_run("a", 0, crash(TOUCH, avoidable=avoidable))]))
        for avoidable in (Answer.NOT_MEASURABLE, Answer.YES)
    )
    (change,) = baseline_changes(old, new)
    assert change.before.endswith("; at fault, avoidable or not: not measurable")
    assert change.after.endswith("; at fault")


def test_a_baseline_has_the_configuration_of_its_ads() -> None:
    run = replace(
        runs_at([TOUCH])[0], configuration="idm · reaction_time 1.0", configuration_id="abc"
    )
    baseline = accepted(results_of([run], versions={"drivora": "1.2"}))
    assert baseline.subject == "idm · reaction_time 1.0; drivora 1.2"
    assert replace(baseline, configuration="", versions={}).subject == "idm"


@given(
    st.lists(st.integers(0, 5), min_size=1, max_size=5),
    st.lists(st.integers(0, 5), min_size=1, max_size=4),
)
def test_the_test_of_ranks_counts_all_divisions(before: list[int], now: list[int]) -> None:
    ranks = stats.rankdata([*before, *now])
    observed = sum(ranks[len(before) :])
    sums = [sum(chosen) for chosen in itertools.combinations(ranks, len(now))]
    expected = sum(one >= observed - 1e-9 for one in sums) / len(sums)
    assert p_of_greater(before, now) == pytest.approx(expected)


def test_of_many_runs_the_test_of_ranks_is_the_normal_one() -> None:
    rng = np.random.default_rng(1)
    before, now = rng.normal(size=60).tolist(), (rng.normal(size=41) + 0.4).tolist()
    exact = stats.mannwhitneyu(now, before, alternative="greater", method="exact").pvalue
    assert p_of_greater(before, now) == pytest.approx(exact, rel=0.1)
    assert p_of_greater(before[:50], now) == pytest.approx(
        stats.mannwhitneyu(now, before[:50], alternative="greater", method="exact").pvalue
    )
