"""NPC vehicles and walkers on their paths."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.geometry.lines import arc_lengths
from drivora_service.observations.ground import NO_PATCHES
from drivora_service.observations.trace import Role
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel
from drivora_service.simulation.followers.follower_path import build_path
from drivora_service.simulation.followers.followers import PATIENCE, advance_followers
from drivora_service.simulation.motion.vehicle_dynamics import GRAVITY
from drivora_service.simulation.plans.episode_plan import FollowerPlan
from drivora_service.simulation.plans.plan_arrays import lay_followers

DT = 0.05
CAR = ActorModel(
    name="car", kind=ActorKind.VEHICLE, length=4.5, width=1.8, height=1.5, wheelbase=2.7,
    mass=1500.0, max_acceleration=3.0, max_deceleration=8.0, max_steer=0.6, max_speed=50.0,
)  # fmt: skip


def plan(
    points: list[tuple[float, float]],
    speeds: list[float],
    *,
    reacts: bool = False,
    stays: bool = False,
    start_time: float = 0.0,
    friction: float = 1.0,
) -> FollowerPlan:
    line = np.array(points)
    path = build_path(
        line, np.array(speeds), arc_lengths(line), 0.0, friction, 3.2, is_vehicle=True
    )
    return FollowerPlan(
        id="npc", role=Role.NPC_VEHICLE, model=CAR, path=path, edges=("e",), on_lanes=True,
        first_speed=speeds[0], start_time=start_time, reacts=reacts, stays=stays, is_fixed=False,
    )  # fmt: skip


def follow(
    plans: list[FollowerPlan],
    steps: int,
    others: list[tuple[float, float]] | None = None,
    friction: float = 1.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Returns states (steps + 1, n, 9) and presence of followers; ``others`` stand still."""
    others = others or []
    n = len(plans) + len(others)
    f = lay_followers(plans, list(range(len(plans))))
    sizes = np.full((n, 2), (4.5, 1.8))
    states, present = np.full((steps + 1, n, 9), np.nan), np.zeros((steps + 1, n), np.bool_)
    for k in range(steps + 1):
        for i, (x, y) in enumerate(others):
            states[k, len(plans) + i] = (x, y, 0, 0, 0, 0, 0, 0, 0)
            present[k, len(plans) + i] = True
        before = max(k - 1, 0)
        advance_followers(
            (k - 1) * DT, DT, friction, NO_PATCHES, f, states[before], sizes, present[before],
            states[k], present[k],
        )  # fmt: skip
    return states, present


def test_replay_passes_its_waypoints_and_leaves() -> None:
    states, present = follow([plan([(0, 0), (20, 0), (20, 20)], [5, 5, 5])], 200)
    track = states[present[:, 0], 0, :2]
    for point in ((0, 0), (20, 0), (20, 20)):
        assert np.hypot(*(track - point).T).min() < 0.6
    assert not present[-1, 0]


def test_waits_for_its_start_time() -> None:
    _, present = follow([plan([(0, 0), (50, 0)], [5, 5], start_time=2.0)], 60)
    assert int(np.argmax(present[:, 0])) == 40


def test_speeds_up_to_the_waypoint_ahead_within_its_limits() -> None:
    states, _ = follow([plan([(0, 0), (200, 0)], [0, 10])], 150)
    speed = np.hypot(states[:, 0, 3], states[:, 0, 4])
    assert speed[0] == 0.0
    assert speed[-1] == pytest.approx(10.0, abs=0.01)
    assert np.diff(speed).max() <= CAR.max_acceleration * DT + 1e-9


def test_reactive_stops_behind_an_obstacle_and_replay_does_not() -> None:
    reactive, _ = follow([plan([(0, 0), (200, 0)], [12, 12], reacts=True)], 400, [(80, 0)])
    replay, _ = follow([plan([(0, 0), (200, 0)], [12, 12])], 200, [(80, 0)])
    assert 80 - 4.5 - 5.0 < reactive[-1, 0, 0] < 80 - 4.5
    assert np.nanmax(replay[:, 0, 0]) > 100


def test_reactive_ignores_who_stands_beside_its_way() -> None:
    states, _ = follow([plan([(0, 0), (200, 0)], [12, 12], reacts=True)], 200, [(80, 3.6)])
    assert np.nanmax(states[:, 0, 0]) > 100


def test_of_reactive_vehicles_that_wait_for_each_other_one_leaves_and_the_rest_go_on() -> None:
    # The first two come to the crossing together, and the third queues behind the second.
    plans = [
        plan([(0, 0), (100, 0)], [6, 6], reacts=True),
        plan([(50, -50), (50, 50)], [6, 6], reacts=True),
        plan([(50, -62), (50, 50)], [6, 6], reacts=True),
    ]
    states, present = follow(plans, 800)
    standing = np.hypot(states[:, :, 3], states[:, :, 4]) < 0.01
    both = np.flatnonzero(standing[:, 0] & standing[:, 1])
    assert both.size
    left = np.flatnonzero(~present[:, 1])[0]
    assert (left - both[0]) * DT == pytest.approx(PATIENCE, abs=1.0)
    assert states[left - 1, 1, 1] < 0
    assert np.nanmax(states[:, 0, 0]) == pytest.approx(100, abs=0.5)
    assert np.nanmax(states[:, 2, 1]) == pytest.approx(50, abs=0.5)


def test_who_waits_for_one_that_does_not_wait_stays() -> None:
    plans = [
        plan([(0, 0), (200, 0)], [12, 12], reacts=True),
        plan([(-15, 0), (200, 0)], [12, 12], reacts=True),
    ]
    states, present = follow(plans, 1200, [(80, 0)])
    assert present.all()
    assert np.hypot(states[-1, :2, 3], states[-1, :2, 4]).max() < 0.01


def test_slippery_roads_slow_bends_and_lengthen_braking() -> None:
    bend = [(0.0, 0.0), (40.0, 0.0)] + [
        (40 + 10 * np.sin(a), 10 - 10 * np.cos(a)) for a in np.linspace(0, np.pi / 2, 12)[1:]
    ]
    dry, dry_present = follow([plan(bend, [15] * len(bend))], 200)
    wet, wet_present = follow([plan(bend, [15] * len(bend), friction=0.4)], 200, friction=0.4)
    slowest = [
        np.hypot(s[p[:, 0], 0, 3], s[p[:, 0], 0, 4]).min()
        for s, p in ((dry, dry_present), (wet, wet_present))
    ]
    assert slowest[1] < 0.75 * slowest[0]
    speed = np.hypot(wet[wet_present[:, 0], 0, 3], wet[wet_present[:, 0], 0, 4])
    assert np.abs(np.diff(speed)).max() <= 0.4 * GRAVITY * DT + 1e-6


def test_a_single_waypoint_is_a_parked_vehicle() -> None:
    states, present = follow([plan([(3, 4)], [5], stays=True)], 10)
    assert present[:, 0].all()
    assert np.array_equal(states[-1, 0, :5], [3, 4, 0, 0, 0])
