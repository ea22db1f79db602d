"""Laws as oracles: the contract, and verdicts with known answers."""

from __future__ import annotations

import json

import numpy as np
import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Light
from drivora_service.oracles.laws.law_judging import MOST_POINTS, LawOracle, violation_robustness
from drivora_service.oracles.verdict import Oracle, Outcome, Severity, Verdict
from drivora_service.testing.oracle_contract import OracleContract, example_runs
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace
from tests.oracles.judging import ROAD, judge, on_lane
from tests.oracles.laws.laws import law_of, library, shipped


class TestOwnLaw(OracleContract):
    def make_oracle(self) -> Oracle:
        return LawOracle(law=law_of("speed < 5 and (in_junction -> light_red)"))


class TestOwnLawOverTime(OracleContract):
    def make_oracle(self) -> Oracle:
        return LawOracle(
            law=law_of("historically[0:2] (speed_limit > 2) or speed < 1 until[0:3] turning")
        )


@pytest.mark.parametrize("name", library().names())
def test_every_shipped_law_judges_all_kinds_of_runs(name: str) -> None:
    oracle = shipped(name)
    for trace in example_runs():
        verdicts = oracle.judge(RunView(trace, ROAD))
        assert {verdict.ego for verdict in verdicts} == {
            a.id for a in trace.actors[: trace.ego_count]
        }
        assert all(verdict.oracle == name for verdict in verdicts)
        json.dumps([dict(verdict.evidence) for verdict in verdicts], allow_nan=False)


def _speeds(*speeds: float) -> SyntheticEgo:
    """An ego that drives each speed for a second."""
    each = np.repeat(speeds, 20)
    motion = Motion.along(np.concatenate(([0.0], np.cumsum(each[:-1] * 0.05))), 0.0, yaw=0.0)
    motion.states[:, 3] = each
    return on_lane(motion=motion)


def _judge(condition: str, ego: SyntheticEgo, severity: str = "minor") -> tuple[Verdict, ...]:
    return judge(LawOracle(law=law_of(condition, severity=severity)), ego)


def test_a_kept_law_has_its_least_robustness() -> None:
    (verdict,) = _judge("speed <= 9", _speeds(3.0, 8.0, 5.0))
    assert verdict.outcome is Outcome.PASSED
    assert dict(verdict.evidence) == {"robustness": 0.1, "ways": 1}, (
        "1 m/s below 9, of a scale of 10 m/s"
    )


@pytest.mark.parametrize(
    ("condition", "outcome"),
    [
        ("speed > 20 -> light_red", Outcome.NOT_APPLICABLE),
        ("speed > 7 -> speed < 9", Outcome.PASSED),
        ("speed > 7 -> light_red", Outcome.VIOLATED),
        # What is before the record may have been as the condition requires.
        ("historically[0:9] (speed > 2) -> speed < 9", Outcome.PASSED),
        # The same without an implication: a law of another form is always judged.
        ("not (speed > 20) or light_red", Outcome.PASSED),
    ],
)
def test_without_its_condition_a_law_has_nothing_to_judge(condition: str, outcome: Outcome) -> None:
    verdict, *_ = _judge(condition, _speeds(3.0, 8.0, 5.0))
    assert verdict.outcome is outcome
    assert verdict.evidence["ways"] == 1
    if outcome is Outcome.NOT_APPLICABLE:
        # A search still sees how near the condition was.
        assert verdict.evidence["robustness"] == 1.0
        assert verdict.message == "The condition of the law never held."


def test_a_violated_law_says_when_and_how() -> None:
    (verdict,) = _judge("speed <= 6 and speed_limit > 2", _speeds(3.0, 8.0, 9.0, 5.0))
    assert verdict.outcome is Outcome.VIOLATED
    assert (verdict.time, verdict.step, verdict.severity) == (1.0, 20, Severity.MINOR)
    assert verdict.at_fault
    evidence = dict(verdict.evidence)
    assert evidence["robustness"] == -0.3
    assert evidence["worst_time"] == 2.0
    assert evidence["until"] == pytest.approx(2.95)
    assert evidence["sub_violations"] == ["speed > 6 and speed_limit > 2"]
    assert (evidence["possible_sub_violations"], evidence["ways"]) == ([], 3)
    assert evidence["article"] == "nobody"
    assert evidence["formula"] == "always (speed <= 6 and speed_limit > 2)"
    assert verdict.message == "Own law: violated for 2.0 s (robustness -0.30)."


def test_the_severity_is_that_of_the_file() -> None:
    (verdict,) = _judge("speed < 1", _speeds(3.0), severity="observation")
    assert verdict.severity is Severity.OBSERVATION


def test_violations_a_second_apart_are_two() -> None:
    first, second = _judge("speed <= 6", _speeds(8.0, 5.0, 8.0))
    assert (first.time, second.time) == (0.0, 2.0)
    (joined,) = _judge("eventually[0:0.5] (speed_limit < 1) or speed <= 6", _speeds(8.0, 8.0))
    assert joined.time == 0.0


def test_the_end_of_the_record_is_taken_in_favour_of_the_ego() -> None:
    (verdict,) = _judge("speed > 6 -> eventually[0:3] (speed < 4)", _speeds(8.0, 8.0))
    assert verdict.outcome is Outcome.PASSED
    verdicts = _judge("speed > 6 -> eventually[0:0.5] (speed < 4)", _speeds(8.0, 8.0))
    assert verdicts[0].evidence["until"] == pytest.approx(1.45)


def test_the_begin_of_the_record_is_taken_in_favour_of_the_ego() -> None:
    (verdict,) = _judge("not historically[0:3] (speed < 4)", _speeds(1.0, 1.0))
    assert verdict.outcome is Outcome.PASSED
    (verdict,) = _judge("not historically[0:1] (speed < 4)", _speeds(1.0, 1.0))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.time == 1.0


def test_the_curve_is_bounded_and_keeps_the_extremes() -> None:
    speeds = [5.0] * 30 + [9.0] + [5.0] * 30
    (verdict,) = _judge("speed <= 6", _speeds(*speeds))
    times, values = verdict.evidence["curve_times"], verdict.evidence["curve_robustness"]
    assert len(times) == len(values) == MOST_POINTS
    assert min(values) == verdict.evidence["robustness"] == -0.3
    assert times == sorted(times)
    assert len(json.dumps(dict(verdict.evidence))) < 3000
    (short,) = _judge("speed <= 6", _speeds(9.0))
    assert len(short.evidence["curve_times"]) == 20


def test_how_it_is_violated_where_the_record_ends_too_soon_to_tell() -> None:
    text = "not light_red and always[1:3] light_red"
    (verdict,) = _judge(text, on_lane(motion=Motion.steady(0.0, 0.0, steps=10), light=Light.RED))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.evidence["sub_violations"] == []
    assert verdict.evidence["possible_sub_violations"] == [
        "light_red and always[1:3] (light_red)",
        "light_red and eventually[1:3] (not light_red)",
    ]


def test_robustness_of_violations_over_a_run() -> None:
    trace = make_trace([_speeds(3.0, 8.0)])
    (ego,) = RunView(trace, ROAD).egos
    law = law_of("speed <= 6 and speed_limit > 2")
    only_speed, only_limit, both = violation_robustness(ego, law.sub_violations)
    assert only_speed == pytest.approx(0.2)
    assert only_limit == pytest.approx(-0.8)
    assert both == pytest.approx(-0.8)
