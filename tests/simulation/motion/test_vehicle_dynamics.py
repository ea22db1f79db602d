"""How controlled vehicles move: limits, friction, both bicycle models."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivora_service.observations.ground import NO_PATCHES
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel
from drivora_service.simulation.motion.vehicle_dynamics import (
    GRAVITY,
    Body,
    CommandMode,
    drive_vehicles,
)
from drivora_service.simulation.plans.plan_arrays import vehicle_limits

DT = 0.05
CAR = ActorModel(
    name="car",
    kind=ActorKind.VEHICLE,
    length=4.9,
    width=1.9,
    height=1.5,
    wheelbase=2.85,
    mass=1700.0,
    max_acceleration=3.5,
    max_deceleration=8.0,
    max_steer=0.6,
    max_speed=50.0,
)


def drive(
    steps: int,
    command: tuple[float, ...],
    *,
    speed: float = 0.0,
    friction: float = 1.0,
    dynamic: bool = False,
    mode: CommandMode = CommandMode.DRIVE,
    dt: float = DT,
    wind: tuple[float, float] = (0.0, 0.0),
    patches: np.ndarray = NO_PATCHES,
) -> np.ndarray:
    """Returns the (steps + 1, 10) bodies of one car under a constant command."""
    bodies = np.zeros((1, len(Body)))
    bodies[0, Body.SPEED] = speed
    limits = vehicle_limits([CAR], [dynamic])
    commands = np.zeros((1, 4))
    commands[0, : len(command)] = command
    seen = [bodies[0].copy()]
    for _ in range(steps):
        drive_vehicles(
            bodies, limits, np.array([int(mode)]), commands, friction, patches, np.array(wind), dt
        )
        seen.append(bodies[0].copy())
    return np.array(seen)


@pytest.mark.parametrize("dynamic", [False, True])
@pytest.mark.parametrize("friction", [1.0, 0.6, 0.4])
def test_braking_distance_follows_friction(friction: float, dynamic: bool) -> None:
    track = drive(300, (-20.0, 0.0), speed=20.0, friction=friction, dynamic=dynamic)
    braking = min(CAR.max_deceleration, friction * GRAVITY)
    assert track[-1, Body.SPEED] == 0.0
    assert track[-1, Body.X] == pytest.approx(20.0**2 / (2.0 * braking), rel=0.03)


@pytest.mark.parametrize("dynamic", [False, True])
def test_gentle_circle_has_the_radius_of_the_wheel_angle(dynamic: bool) -> None:
    steer = 0.05
    track = drive(1500, (0.0, steer), speed=8.0, dynamic=dynamic)
    radius = CAR.wheelbase / math.tan(steer)
    span = track[200:, Body.Y].max() - track[200:, Body.Y].min()
    assert span == pytest.approx(2.0 * radius, rel=0.06)


def test_a_bend_taken_too_fast_is_left_on_a_wider_arc() -> None:
    dry = drive(60, (0.0, 0.2), speed=20.0)
    wet = drive(60, (0.0, 0.2), speed=20.0, friction=0.4)
    assert abs(wet[-1, Body.YAW]) < 0.6 * abs(dry[-1, Body.YAW])
    lateral = wet[1:, Body.SPEED] * np.abs(wet[1:, Body.YAW_RATE])
    assert lateral.max() <= 0.4 * GRAVITY * 1.01


def test_the_dynamic_model_skids_and_the_kinematic_does_not() -> None:
    skid = drive(40, (0.0, 0.5), speed=25.0, friction=0.5, dynamic=True)
    assert np.abs(skid[:, Body.SIDE_SPEED]).max() > 1.0


@pytest.mark.parametrize("dynamic", [False, True])
def test_a_standing_vehicle_does_not_roll_back_under_braking(dynamic: bool) -> None:
    track = drive(20, (-8.0, 0.3), dynamic=dynamic)
    assert np.array_equal(track[-1, :3], track[0, :3])


def test_a_far_pose_is_reached_only_as_far_as_the_limits_allow() -> None:
    track = drive(20, (1000.0, 0.0, 0.0, math.nan), mode=CommandMode.POSE)
    rise = np.diff(track[:, Body.SPEED])
    assert rise.max() <= CAR.max_acceleration * DT + 1e-9
    assert track[-1, Body.X] < CAR.max_acceleration * (20 * DT) ** 2


def test_holding_keeps_the_pose() -> None:
    track = drive(5, (3.0, 0.5), speed=4.0, mode=CommandMode.HOLD)
    assert np.array_equal(track[1:, :3], np.repeat(track[:1, :3], 5, axis=0))


@settings(max_examples=60, deadline=None)
@given(
    acceleration=st.floats(-30, 30),
    steer=st.floats(-3, 3),
    speed=st.floats(0, 45),
    friction=st.floats(0.3, 1.0),
    dynamic=st.booleans(),
)
def test_motion_stays_finite_forward_and_within_grip(
    acceleration: float, steer: float, speed: float, friction: float, dynamic: bool
) -> None:
    track = drive(40, (acceleration, steer), speed=speed, friction=friction, dynamic=dynamic)
    assert np.isfinite(track).all()
    assert (track[:, Body.SPEED] >= 0.0).all()
    pace = np.hypot(track[:, Body.SPEED], track[:, Body.SIDE_SPEED])
    change = np.abs(np.diff(pace)) / DT
    slip = np.abs(track[1:, Body.SIDE_SPEED] * track[1:, Body.YAW_RATE])
    front = friction * GRAVITY
    assert (change <= 2.0 * front + slip + 1e-6).all()
    if not dynamic:
        assert (change <= front + 1e-6).all()
