"""DriveFuzz's feedback: frames of hard manoeuvres, over- and understeer, and closeness."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.interface import AccelerationControl
from drivora_service.feedback.drivefuzz import QUALITY, TERMS, DrivefuzzFeedback
from drivora_service.feedback.driving_frames import driving_frames, wheel_angles
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.trace import EgoCol, Trace
from drivora_service.scenario.model import FrictionPatch, VehicleDynamics
from drivora_service.testing.networks import straight_road
from drivora_service.testing.traces import Motion, SyntheticActor, SyntheticEgo, make_trace
from tests.simulation.episodes import ROAD, Scripted, ego, network, place, run, scenario

STEPS = (0.02, 0.05, 0.1, 0.2)
G = 9.81


def terms(trace: Trace, **parameters: Any) -> dict[str, float]:
    measured = DrivefuzzFeedback(**parameters).measure(RunView(trace, straight_road()))
    (row,) = measured.features[TERMS]
    assert measured.objectives[QUALITY] == pytest.approx(-sum(row))
    names = ("accelerated", "braked", "turned", "oversteered", "understeered", "close")
    return dict(zip(names, row, strict=True))


def driven(speed: FloatArray, heading: FloatArray, dt: float) -> Trace:
    """A run of an ego with a speed (m/s) and heading (radians) each hundredth of a second."""
    every = round(dt / 0.01)
    x = np.concatenate(([0.0], np.cumsum(speed[:-1] * np.cos(heading[:-1]) * 0.01)))
    y = np.concatenate(([0.0], np.cumsum(speed[:-1] * np.sin(heading[:-1]) * 0.01)))
    motion = Motion.along(x[::every], y[::every], step_length=dt, yaw=heading[::every])
    motion.states[:, 3] = (speed * np.cos(heading))[::every]
    motion.states[:, 4] = (speed * np.sin(heading))[::every]
    return make_trace([SyntheticEgo(motion=motion)], step_length=dt)


def speeds(*pieces: tuple[float, float]) -> FloatArray:
    """Speed each hundredth of a second: pieces of (seconds, m/s²), from 20 m/s on."""
    changes = np.concatenate([np.full(round(s * 100), a) for s, a in pieces])
    return 20.0 + 0.01 * np.concatenate(([0.0], np.cumsum(changes)))


@pytest.mark.parametrize("dt", STEPS)
def test_hard_frames_are_the_time_over_a_twentieth_of_a_second_at_every_step_length(
    dt: float,
) -> None:
    speed = speeds((2.0, 0.0), (1.0, 7.0), (1.0, 3.0), (2.0, -8.0), (1.0, -5.0), (2.0, 0.0))
    found = terms(driven(speed, np.zeros(len(speed)), dt))
    # A second is 20 frames; at both ends of it the window holds a part of what is not hard.
    assert found["accelerated"] == pytest.approx(20, abs=5)
    assert found["braked"] == pytest.approx(40, abs=5)
    assert found["turned"] == found["oversteered"] == found["understeered"] == 0.0


@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_hard_turns_are_those_across_the_heading(dt: float, side: float) -> None:
    speed = np.full(801, 15.0)
    rate = np.zeros(801)
    rate[200:500] = side * 6.0 / 15.0
    rate[500:800] = side * 3.0 / 15.0
    heading = np.concatenate(([0.0], np.cumsum(rate[:-1] * 0.01)))
    found = terms(driven(speed, heading, dt))
    assert found["turned"] == pytest.approx(60, abs=5)
    assert found["braked"] == found["accelerated"] == 0.0


def test_the_threshold_of_hard_changes_is_the_papers() -> None:
    for change, hard in ((21.1, False), (21.3, True)):
        speed = speeds((1.0, change / 3.6), (1.0, 0.0), (1.0, -change / 3.6))
        found = terms(driven(speed, np.zeros(len(speed)), 0.05))
        assert (found["accelerated"] > 0, found["braked"] > 0) == (hard, hard)


def test_a_stop_is_no_turn() -> None:
    speed = speeds((1.0, 0.0), (2.5, -8.0), (1.0, 0.0))
    found = terms(driven(speed, np.full(len(speed), 2.0), 0.05))
    assert found["turned"] == 0.0


def test_closeness_is_the_inverse_of_the_least_gap_and_bounded() -> None:
    def close(gap: float) -> float:
        one = SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=100, speed=0.0))
        other = SyntheticActor(motion=Motion.steady(4.5 + gap, 0.0, steps=100, speed=0.0))
        return terms(make_trace([one], [other]))["close"]

    assert close(4.0) == pytest.approx(0.25)
    assert close(0.5) == pytest.approx(2.0)
    assert close(0.01) == close(0.0) == 10.0
    alone = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=100, speed=9.0))])
    assert terms(alone)["close"] == 0.0


def test_several_egos_count_by_the_worst() -> None:
    def egos(*speeds_: FloatArray) -> Trace:
        made = []
        for number, speed in enumerate(speeds_):
            x = np.concatenate(([0.0], np.cumsum(speed[:-1] * 0.01)))[::5]
            motion = Motion.along(x, 100.0 * number)
            motion.states[:, 3] = speed[::5]
            made.append(SyntheticEgo(id=f"ego_{number}", motion=motion))
        return make_trace(made)

    calm, hard = speeds((3.0, 0.0)), speeds((2.0, -8.0), (1.0, 0.0))
    both = terms(egos(calm, hard))
    assert both["braked"] == terms(egos(hard))["braked"] > 30


def view_of(trace: Trace) -> EgoView:
    return RunView(trace, network()).egos[0]


def skid(
    dynamics: VehicleDynamics, *patches: FrictionPatch, steer: float = 0.06, speed: float = 14.0,
    dt: float = 0.05,
) -> Trace:  # fmt: skip
    what = scenario(
        ego(place(ROAD, 8), place(ROAD, 120), initial_speed=speed, dynamics=dynamics),
        friction_patches=patches, seconds=3.0, step_length=dt,
    )  # fmt: skip
    return run(what, Scripted(lambda o: AccelerationControl(0.0, steer if o.time > 0.5 else 0.0)))


def ice(at: float, length: float, friction: float = 0.1) -> FrictionPatch:
    return FrictionPatch(
        id="ice", location=place(ROAD, at), length=length, width=60.0, friction=friction
    )


@pytest.mark.parametrize("dynamics", list(VehicleDynamics))
@pytest.mark.parametrize("dt", [0.02, 0.05, 0.1])
def test_wheels_that_turn_on_ice_and_a_vehicle_that_does_not_are_understeer(
    dynamics: VehicleDynamics, dt: float
) -> None:
    dry = terms(skid(dynamics, dt=dt))
    assert dry["understeered"] <= 4
    assert dry["oversteered"] == 0.0
    icy = terms(skid(dynamics, ice(60.0, 200.0), dt=dt))
    # From half a second on, when the wheels turn, to the end.
    assert icy["understeered"] > 35
    assert icy["oversteered"] == 0.0


def test_a_front_axle_that_leaves_ice_before_the_rear_one_is_oversteer() -> None:
    found = terms(skid(VehicleDynamics.DYNAMIC, ice(30.0, 30.0, 0.03), steer=0.05))
    assert found["oversteered"] >= 2
    assert terms(skid(VehicleDynamics.DYNAMIC, steer=0.05))["oversteered"] == 0.0


def test_turning_against_the_wheels_is_oversteer() -> None:
    turns = np.full(401, 0.3)
    trace = driven(np.full(401, 10.0), np.cumsum(turns * 0.01), 0.05)
    # The actor's model is unknown: its wheelbase is a share of its length.
    neutral = math.atan(0.3 * 0.6 * trace.actors[0].length / 10.0)
    for wheels, over in ((-0.02, 77.0), (0.0, 77.0), (neutral, 0.0)):
        with_wheels = replace(trace, ego_values=trace.ego_values.copy())
        with_wheels.ego_values[:, 0, EgoCol.STEER] = wheels
        assert terms(with_wheels)["oversteered"] == pytest.approx(over, abs=5)


def test_neutral_steering_is_neither() -> None:
    """Below the limit a vehicle turns as its wheels say, at every speed."""
    for dynamics in VehicleDynamics:
        trace = skid(dynamics, steer=0.02, speed=12.0)
        frames = driving_frames(view_of(trace))
        late = frames.neutral[-20:]
        assert frames.yaw_rate[-20:] == pytest.approx(late, rel=0.06)
        closed_form = 12.0 * math.tan(0.02) / 2.85
        assert late == pytest.approx(closed_form, rel=0.02)


def test_wheels_follow_the_command_at_their_rate() -> None:
    ego_view = view_of(skid(VehicleDynamics.KINEMATIC, steer=0.3))
    wheels = wheel_angles(ego_view)
    late = np.flatnonzero(wheels > 0.0)[0]
    assert ego_view.times[late] == pytest.approx(0.6, abs=0.051)
    assert np.diff(wheels).max() == pytest.approx(0.7 * 0.05)
    assert wheels[-1] == pytest.approx(0.3)


def test_where_no_wheel_angle_is_recorded_the_steering_is_neutral() -> None:
    rate = np.full(401, 0.3)
    trace = driven(np.full(401, 10.0), np.cumsum(rate * 0.01), 0.05)
    trace.ego_values[:, 0, EgoCol.STEER] = np.nan
    found = terms(trace)
    assert found["oversteered"] == found["understeered"] == 0.0


def test_a_drive_shorter_than_a_window_has_no_frames() -> None:
    trace = make_trace([SyntheticEgo(motion=Motion.steady(0.0, 0.0, steps=3, speed=9.0))])
    assert sum(terms(trace).values()) == 0.0
