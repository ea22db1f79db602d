"""What oracles say of an ego that gave them nothing to judge."""

from __future__ import annotations

import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import TerminalEvent
from drivora_service.oracles.built_in import default_oracles, judge_all
from drivora_service.oracles.verdict import WITHOUT_FINDING, Outcome, not_applicable
from drivora_service.testing.oracle_contract import example_runs
from drivora_service.testing.traces import Motion, make_trace
from tests.oracles.judging import ROAD, on_lane
from tests.oracles.laws.laws import library, shipped


def test_outcomes_are_named_in_words() -> None:
    assert [one.in_words for one in Outcome] == [
        "passed",
        "violated",
        "nothing to judge",
        "not measurable",
    ]
    assert {Outcome.PASSED, Outcome.NOT_APPLICABLE} == WITHOUT_FINDING


def test_a_verdict_without_anything_to_judge_has_a_reason_and_no_moment() -> None:
    (ego,) = RunView(make_trace([on_lane(motion=Motion.steady(0.0, 0.0, steps=9))]), ROAD).egos
    verdict = not_applicable("own", ego, "Nothing was there.", lines=0)
    assert (verdict.outcome, verdict.message) == (Outcome.NOT_APPLICABLE, "Nothing was there.")
    assert (verdict.step, verdict.time, verdict.location) == (None, None, None)
    assert verdict.evidence == {"lines": 0}


def test_an_ego_alone_on_a_straight_road_gives_most_oracles_nothing_to_judge() -> None:
    motion = Motion.steady(0.0, 0.0, steps=400, speed=9.0)
    ego = on_lane(motion=motion, end=TerminalEvent.ARRIVED)
    verdicts = judge_all(make_trace([ego]), ROAD, default_oracles())
    assert {v.oracle: v.message for v in verdicts if v.outcome is Outcome.NOT_APPLICABLE} == {
        "red_light": "No stop line with a signal on the way.",
        "stop_sign": "No stop sign on the way.",
        "failure_to_yield": "No junction or crossing on the way where others have the right of "
        "way.",
        "junction_blocking": "Drove into no junction.",
        "deadlock": "The run has no other ego to wait for.",
        "near_miss": "No other actor in the run.",
        "tailgating": "No vehicle ahead within 100 m that goes the same way.",
    }
    rest = {v.oracle for v in verdicts if v.outcome is Outcome.PASSED}
    assert {"collision", "off_road", "lane_keeping", "blocked", "destination"} <= rest


@pytest.mark.parametrize("name", library().names())
def test_a_law_has_nothing_to_judge_only_if_its_condition_never_held(name: str) -> None:
    oracle = shipped(name)
    for trace in example_runs():
        for verdict in oracle.judge(RunView(trace, ROAD)):
            if verdict.outcome is Outcome.NOT_APPLICABLE:
                assert oracle.law.condition is not None
                assert verdict.evidence["robustness"] >= 0.0
