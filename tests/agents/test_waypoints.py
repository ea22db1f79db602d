"""How waypoints are followed, and how the way ahead is shown."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.agents.imitation.way_view import EGO_SIZE, PIECE_SIZE, PIECES, WayView
from drivora_service.agents.imitation.waypoints import INTERVAL, WAYPOINTS, drive_waypoints
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.agents.log import AgentLog
from drivora_service.geometry.array_shapes import Float32Array
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.trace import Light
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from tests.simulation.episodes import CAR, network, place

TIMES = INTERVAL * np.arange(1, WAYPOINTS + 1)
WHEELBASE, MAX_BRAKING = 2.85, 8.0


def pulled(speed: float, acceleration: float, curvature: float = 0.0) -> Float32Array:
    """Waypoints of a car whose rear axle is on a circle; it never goes backwards."""
    times = TIMES if acceleration >= 0.0 else np.minimum(TIMES, -speed / acceleration)
    way = speed * times + 0.5 * acceleration * times**2
    if curvature == 0.0:
        return np.column_stack((way, np.zeros(WAYPOINTS))).astype(np.float32)
    turn, half = curvature * way, 0.5 * WHEELBASE
    rear = np.column_stack((np.sin(turn), 1.0 - np.cos(turn))) / curvature - (half, 0.0)
    return (rear + half * np.column_stack((np.cos(turn), np.sin(turn)))).astype(np.float32)


def follow(waypoints: Float32Array, speed: float, last: float = 0.0) -> tuple[float, float]:
    return drive_waypoints(waypoints, speed, WHEELBASE, MAX_BRAKING, last)


@given(st.floats(4.0, 20.0), st.floats(-3.0, 2.0))
def test_a_constant_pull_is_given_back(speed: float, acceleration: float) -> None:
    found, steer = follow(pulled(speed, acceleration), speed)
    assert found == pytest.approx(acceleration, abs=0.01)
    assert steer == 0.0


@given(st.floats(3.0, 15.0), st.floats(0.005, 0.08), st.booleans())
def test_a_bend_is_steered_as_it_bends(speed: float, curvature: float, right: bool) -> None:
    # No car turns with more than half its weight.
    curvature = min(curvature, 5.0 / speed**2)
    bend = -curvature if right else curvature
    _, steer = follow(pulled(speed, 0.0, bend), speed)
    assert math.tan(steer) / WHEELBASE == pytest.approx(bend, rel=0.1)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 15.0))
def test_what_is_mirrored_is_steered_the_other_way(seed: int, speed: float) -> None:
    points = np.random.default_rng(seed).normal((3.0, 0.0), 2.0, (WAYPOINTS, 2)).cumsum(axis=0)
    ahead, mirrored = points.astype(np.float32), (points * (1.0, -1.0)).astype(np.float32)
    one, other = follow(ahead, speed), follow(mirrored, speed)
    assert one[0] == pytest.approx(other[0], abs=1e-5)
    assert one[1] == pytest.approx(-other[1], abs=1e-5)
    assert -MAX_BRAKING <= one[0] <= 3.0


def test_who_stands_and_is_to_stand_keeps_the_wheels_as_they_are() -> None:
    noise = np.array([[0.01, 0.02], [-0.01, 0.0], [0.02, -0.05], [0.0, 0.03]], dtype=np.float32)
    acceleration, steer = follow(noise, 0.0, last=0.2)
    assert acceleration < -1.0
    assert steer == 0.2


def seen(
    start: tuple[str, float], end: tuple[str, float], **more: object
) -> tuple[Float32Array, Float32Array]:
    """What is shown of itself and of its way to who stands at the start."""
    points = [place(*start), place(*end)]
    route = plan_route(network(), [RoutePoint(x=p.x, y=p.y, yaw=p.yaw) for p in points])
    context = AgentContext(
        ego_id="ego", model=actor_model(ActorKind.VEHICLE, CAR), network=network(), route=route,
        step_length=0.05, friction=1.0, seed=1, parameters={}, log=AgentLog(),
    )  # fmt: skip
    ego = np.zeros(9)
    ego[:3] = points[0].x, points[0].y, points[0].yaw
    observation = Observation(
        ego=ego, objects=np.empty((0, 9)), object_sizes=np.empty((0, 2)),
        object_kinds=np.empty(0, dtype=np.int64), object_ids=np.empty(0, dtype=np.int64),
        **more,  # type: ignore[arg-type]  # each test names fields and their values
    )  # fmt: skip
    view = WayView(context)
    own, pieces = np.zeros(EGO_SIZE, np.float32), np.zeros((PIECES, PIECE_SIZE), np.float32)
    view.follow(observation)
    view.show(observation, own, pieces)
    return own, pieces


def test_a_straight_way_lies_ahead() -> None:
    own, pieces = seen(("harbour_0_0", 20.0), ("harbour_0_0", 140.0), speed=7.5, speed_limit=15.0)
    assert own[:2] == pytest.approx([0.5, 1.0])
    assert own[2:6].tolist() == [0.0, 0.0, 0.0, 0.0]
    assert own[6:] == pytest.approx([2.0, 2.0, 0.0, 0.0], abs=0.02)
    assert (np.diff(pieces[:, 0]) > 0.0).all()
    assert pieces[0, 0] == pytest.approx(2.0 / 40.0, abs=0.01)
    assert pieces[-1, 0] == pytest.approx(60.0 / 40.0, abs=0.02)
    assert np.abs(pieces[:, 1]).max() < 0.02
    assert pieces[:, 2] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(
    ("light", "protected", "shown"),
    [
        (Light.RED, False, [1, 0, 0, 0]),
        (Light.YELLOW, False, [0, 1, 0, 0]),
        (Light.GREEN, False, [0, 0, 1, 0]),
        (Light.GREEN, True, [0, 0, 1, 1]),
    ],
)
def test_the_light_is_shown(light: Light, protected: bool, shown: list[int]) -> None:
    own, _ = seen(
        ("harbour_0_0", 20.0), ("harbour_0_0", 140.0), light=light, light_protected=protected,
        light_distance=20.0,
    )  # fmt: skip
    assert own[2:6].tolist() == shown
    assert own[6] == pytest.approx(0.5)
