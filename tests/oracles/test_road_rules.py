"""Off road, wrong way, lane keeping, route deviation: where an ego may be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.oracles.lane_keeping import LaneKeeping
from drivora_service.oracles.off_road import OffRoad
from drivora_service.oracles.route_deviation import RouteDeviation
from drivora_service.oracles.verdict import Outcome
from drivora_service.oracles.wrong_way import WrongWay
from drivora_service.testing.networks import CROSSING, EAST, WEST
from drivora_service.testing.traces import Motion
from tests.oracles.judging import judge, on_lane, outcomes

STEPS = 100
K = np.arange(STEPS)


def shifted(lateral: np.ndarray) -> Motion:
    return Motion.along(0.5 * K, lateral, yaw=0.0)


@pytest.mark.parametrize(
    ("lateral", "outcome"),
    # The right edge of the road is at y = -1.75 m and the ego 1.8 m wide: 0.85 m to spare.
    [(-0.84, Outcome.PASSED), (-1.14, Outcome.PASSED), (-1.16, Outcome.VIOLATED)],
)
def test_a_corner_may_be_thirty_centimetres_off_the_road(lateral: float, outcome: Outcome) -> None:
    ego = on_lane(motion=shifted(np.full(STEPS, lateral)), lane_lateral=lateral)
    (verdict,) = judge(OffRoad(), ego)
    assert verdict.outcome is outcome
    assert verdict.evidence["distance"] == pytest.approx(max(-lateral - 0.85, 0.0), abs=1e-3)


def test_the_other_lanes_are_road_too() -> None:
    lateral = np.linspace(0.0, 7.0, STEPS)
    ego = on_lane(motion=shifted(lateral), lane_lateral=lateral)
    assert outcomes(judge(OffRoad(), ego)) == [Outcome.PASSED]


def test_every_time_off_the_road_is_a_violation_with_its_extent() -> None:
    lateral = np.where((K >= 20) & (K < 40) | (K >= 60) & (K < 70), -3.0, 0.0)
    verdicts = judge(OffRoad(), on_lane(motion=shifted(lateral), lane_lateral=lateral))
    assert [verdict.step for verdict in verdicts] == [20, 60]
    assert verdicts[0].evidence["distance"] == pytest.approx(2.15, abs=1e-3)
    assert verdicts[0].evidence["duration"] == pytest.approx(20 * 0.05)


@pytest.mark.parametrize(
    ("rows", "depth", "outcome"),
    [
        (1, 0.31, Outcome.PASSED),
        (5, 0.49, Outcome.PASSED),
        (6, 0.31, Outcome.VIOLATED),
        (1, 0.51, Outcome.VIOLATED),
        (STEPS, 0.29, Outcome.PASSED),
    ],
)
def test_a_shallow_excess_counts_if_it_lasts(rows: int, depth: float, outcome: Outcome) -> None:
    lateral = np.where((K >= 20) & (20 + rows > K), -0.85 - depth, 0.0)
    (verdict,) = judge(OffRoad(), on_lane(motion=shifted(lateral), lane_lateral=lateral))
    assert verdict.outcome is outcome
    assert verdict.evidence["distance"] == pytest.approx(depth, abs=1e-3)
    if outcome is Outcome.VIOLATED or depth > 0.3:
        assert verdict.evidence["duration"] == pytest.approx(0.05 * rows)
        assert "Stayed on the road" not in verdict.message
    else:
        assert verdict.message == "Stayed on the road."


def test_short_excesses_beside_a_long_one_are_no_violations() -> None:
    lateral = np.where((K == 10) | ((K >= 20) & (K < 40)), -1.2, 0.0)
    verdicts = judge(OffRoad(), on_lane(motion=shifted(lateral), lane_lateral=lateral))
    assert [verdict.step for verdict in verdicts] == [20]


def test_a_turned_box_reaches_further() -> None:
    ego = on_lane(motion=Motion.along(0.5 * K, 0.0, yaw=math.pi / 2))
    (verdict,) = judge(OffRoad(), ego)
    assert verdict.evidence["distance"] == pytest.approx(2.25 - 1.75, abs=1e-3)


@pytest.mark.parametrize(
    ("speed", "outcome", "severe"),
    [
        (-1.9, Outcome.PASSED, None),
        (-2.1, Outcome.VIOLATED, False),
        (-5.9, Outcome.VIOLATED, False),
        (-6.1, Outcome.VIOLATED, True),
        (8.0, Outcome.PASSED, None),
    ],
)
def test_two_metres_a_second_against_the_lane_are_the_wrong_way(
    speed: float, outcome: Outcome, severe: bool | None
) -> None:
    motion = Motion.steady(0.0, 0.0, steps=STEPS, speed=speed)
    (verdict,) = judge(WrongWay(), on_lane(motion=motion))
    assert verdict.outcome is outcome
    assert verdict.evidence.get("severe") == severe


def test_the_lane_decides_what_is_wrong() -> None:
    motion = Motion.steady(0.0, 7.0, steps=STEPS, speed=8.0)
    west = on_lane(motion=motion, lane=WEST, lane_heading=math.pi)
    assert outcomes(judge(WrongWay(), west)) == [Outcome.VIOLATED]


def test_inside_a_junction_there_is_no_wrong_way() -> None:
    motion = Motion.steady(515.0, 0.0, steps=STEPS, speed=-8.0)
    assert outcomes(judge(WrongWay(), on_lane(motion=motion, lane=CROSSING))) == [
        Outcome.NOT_APPLICABLE
    ]


def test_a_short_roll_back_is_excused() -> None:
    x = np.where(K < 20, -0.09 * K, -1.8)
    motion = Motion.along(x, 0.0, yaw=0.0)
    assert outcomes(judge(WrongWay(), on_lane(motion=motion))) == [Outcome.PASSED]


def test_without_any_lane_the_way_cannot_be_judged() -> None:
    motion = Motion.steady(0.0, -90.0, steps=STEPS, speed=8.0)
    ego = on_lane(motion=motion, lane=-1, lane_heading=np.nan, lane_lateral=np.nan)
    assert outcomes(judge(WrongWay(), ego)) == [Outcome.NOT_MEASURABLE]


@pytest.mark.parametrize(
    # The edge of the outermost lane is at y = -1.75 m; half a metre more is within.
    ("y", "outcome"),
    [(-2.2, Outcome.PASSED), (-2.3, Outcome.VIOLATED)],
)
def test_half_a_metre_beyond_the_lanes_is_kept(y: float, outcome: Outcome) -> None:
    motion = Motion.steady(0.0, y, steps=STEPS, speed=8.0)
    ego = on_lane(motion=motion, lane=-1, lane_heading=np.nan, lane_lateral=np.nan)
    assert outcomes(judge(LaneKeeping(), ego)) == [outcome]


def test_the_share_of_the_route_outside_the_lanes() -> None:
    y = np.where(K >= 60, -5.0, 0.0)
    ego = on_lane(
        motion=Motion.along(0.5 * K, 0.0, yaw=0.0),
        lane=np.where(K >= 60, -1, EAST),
        lane_lateral=np.where(K >= 60, np.nan, 0.0),
    )
    ego.motion.states[:, 1] = y
    (verdict,) = judge(LaneKeeping(), ego)
    driven = 39 * 0.5 + math.hypot(0.5, 5.0)
    assert verdict.step == 60
    assert verdict.evidence["distance"] == pytest.approx(driven)
    assert verdict.evidence["share"] == pytest.approx(driven / 400.0)
    assert verdict.evidence["oncoming_distance"] == 0.0


@pytest.mark.parametrize(
    ("rows", "speed", "outcome"),
    [
        (1, 30.0, Outcome.PASSED),  # one row of a lane's geometry, whatever the speed
        (2, 30.0, Outcome.PASSED),
        (3, 6.0, Outcome.PASSED),  # 0.9 m
        (3, 8.0, Outcome.VIOLATED),  # 1.2 m in 0.15 s
    ],
)
def test_a_moment_in_the_wrong_lane_does_not_count(
    rows: int, speed: float, outcome: Outcome
) -> None:
    wrong = np.isin(K, np.arange(40, 40 + rows))
    ego = on_lane(
        motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=speed),
        lane=np.where(wrong, WEST, EAST),
        lane_heading=np.where(wrong, math.pi, 0.0),
    )
    assert outcomes(judge(LaneKeeping(), ego)) == [outcome]


def test_oncoming_lanes_are_not_the_egos() -> None:
    motion = Motion.steady(0.0, 7.0, steps=STEPS, speed=8.0)
    (verdict,) = judge(LaneKeeping(), on_lane(motion=motion, lane=WEST, lane_heading=math.pi))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.evidence["oncoming_distance"] == pytest.approx(99 * 0.4)


def test_standing_outside_the_lanes_covers_no_distance() -> None:
    motion = Motion.steady(0.0, -9.0, steps=STEPS)
    ego = on_lane(motion=motion, lane=-1, lane_heading=np.nan, lane_lateral=np.nan)
    assert outcomes(judge(LaneKeeping(), ego)) == [Outcome.PASSED]


@pytest.mark.parametrize(
    ("lateral", "outcome"),
    [(29.9, Outcome.PASSED), (30.1, Outcome.VIOLATED), (-30.1, Outcome.VIOLATED)],
)
def test_thirty_metres_off_the_route_are_too_far(lateral: float, outcome: Outcome) -> None:
    motion = Motion.steady(0.0, 0.0, steps=STEPS, speed=8.0)
    ego = on_lane(motion=motion, route_lateral=np.where(K == 50, lateral, 0.0))
    (verdict,) = judge(RouteDeviation(), ego)
    assert verdict.outcome is outcome
    assert verdict.step == (50 if outcome is Outcome.VIOLATED else None)


@pytest.mark.parametrize(("length", "violated"), [(131.0, True), (133.0, False)])
def test_a_third_of_the_route_beside_it_is_too_much(length: float, violated: bool) -> None:
    # 99 steps of 0.4 m beside a route of which 30 % may be: 39.6 m of 132 m.
    motion = Motion.steady(0.0, 0.0, steps=STEPS, speed=8.0)
    route = np.array([(0.0, 0.0), (length, 0.0)])
    (verdict,) = judge(RouteDeviation(), on_lane(motion=motion, route=route, route_lateral=16.0))
    assert (verdict.outcome is Outcome.VIOLATED) == violated


def test_an_unknown_distance_from_the_route_cannot_be_judged() -> None:
    motion = Motion.steady(0.0, 0.0, steps=STEPS, speed=8.0)
    verdicts = judge(RouteDeviation(), on_lane(motion=motion, route_lateral=np.nan))
    assert outcomes(verdicts) == [Outcome.NOT_MEASURABLE]
