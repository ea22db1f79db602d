"""Speeding, blocked, deadlock, destination, discomfort: how an ego gets on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.observations.trace import Light, TerminalEvent
from drivora_service.oracles.blocked import Blocked
from drivora_service.oracles.deadlock import Deadlock
from drivora_service.oracles.destination import Destination
from drivora_service.oracles.discomfort import Discomfort
from drivora_service.oracles.speeding import Speeding
from drivora_service.oracles.verdict import Outcome
from drivora_service.testing.traces import Motion, SyntheticEgo
from tests.oracles.judging import judge, on_lane, outcomes


def at_speeds(speeds: np.ndarray, **fields: object) -> SyntheticEgo:
    x = np.concatenate(([0.0], np.cumsum(speeds[:-1] * 0.05)))
    motion = Motion.along(x, 0.0)
    motion.states[:, 3] = speeds
    return on_lane(motion=motion, **fields)


@pytest.mark.parametrize(
    ("speed", "seconds", "outcome"),
    [
        (10.4, 10.0, Outcome.PASSED),
        (10.6, 10.0, Outcome.VIOLATED),
        (15.0, 2.9, Outcome.PASSED),
        (15.0, 3.0, Outcome.VIOLATED),
    ],
)
def test_five_per_cent_over_the_limit_for_three_seconds(
    speed: float, seconds: float, outcome: Outcome
) -> None:
    rows = round(seconds / 0.05) + 1
    speeds = np.full(400, 8.0)
    speeds[50 : 50 + rows] = speed
    (verdict,) = judge(Speeding(), at_speeds(speeds))
    assert verdict.outcome is outcome
    integral = (speed - 10.0) * rows * 0.05
    assert verdict.evidence["total_excess_integral"] == pytest.approx(integral)
    if outcome is Outcome.VIOLATED:
        assert verdict.step == 50
        assert verdict.evidence["duration"] == pytest.approx(seconds)


def test_the_limit_may_change_on_the_way() -> None:
    limit = np.where(np.arange(400) < 200, 20.0, 10.0)
    (verdict,) = judge(Speeding(), at_speeds(np.full(400, 15.0), speed_limit=limit))
    assert verdict.step == 200


def test_speed_without_limits_cannot_be_judged() -> None:
    verdicts = judge(Speeding(), at_speeds(np.full(100, 15.0), speed_limit=np.nan))
    assert outcomes(verdicts) == [Outcome.NOT_MEASURABLE]


def standing(seconds: float, **fields: object) -> SyntheticEgo:
    speeds = np.concatenate((np.full(40, 5.0), np.zeros(round(seconds / 0.05)), np.full(40, 5.0)))
    return at_speeds(speeds, **fields)


@pytest.mark.parametrize(("seconds", "outcome"), [(59.9, Outcome.PASSED), (60.0, Outcome.VIOLATED)])
def test_a_minute_of_standstill_is_a_block(seconds: float, outcome: Outcome) -> None:
    (verdict,) = judge(Blocked(), standing(seconds))
    assert verdict.outcome is outcome
    assert verdict.evidence["duration"] == pytest.approx(seconds)
    if outcome is Outcome.VIOLATED:
        assert verdict.step == 40 + 1199
        assert verdict.evidence["since"] == pytest.approx(2.0)


@pytest.mark.parametrize("light", [Light.RED, Light.YELLOW])
@pytest.mark.parametrize("distance", [1.0, 60.0])
def test_waiting_for_a_signal_is_no_block(light: Light, distance: float) -> None:
    ego = standing(90.0, light=light, light_distance=distance)
    assert outcomes(judge(Blocked(), ego)) == [Outcome.PASSED]


@pytest.mark.parametrize(
    ("light", "distance"), [(Light.GREEN, 1.0), (Light.RED, 150.0), (Light.NONE, np.nan)]
)
def test_standing_for_another_reason_is(light: Light, distance: float) -> None:
    ego = standing(90.0, light=light, light_distance=distance)
    assert outcomes(judge(Blocked(), ego)) == [Outcome.VIOLATED]


def test_red_pauses_the_clock_and_motion_resets_it() -> None:
    k = np.arange(4000)
    # 20 s of red in every 40 s: 200 s of standstill are 100 s without a reason.
    light = np.where(k // 400 % 2 == 0, Light.RED, Light.GREEN)
    verdicts = judge(Blocked(), at_speeds(np.zeros(4000), light=light, light_distance=5.0))
    assert outcomes(verdicts) == [Outcome.VIOLATED]
    assert verdicts[0].evidence["duration"] == pytest.approx(100.0)
    moving = np.where(k % 1000 < 10, 1.0, 0.0)
    assert outcomes(judge(Blocked(), at_speeds(moving))) == [Outcome.PASSED]


def test_time_before_the_start_is_no_block() -> None:
    ego = standing(70.0, start_time=30.0)
    (verdict,) = judge(Blocked(), ego)
    assert verdict.outcome is Outcome.PASSED
    assert verdict.evidence["duration"] == pytest.approx(42.0)


def test_a_run_too_short_to_tell() -> None:
    ego = at_speeds(np.where(np.arange(600) < 100, 5.0, 0.0), end=TerminalEvent.TIME_LIMIT)
    assert outcomes(judge(Blocked(), ego)) == [Outcome.NOT_MEASURABLE]
    moving = at_speeds(np.full(600, 5.0), end=TerminalEvent.TIME_LIMIT)
    assert outcomes(judge(Blocked(), moving)) == [Outcome.PASSED]


def ring(places: list[tuple[float, float, float]], seconds: float = 12.0) -> list[SyntheticEgo]:
    steps = round(seconds / 0.05)
    return [
        on_lane(id=f"ego{i}", motion=Motion.steady(x, y, steps=steps, yaw=yaw))
        for i, (x, y, yaw) in enumerate(places)
    ]


FACING = [(0.0, 0.0, 0.0), (8.0, 0.0, math.pi)]
ROUND = [
    (-6.0, 0.0, 0.0),
    (0.0, -6.0, math.pi / 2),
    (6.0, 0.0, math.pi),
    (0.0, 6.0, -math.pi / 2),
]


@pytest.mark.parametrize("places", [FACING, ROUND])
def test_egos_that_wait_for_one_another(places: list[tuple[float, float, float]]) -> None:
    verdicts = judge(Deadlock(), *ring(places))
    assert outcomes(verdicts) == [Outcome.VIOLATED] * len(places)
    assert {verdict.counterpart for verdict in verdicts} <= {f"ego{i}" for i in range(4)}
    assert verdicts[0].step == 199
    for verdict in verdicts:
        assert verdict.ego in verdict.evidence["cycle"]
        assert verdict.counterpart != verdict.ego


def test_a_queue_is_no_deadlock() -> None:
    queue = ring([(0.0, 0.0, 0.0), (8.0, 0.0, 0.0), (16.0, 0.0, 0.0)])
    assert outcomes(judge(Deadlock(), *queue)) == [Outcome.PASSED] * 3


def test_who_waits_behind_a_deadlock_is_not_in_it() -> None:
    verdicts = judge(Deadlock(), *ring([*FACING, (-8.0, 0.0, 0.0)]))
    assert outcomes(verdicts) == [Outcome.VIOLATED, Outcome.VIOLATED, Outcome.PASSED]


def test_a_short_wait_is_no_deadlock() -> None:
    assert outcomes(judge(Deadlock(), *ring(FACING, 9.0))) == [Outcome.PASSED] * 2


def test_a_single_ego_has_no_other_to_wait_for() -> None:
    assert outcomes(judge(Deadlock(), *ring(FACING[:1]))) == [Outcome.NOT_APPLICABLE]


def test_egos_far_apart_do_not_wait_for_one_another() -> None:
    assert (
        outcomes(judge(Deadlock(), *ring([(0.0, 0.0, 0.0), (40.0, 0.0, math.pi)])))
        == [Outcome.PASSED] * 2
    )


def trip(length: float, speed: float, steps: int, **fields: object) -> SyntheticEgo:
    motion = Motion.steady(0.0, 0.0, steps=steps, speed=speed)
    return on_lane(motion=motion, route=np.array([(0.0, 0.0), (length, 0.0)]), **fields)


def test_arriving_in_time() -> None:
    (verdict,) = judge(Destination(), trip(50.0, 10.0, 120, end=TerminalEvent.ARRIVED))
    assert verdict.outcome is Outcome.PASSED
    assert verdict.evidence["time"] == pytest.approx(5.0, abs=0.06)
    assert verdict.evidence["time_limit"] == pytest.approx(45.0)


@pytest.mark.parametrize(("share", "outcome"), [(0.985, "violated"), (0.995, "passed")])
def test_arrival_takes_ninety_nine_per_cent_of_the_route(share: float, outcome: str) -> None:
    x = np.minimum(0.5 * np.arange(400), 100.0 * share)
    ego = on_lane(motion=Motion.along(x, 0.0), route=np.array([(0.0, 0.0), (100.0, 0.0)]))
    assert judge(Destination(), ego)[0].outcome == outcome


@pytest.mark.parametrize(("off", "outcome"), [(9.9, "passed"), (10.1, "violated")])
def test_arrival_takes_less_than_ten_metres_to_the_goal(off: float, outcome: str) -> None:
    ego = on_lane(
        motion=Motion.along(0.5 * np.arange(201), off, yaw=0.0),
        route=np.array([(0.0, 0.0), (100.0, 0.0)]),
    )
    assert judge(Destination(), ego)[0].outcome == outcome


def test_running_out_of_time() -> None:
    ego = trip(50.0, 0.5, 920)
    (verdict,) = judge(Destination(), ego)
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.evidence["reason"] == "timeout"
    assert verdict.time == pytest.approx(45.0)


def test_the_limit_is_at_most_the_runs_and_counts_from_the_start() -> None:
    ego = trip(100.0, 3.0, 800, start_time=10.0)
    (verdict,) = judge(Destination(), ego, max_sim_time=40.0)
    assert verdict.evidence["time_limit"] == pytest.approx(30.0)


def test_arriving_late() -> None:
    (verdict,) = judge(Destination(), trip(50.0, 1.0, 1100, end=TerminalEvent.ARRIVED))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.evidence["reason"] == "late"


def test_ending_by_a_collision_is_not_arriving() -> None:
    ego = trip(50.0, 5.0, 400, end=TerminalEvent.COLLISION, end_step=60)
    (verdict,) = judge(Destination(), ego)
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.step == 60
    assert verdict.evidence["reason"] == "collision"
    assert verdict.evidence["goal_distance"] == pytest.approx(35.0)


def accelerating(peak: float, *, lateral: bool = False) -> SyntheticEgo:
    """A gentle swell of acceleration, 20 s long, that is filtered to nearly itself."""
    motion = Motion.steady(0.0, 0.0, steps=400, speed=8.0)
    swell = peak * 0.5 * (1.0 - np.cos(np.linspace(0.0, 2.0 * np.pi, 400)))
    motion.states[:, 6 if lateral else 5] = swell
    return on_lane(motion=motion)


@pytest.mark.parametrize(
    ("peak", "lateral", "broken"),
    [
        (2.35, False, []),
        (2.45, False, ["longitudinal acceleration"]),
        (-4.0, False, []),
        (-4.1, False, ["longitudinal acceleration"]),
        (4.85, True, []),
        (4.95, True, ["lateral acceleration"]),
        (-4.95, True, ["lateral acceleration"]),
    ],
)
def test_bounds_of_acceleration(peak: float, lateral: bool, broken: list[str]) -> None:
    (verdict,) = judge(Discomfort(), accelerating(peak, lateral=lateral))
    assert verdict.evidence.get("bounds", []) == broken
    assert (verdict.outcome is Outcome.VIOLATED) == bool(broken)


@pytest.mark.parametrize(
    ("rate", "broken"), [(4.0, []), (4.3, ["longitudinal jerk"]), (-4.3, ["longitudinal jerk"])]
)
def test_bounds_of_jerk(rate: float, broken: list[str]) -> None:
    # A ramp of acceleration from one bound to the other in less than a second and a half.
    motion = Motion.steady(0.0, 0.0, steps=200, speed=8.0)
    low, high = (-3.9, 2.2) if rate > 0 else (2.2, -3.9)
    time = 0.05 * (np.arange(200) - 60)
    ramp = low + rate * np.clip(time, 0.0, (high - low) / rate)
    motion.states[:, 5] = ramp
    (verdict,) = judge(Discomfort(), on_lane(motion=motion))
    assert verdict.evidence.get("bounds", []) == broken


@pytest.mark.parametrize(
    ("rate", "acceleration", "broken"),
    [
        (0.9, 0.0, []),
        (1.0, 0.0, ["yaw rate"]),
        (0.0, 1.85, []),
        (0.0, 2.0, ["yaw acceleration"]),
    ],
)
def test_bounds_of_turning(rate: float, acceleration: float, broken: list[str]) -> None:
    # Yaw acceleration is what Bench2Drive's public code leaves undifferentiated.
    motion = Motion.steady(0.0, 0.0, steps=200, speed=0.0)
    time = 0.05 * (np.arange(200) - 100)
    motion.states[:, 7] = rate + acceleration * np.clip(time, -0.45, 0.45)
    (verdict,) = judge(Discomfort(), on_lane(motion=motion))
    assert verdict.evidence.get("bounds", []) == broken


@pytest.mark.parametrize(("rows", "outcome"), [(14, "not_measurable"), (15, "passed")])
def test_a_run_shorter_than_the_filters(rows: int, outcome: str) -> None:
    ego = on_lane(motion=Motion.steady(0.0, 0.0, steps=rows, speed=8.0))
    assert judge(Discomfort(), ego)[0].outcome == outcome
