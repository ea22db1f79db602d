from __future__ import annotations

import numpy as np
import pytest

from drivora_service.networks.drivable_area import outside_distance
from drivora_service.observations.motion import filter_motion
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.testing.networks import EAST, EAST_LEFT, straight_road
from drivora_service.testing.traces import Motion, SyntheticEgo, make_trace

ROAD = straight_road()
STEPS = 100


def view(ego: SyntheticEgo) -> EgoView:
    return RunView(make_trace([ego]), ROAD).egos[0]


def test_an_egos_part_is_from_its_start_to_its_end() -> None:
    motion = Motion.steady(0.0, 0.0, steps=STEPS, speed=4.0)
    ego = view(SyntheticEgo(motion=motion, start_time=1.0, end_step=60))
    assert (ego.first, ego.count) == (20, 41)
    assert ego.times[0] == pytest.approx(1.0)
    assert ego.times[-1] == pytest.approx(3.0)
    assert ego.moved.sum() == pytest.approx(8.0)
    assert ego.moved[0] == 0.0


def test_an_ego_that_left_the_world_ends_there() -> None:
    trace = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=4.0))])
    trace.present[70:, 0] = False
    trace.states[70:, 0] = np.nan
    assert RunView(trace, ROAD).egos[0].count == 70


def test_speed_backwards_is_negative_forward_speed() -> None:
    ego = view(SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=STEPS, speed=-3.0, yaw=2.0)))
    assert ego.speed == pytest.approx(3.0)
    assert ego.forward_speed == pytest.approx(-3.0)


def test_the_quick_look_at_the_lanes_agrees_with_the_drivable_area() -> None:
    rng = np.random.default_rng(3)
    y = rng.uniform(-5.0, 12.0, 400)
    yaw = rng.uniform(-3.2, 3.2, 400)
    left = y > 1.75
    ego = view(
        SyntheticEgo(
            motion=Motion.along(np.linspace(-100.0, 100.0, 400), y, yaw=yaw),
            lane=np.where(np.abs(y) > 5.25, -1, np.where(left, EAST_LEFT, EAST)),
            lane_lateral=np.where(np.abs(y) > 5.25, np.nan, np.where(left, y - 3.5, y)),
            lane_heading=np.where(np.abs(y) > 5.25, np.nan, 0.0),
        )
    )
    exact = outside_distance(ROAD, ego.corners.reshape(-1, 2)).reshape(-1, 4).max(axis=1)
    assert (exact > 0.0).any()
    assert (exact == 0.0).any()
    np.testing.assert_allclose(ego.outside, exact, atol=1e-9)


@pytest.mark.parametrize("step_length", [0.02, 0.05, 0.1])
def test_the_filters_follow_a_steady_rise_at_every_step_length(step_length: float) -> None:
    count = round(6.0 / step_length)
    motion = Motion.steady(0.0, 0.0, steps=count, speed=5.0, yaw=0.4, step_length=step_length)
    time = step_length * np.arange(count)
    motion.states[:, 5] = 1.5 * time * np.cos(0.4)
    motion.states[:, 6] = 1.5 * time * np.sin(0.4)
    motion.states[:, 7] = 0.2 * time
    found = filter_motion(motion.states, step_length)
    assert found is not None
    np.testing.assert_allclose(found.longitudinal_jerk, 1.5, atol=1e-6)
    np.testing.assert_allclose(found.jerk, 1.5, atol=1e-6)
    np.testing.assert_allclose(found.yaw_acceleration, 0.2, atol=1e-6)
    np.testing.assert_allclose(found.lateral_acceleration, 0.0, atol=1e-9)


def test_jerk_is_of_the_whole_acceleration() -> None:
    motion = Motion.steady(0.0, 0.0, steps=100, speed=5.0)
    motion.states[:, 6] = 2.0 * 0.05 * np.arange(100)
    found = filter_motion(motion.states, 0.05)
    assert found is not None
    np.testing.assert_allclose(found.jerk, 2.0, atol=1e-6)
    np.testing.assert_allclose(found.longitudinal_jerk, 0.0, atol=1e-9)
