"""The failures of the runs of a suite."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from drivora_service.oracles.verdict import Answer, Severity
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import (
    Counted,
    FailureDefinition,
    KnownFailure,
)
from drivora_service.runs.run_report import RunStatus
from drivora_service.suites.suite import MetricBounds
from drivora_service.suites.suite_failures import FailureKey, find_failures, is_seedless
from tests.suites.made_results import results_of, scenarios_of, suite_run, verdict


def test_a_failure_is_found_in_some_runs_of_its_scenario() -> None:
    results = results_of(
        [
            suite_run("a", 0),
            suite_run("a", 1, verdict(avoidable=Answer.NOT_MEASURABLE)),
            suite_run("a", 2, verdict(), verdict(), verdict(counterpart="other")),
            suite_run("b", 0),
        ]
    )
    found = find_failures(results, scenarios_of(results))
    first = found.failures[
        FailureKey(scenario="a", oracle="collision", ego="ego", counterpart="npc")
    ]
    assert (first.runs, first.of, first.seeds, first.run_id) == (2, 3, (101, 102), "a-1")
    assert first.accountability is Accountability.AVOIDABLE
    assert len(found.failures) == 2
    assert found.judged == {"a": 3, "b": 1}


@pytest.mark.parametrize(
    ("changes", "counted"),
    [
        ({}, set(Counted)),
        ({"at_fault": None, "avoidable": None}, set(Counted)),
        ({"avoidable": Answer.NO}, {"at_fault", "possibly_at_fault", "any"}),
        ({"at_fault": False}, {"preventable", "any"}),
        ({"at_fault": False, "avoidable": Answer.NO}, {"any"}),
        ({"at_fault": None, "undetermined": True}, {"possibly_at_fault", "any"}),
        ({"severity": Severity.OBSERVATION}, set()),
        ({"oracle": "destination", "evidence": {"reason": "collision"}, "at_fault": None}, set()),
        (
            {"oracle": "destination", "evidence": {"reason": "timeout"}, "at_fault": None},
            set(Counted),
        ),
    ],
)
def test_what_counts(changes: dict[str, Any], counted: set[str]) -> None:
    results = results_of([suite_run("a", 0, verdict(**changes))])
    for which in Counted:
        found = find_failures(results, scenarios_of(results), gate=FailureDefinition(counts=which))
        assert bool(found.failures) == (which in counted)
        # What a scenario says comes first.
        for other in Counted:
            own = scenarios_of(results, counts=which)
            assert bool(
                find_failures(results, own, gate=FailureDefinition(counts=other)).failures
            ) == (which in counted)


def test_named_oracles_count_also_if_they_are_observations() -> None:
    results = results_of(
        [suite_run("a", 0, verdict("discomfort", severity=Severity.OBSERVATION), verdict())]
    )
    scenarios = scenarios_of(results)
    named = FailureDefinition(oracles=("discomfort",))
    assert [k.oracle for k in find_failures(results, scenarios, gate=named).failures] == [
        "discomfort"
    ]
    own = scenarios_of(results, oracles=frozenset({"collision"}))
    assert [k.oracle for k in find_failures(results, own, gate=named).failures] == ["collision"]


def test_known_failures_do_not_count_and_are_told() -> None:
    runs = [suite_run("a", 0, verdict()), suite_run("a", 1, verdict(), verdict("off_road"))]
    results = results_of(runs)
    known = KnownFailure(oracle="collision", counterpart="npc", reason="issue 17")
    gone = KnownFailure(oracle="red_light", reason="issue 18")
    others = KnownFailure(agents=("pdm-closed",), reason="issue 19")
    found = find_failures(results, scenarios_of(results, known_failures=(known, gone, others)))
    assert [key.oracle for key in found.failures] == ["off_road"]
    assert [(one.known.reason, one.runs) for one in found.known] == [
        ("issue 17", 2),
        ("issue 18", 0),
    ]


def test_a_failure_known_of_one_ads_counts_for_an_ego_that_another_drives() -> None:
    agents = {"ego": "idm", "other": "pdm-closed"}
    results = results_of([suite_run("a", 0, verdict(), agents=agents)])

    def oracles(agent: str) -> tuple[list[str], list[int]]:
        known = KnownFailure(oracle="collision", agents=(agent,), reason="x")
        found = find_failures(results, scenarios_of(results, known_failures=(known,)))
        return [key.oracle for key in found.failures], [one.runs for one in found.known]

    assert oracles("pdm-closed") == (["collision"], [0])
    assert oracles("idm") == ([], [1])


def test_a_known_failure_is_of_any_ads_that_could_not_be_made_ready() -> None:
    failed = suite_run("a", 0, status=RunStatus.AGENT_FAILED, agents={"": "idm,pdm-closed"})
    results = results_of([failed])
    known = KnownFailure(agents=("pdm-closed",), reason="x")
    assert not find_failures(results, scenarios_of(results, known_failures=(known,))).failures


def test_the_only_ego_has_the_metrics_of_the_run() -> None:
    results = results_of([suite_run("a", 0, metrics={"driving_score": 10.0})])
    bounds = {"driving_score[ego]": MetricBounds(at_least=60.0)}
    found = find_failures(results, scenarios_of(results, metrics=bounds))
    assert [key.oracle for key in found.failures] == ["metric driving_score[ego]"]
    both = results_of(
        [suite_run("a", 0, agents={"ego": "idm", "x": "idm"}, metrics={"comfort": 1})]
    )
    assert both.runs[0].value_of("comfort[ego]") is None


def test_an_ads_that_fails_is_a_failure_and_a_lost_worker_is_not() -> None:
    failed = suite_run(
        "a", 0, status=RunStatus.AGENT_FAILED, cause="agent_raised", message="No such lane."
    )
    lost = suite_run("a", 1, status=RunStatus.INFRASTRUCTURE_FAILED, cause="worker_lost")
    results = results_of([failed, lost])
    found = find_failures(results, scenarios_of(results))
    (failure,) = found.failures.values()
    assert failure.key.oracle == "agent_failed"
    assert (failure.runs, failure.of) == (1, 1)
    assert failure.sentence == "The ADS failed (agent_raised): No such lane."
    assert found.unfinished == (lost,)


def test_metrics_outside_their_bounds_are_failures() -> None:
    runs = [
        suite_run("a", number, metrics={"driving_score": value})
        for number, value in enumerate((60.0, 59.9, None))
    ]
    results = results_of(runs)
    bounds = {"driving_score": MetricBounds(at_least=60.0, at_most=90.0)}
    found = find_failures(results, scenarios_of(results, metrics=bounds))
    (failure,) = found.failures.values()
    assert (failure.key.oracle, failure.runs, failure.of) == ("metric driving_score", 1, 3)
    assert failure.sentence == "driving_score is 59.9, and at least 60 and at most 90 is expected."


def test_runs_are_the_same_under_all_seeds_if_all_that_is_measured_is() -> None:
    same = [suite_run("a", number, verdict()) for number in range(3)]
    assert is_seedless(same)
    assert not is_seedless(same[:1])
    assert not is_seedless([*same, suite_run("a", 3, verdict(counterpart="other"))])
    assert not is_seedless([*same, suite_run("a", 3, verdict(), sim_time_s=10.05)])
    # A run that was not judged says nothing; an ADS that fails in some runs does.
    assert is_seedless([*same, suite_run("a", 3, status=RunStatus.TIMED_OUT)])
    failed = suite_run("a", 3, status=RunStatus.AGENT_FAILED, cause="agent_raised", metrics={})
    hung = replace(failed, cause="agent_hung")
    assert not is_seedless([*same, failed])
    assert is_seedless([failed, failed])
    assert not is_seedless([failed, hung])
    assert not is_seedless([*same, suite_run("a", 3, verdict(), metrics={"driving_score": 50.1})])
