"""NPC vehicles that brake hard, change lanes quickly, stand for a time, and stay at their ends.

Measured at their positions, and at what SUMO says; never by the follower's own speeds and plans.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Answer, Outcome
from drivora_service.scenario.model import NpcVehicle, RouteEnd, Waypoint, Weather
from tests.simulation.episodes import (
    ROAD,
    Blind,
    Watching,
    car,
    contacts,
    ego,
    network,
    parked,
    place,
    presence,
    row_of,
    run,
    scenario,
    standing,
    track,
)

DT = 0.05
G = 9.81
DRY, WET = Weather(), Weather(wetness=100.0)
UNDER_WATER = Weather(wetness=100.0, precipitation_deposits=100.0)
GRIPS = ((DRY, 1.0), (WET, 0.7), (UNDER_WATER, 0.4))
MODEL_BRAKING = 8.5
"""m/s², of the test's car."""


def driven(*route: Waypoint, weather: Weather = DRY, seconds: float = 25.0, **more: Any) -> Trace:
    """The trace of one NPC vehicle, far from the ego."""
    npc = car(*route, **more)
    what = scenario(parked(), npc_vehicles=(npc,), weather=weather, seconds=seconds)
    return run(what, standing())


def positions(trace: Trace) -> NDArray[np.float64]:
    points = track(trace, "npc")
    return np.asarray(points[~np.isnan(points[:, 0])])


def speeds_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """m/s in each step, by displacement."""
    return np.asarray(np.hypot(*np.diff(points, axis=0).T) / DT)


def hardest_braking(points: NDArray[np.float64]) -> float:
    """m/s², over two steps: straight lines between the points of a path turn in between."""
    speed = speeds_of(points)
    return float((speed[:-2] - speed[2:]).max() / (2 * DT))


def standing_times(points: NDArray[np.float64]) -> list[float]:
    """Seconds of each stretch of frames without motion."""
    still = speeds_of(points) < 1e-6
    edges = np.flatnonzero(np.diff(still.astype(int), prepend=0, append=0))
    return [(end - begin) * DT for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def distance_to(points: NDArray[np.float64], waypoint: Waypoint) -> float:
    return float(np.hypot(points[-1, 0] - waypoint.x, points[-1, 1] - waypoint.y))


# --- braking ---


@pytest.mark.parametrize("behavior", ["reactive", "replay"])
@pytest.mark.parametrize(("weather", "friction"), GRIPS)
@pytest.mark.parametrize("wanted", [2.0, 6.0, 12.0])
def test_brakes_as_hard_as_told_up_to_model_and_grip(
    behavior: str, weather: Weather, friction: float, wanted: float
) -> None:
    end = place(ROAD, 100, speed=15.0)
    trace = driven(
        place(ROAD, 5, speed=15.0), end, weather=weather, behavior=behavior,
        at_end=RouteEnd.STAY, deceleration=wanted,
    )  # fmt: skip
    points = positions(trace)
    allowed = min(wanted, MODEL_BRAKING, friction * G)
    assert 0.975 * allowed < hardest_braking(points) < 1.01 * allowed
    # The way of braking from some 8 m/s, by the energy.
    begin = int(np.flatnonzero(speeds_of(points) >= 8.0)[-1])
    way = float(np.hypot(*np.diff(points[begin + 1 :], axis=0).T).sum())
    assert way == pytest.approx(8.0**2 / (2.0 * allowed), abs=0.5)
    assert distance_to(points, end) < 0.05


@pytest.mark.parametrize(("weather", "friction"), GRIPS)
def test_braking_and_cornering_share_the_grip(weather: Weather, friction: float) -> None:
    # Around the corner of two roads, at the most that every limit allows, to a stop behind it.
    corner = driven(
        place("harbour_1_0", 60, speed=25.0), place("-north_2_0", 40, speed=25.0),
        weather=weather, at_end=RouteEnd.STAY, deceleration=12.0, lateral_acceleration=12.0,
    )  # fmt: skip
    points = positions(corner)
    # Velocity over half a second: the points of a path are up to a metre apart.
    k = 10
    velocity = (points[k:] - points[:-k]) / (k * DT)
    acceleration = np.hypot(*(velocity[k:] - velocity[:-k]).T) / (k * DT)
    turned = np.ptp(np.unwrap(np.arctan2(velocity[:-40, 1], velocity[:-40, 0])))
    assert turned > 1.0
    assert acceleration.max() < 1.03 * friction * G


def test_without_a_limit_it_brakes_comfortably() -> None:
    way = (place(ROAD, 5, speed=15.0), place(ROAD, 60, speed=15.0), place(ROAD, 120, speed=5.0))
    told = driven(*way, deceleration=0.4 * MODEL_BRAKING)
    free = driven(*way)
    assert hardest_braking(positions(told)) == pytest.approx(3.4, rel=0.02)
    assert hardest_braking(positions(free)) < 0.55 * MODEL_BRAKING


def test_a_hard_braking_vehicle_still_stops_for_others() -> None:
    what = scenario(
        parked(),
        npc_vehicles=(
            car(place(ROAD, 80), name="wreck"),
            car(place(ROAD, 5, speed=15.0), place(ROAD, 120, speed=15.0), deceleration=12.0),
        ),
        seconds=15.0,
    )
    points = positions(run(what, standing()))
    gap = math.hypot(*(points[-1] - (place(ROAD, 80).x, place(ROAD, 80).y))) - 4.9
    assert 0.0 < gap < 5.0
    assert hardest_braking(points) <= MODEL_BRAKING + 0.1


# --- lane changes ---


def change(
    weather: Weather, lateral: float | None, behavior: str = "reactive"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions, and metres to the side of the lane that is left."""
    lane = next(
        one
        for one in network("arterial").lanes
        if one.drivable and not one.is_internal and one.left >= 0 and one.length > 200
    )
    beside = network("arterial").lanes[lane.left]
    npc = car(
        place(lane.id, 20, on="arterial", speed=15.0),
        place(beside.id, 150, on="arterial", speed=15.0),
        behavior=behavior, lateral_acceleration=lateral,
    )  # fmt: skip
    away = next(
        one
        for one in network("arterial").lanes
        if one.drivable and not one.is_internal and one.length > 150
        and one.edge_id != lane.edge_id
    )  # fmt: skip
    far = ego(place(away.id, 20, on="arterial"), place(away.id, 120, on="arterial"))
    what = scenario(far, npc_vehicles=(npc,), weather=weather, on="arterial", seconds=14.0)
    points = positions(run(what, standing()))
    aside = shapely.distance(shapely.points(points), shapely.LineString(lane.shape))
    return points, np.asarray(aside)


@pytest.mark.parametrize(("weather", "friction"), [(DRY, 1.0), (UNDER_WATER, 0.4)])
@pytest.mark.parametrize("lateral", [2.0, 4.0, 8.0, 12.0])
def test_a_lane_change_takes_the_documented_time(
    weather: Weather, friction: float, lateral: float
) -> None:
    points, aside = change(weather, lateral)
    used = min(lateral, 0.9 * friction * G)
    expected = math.pi * math.sqrt(3.5 / (2.0 * used))
    # From 2 to 98 % of the way, which half a cosine wave passes in 0.82 of its time.
    begin, end = (int(np.argmax(aside > share * aside.max())) for share in (0.02, 0.98))
    assert (end - begin) * DT == pytest.approx(0.82 * expected, abs=0.11)
    assert aside.max() == pytest.approx(3.5, abs=0.05)
    # It need not slow down for it.
    assert speeds_of(points).min() > 14.5
    k = 6
    smooth = np.convolve(aside, np.ones(k) / k, "valid")
    accelerations = (smooth[2 * k :] - 2 * smooth[k:-k] + smooth[: -2 * k]) / (k * DT) ** 2
    assert np.abs(accelerations).max() < 1.02 * used


def test_a_lane_change_without_a_limit_takes_longer() -> None:
    def seconds(lateral: float | None) -> float:
        _, aside = change(DRY, lateral)
        return float(np.count_nonzero((aside > 0.07) & (aside < 3.43)) * DT)

    assert seconds(None) > 1.9 * seconds(4.0) > 1.9 * seconds(8.0)


# --- standing for a time ---


@pytest.mark.parametrize("behavior", ["reactive", "replay"])
def test_stands_at_a_waypoint_for_its_time_and_drives_on(behavior: str) -> None:
    stop = replace(place(ROAD, 60, speed=12.0), wait=4.0)
    points = positions(
        driven(place(ROAD, 5, speed=12.0), stop, place(ROAD, 110, speed=12.0), behavior=behavior)
    )
    (seconds,) = standing_times(points)
    assert seconds == pytest.approx(4.0, abs=DT)
    still = points[:-1][speeds_of(points) < 1e-6]
    assert np.hypot(still[0, 0] - stop.x, still[0, 1] - stop.y) < 0.1
    assert speeds_of(points)[-1] > 10.0


def test_stands_at_the_first_and_at_the_last_and_at_waypoints_near_to_one_another() -> None:
    waits = ((5.0, 2.0), (60.0, 1.0), (60.5, 1.5), (110.0, 3.0))
    route = [replace(place(ROAD, s, speed=12.0), wait=wait) for s, wait in waits]
    trace = driven(*route, seconds=40.0, deceleration=8.0)
    times = standing_times(positions(trace))
    assert times == pytest.approx([2.0, 1.0, 1.5, 3.0], abs=DT + 1e-9)
    # After the last it leaves.
    assert not presence(trace, "npc")[-1]


def test_a_vehicle_that_stands_by_itself_is_not_removed_from_a_jam() -> None:
    # Two vehicles ahead of one another would wait in a ring, if one did not mean to stand.
    lane, back = ROAD, place(ROAD, 40, speed=8.0)
    what = scenario(
        parked(),
        npc_vehicles=(
            car(
                place(lane, 20, speed=8.0), replace(place(lane, 60, speed=8.0), wait=30.0),
                place(lane, 110, speed=8.0),
            ),
            car(place(lane, 5, speed=8.0), back, place(lane, 110, speed=8.0), name="behind"),
        ),
        seconds=45.0,
    )  # fmt: skip
    trace = run(what, standing())
    (seconds, *_) = standing_times(positions(trace))
    assert seconds == pytest.approx(30.0, abs=DT)
    # The one behind waits, and comes after it.
    there = presence(trace, "behind")
    assert there[: int(38.0 / DT)].all()


# --- staying at the end ---


def test_leaves_at_its_end_unless_it_is_told_to_stay() -> None:
    way = place(ROAD, 20, speed=10.0), place(ROAD, 90, speed=10.0)
    leaves, stays = driven(*way), driven(*way, at_end=RouteEnd.STAY)
    assert not presence(leaves, "npc")[-1]
    assert presence(stays, "npc").all()
    points = positions(stays)
    assert distance_to(points, way[1]) < 0.05
    assert standing_times(points)[-1] > 10.0


def stopped(behavior: str = "reactive") -> NpcVehicle:
    """A vehicle that stays at 80 m of the road, where it stands after some 8 s."""
    return car(
        place(ROAD, 40, speed=10.0), place(ROAD, 80, speed=10.0),
        at_end=RouteEnd.STAY, behavior=behavior,
    )  # fmt: skip


def test_an_ego_perceives_it_where_it_stands() -> None:
    watching = Watching()
    looking = ego(place(ROAD, 20), place(ROAD, 120))
    trace = run(scenario(looking, npc_vehicles=(stopped(),), seconds=15.0), watching)
    x, y = positions(trace)[-1]
    seen, kinds = watching.seen[-1], watching.kinds[-1]
    assert kinds.tolist() == [0]
    assert np.hypot(seen[0, 0] - x, seen[0, 1] - y) < 0.1
    assert trace.actors[row_of(trace, "npc")].length == 4.9


@pytest.mark.parametrize("behavior", ["reactive", "replay"])
def test_an_ego_that_hits_it_is_at_fault_and_could_have_stopped(behavior: str) -> None:
    late = ego(place(ROAD, 5), place(ROAD, 120), start_time=10.0, initial_speed=8.0)
    what = scenario(late, npc_vehicles=(stopped(behavior),), seconds=30.0)
    trace = run(what, Blind())
    assert contacts(trace) == [("ego", "npc")]
    # Where the boxes meet: two half lengths before its end.
    (contact,) = trace.contacts
    gap = math.hypot(*(track(trace, "ego")[contact.step] - positions(trace)[-1]))
    assert gap == pytest.approx(4.9, abs=0.5)
    (verdict,) = Collision().judge(RunView(trace, network()))
    assert verdict.outcome is Outcome.VIOLATED
    assert verdict.at_fault
    assert verdict.evidence["rule"] == "standing"
    assert verdict.avoidable is Answer.YES


def test_a_driver_with_eyes_stops_behind_it() -> None:
    late = ego(place(ROAD, 5), place(ROAD, 120), start_time=10.0)
    trace = run(scenario(late, npc_vehicles=(stopped(),), seconds=40.0))
    assert not contacts(trace)
    gap = math.hypot(*(track(trace, "ego")[-1] - positions(trace)[-1])) - 4.9
    assert 0.5 < gap < 6.0
