"""Egos, NPC vehicles, walkers and obstacles of a document act in an episode."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.observations.trace import Role
from drivora_service.scenario.model import Waypoint
from tests.simulation.episodes import (
    ROAD,
    Blind,
    car,
    closest,
    contacts,
    ego,
    obstacle,
    parked,
    place,
    presence,
    row_of,
    run,
    scenario,
    speeds,
    standing,
    track,
    travelled,
    walker,
)

AVENUE = "grand_1_1"
"""112 m of signal-grid with a sidewalk beside it, straight east, 50 km/h."""


# --- egos ---


def test_an_ego_stands_until_its_start_time_and_drives_then() -> None:
    what = scenario(
        ego(place(ROAD, 10), place(ROAD, 110), name="now"),
        ego(place("-north_2_0", 10), place("-north_2_0", 120), name="later", start_time=2.0),
        ego(
            place("harbour_0_0", 20), place("harbour_0_0", 200), name="rolling",
            start_time=1.0, initial_speed=9.0,
        ),
        seconds=5.0,
    )  # fmt: skip
    trace = run(what)
    assert [a.role for a in trace.actors] == [Role.EGO] * 3
    assert presence(trace, "later").all()
    assert speeds(trace, "now")[40] > 1.0
    later = speeds(trace, "later")
    assert np.all(later[:41] == 0.0)
    assert np.all(track(trace, "later")[:41] == track(trace, "later")[0])
    assert later[80] > 1.0
    rolling = speeds(trace, "rolling")
    assert np.all(rolling[:20] == 0.0)
    assert 8.5 < rolling[21] < 9.5


# --- NPC vehicles ---


@pytest.mark.parametrize("behavior", ["replay", "reactive", "sumo"])
def test_an_npc_vehicle_comes_at_its_start_time_drives_its_route_and_leaves(behavior: str) -> None:
    npc = car(
        place(ROAD, 10, speed=8.0), place(ROAD, 60, speed=8.0), place(ROAD, 110, speed=8.0),
        behavior=behavior, start_time=1.0,
    )  # fmt: skip
    trace = run(scenario(parked(), npc_vehicles=(npc,), seconds=18.0), standing())
    here = presence(trace, "npc")
    first, last = int(np.argmax(here)), int(len(here) - 1 - np.argmax(here[::-1]))
    assert trace.times[first] == pytest.approx(1.0, abs=0.051)
    assert here[first : last + 1].all()
    assert trace.times[last] < 17.0
    way = track(trace, "npc")
    assert np.hypot(*(way[first] - (npc.route[0].x, npc.route[0].y))) < 1.0
    middle = np.hypot(*(way[first : last + 1] - (npc.route[1].x, npc.route[1].y)).T)
    assert middle.min() < 0.6
    assert np.hypot(*(way[last] - (npc.route[2].x, npc.route[2].y))) < 3.5
    assert np.nanmax(speeds(trace, "npc")) > 6.0


def test_a_replayed_vehicle_keeps_to_its_waypoints_off_the_road_and_to_their_speeds() -> None:
    route = tuple(Waypoint(x=150.0 + 10 * i, y=40.0 + 3 * i, speed=3.0 + i) for i in range(6))
    trace = run(
        scenario(parked(), npc_vehicles=(car(*route, behavior="replay"),), seconds=16.0),
        standing(),
    )
    way, speed = track(trace, "npc"), speeds(trace, "npc")
    for i, point in enumerate(route[1:-1], start=1):
        near = np.hypot(way[:, 0] - point.x, way[:, 1] - point.y)
        assert np.nanmin(near) < 0.5
        assert speed[int(np.nanargmin(near))] == pytest.approx(3.0 + i, abs=0.6)


def test_replay_drives_into_what_reactive_stops_for() -> None:
    block = obstacle(place(ROAD, 80))
    for behavior, reaches in (("replay", True), ("reactive", False), ("sumo", False)):
        npc = car(place(ROAD, 10, speed=8.0), place(ROAD, 120, speed=8.0), behavior=behavior)
        what = scenario(parked(), npc_vehicles=(npc,), npc_obstacles=(block,), seconds=12.0)
        assert (closest(run(what, standing()), "npc", "box") < 3.0) == reaches, behavior


def test_vehicles_of_every_behavior_stop_behind_a_standing_ego() -> None:
    for behavior in ("reactive", "sumo"):
        npc = car(place(ROAD, 10, speed=8.0), place(ROAD, 120, speed=8.0), behavior=behavior)
        what = scenario(ego(place(ROAD, 70), place(ROAD, 120)), npc_vehicles=(npc,), seconds=12.0)
        trace = run(what, standing())
        assert not trace.contacts
        assert speeds(trace, "npc")[-1] < 0.1
        assert 5.0 < closest(trace, "npc", "ego") < 12.0


def test_a_single_waypoint_is_a_parked_vehicle() -> None:
    trace = run(scenario(parked(), npc_vehicles=(car(place(ROAD, 50)),), seconds=2.0), standing())
    assert presence(trace, "npc").all()
    assert travelled(trace, "npc") == 0.0


def test_a_reactive_vehicle_stops_behind_the_queue_of_others() -> None:
    what = scenario(
        ego(place(ROAD, 110), place(ROAD, 122)),
        npc_vehicles=(
            car(place(ROAD, 60, speed=8.0), place(ROAD, 120), name="first", behavior="sumo"),
            car(place(ROAD, 20, speed=8.0), place(ROAD, 120), name="second"),
        ),
        seconds=14.0,
    )
    trace = run(what, standing())
    assert 4.9 < closest(trace, "first", "second") < 12.0
    assert 4.9 < closest(trace, "first", "ego") < 12.0
    assert contacts(trace) == []


# --- walkers ---


@pytest.mark.parametrize(("town", "lane"), [("tee-town", ROAD), ("signal-grid", AVENUE)])
def test_a_walker_walks_at_the_speeds_of_its_waypoints_and_stays(town: str, lane: str) -> None:
    route = (
        place(lane, 60, on=town, right=6.0),
        place(lane, 60, on=town, right=2.0, speed=1.0),
        place(lane, 60, on=town, right=-4.0, speed=2.0),
    )
    far = {"tee-town": "-north_2_0", "signal-grid": "north_3_1"}[town]
    what = scenario(
        ego(place(far, 20, on=town), place(far, 100, on=town)),
        on=town, npc_walkers=(walker(*route, start_time=1.0),), seconds=11.0,
    )  # fmt: skip
    trace = run(what, standing())
    here, speed = presence(trace, "walker"), speeds(trace, "walker")
    assert not here[:20].any()
    assert here[20:].all()
    assert speed[20 + 60] == pytest.approx(1.0, abs=0.05)
    assert speed[20 + 80 + 45] == pytest.approx(2.0, abs=0.05)
    assert speed[-1] == 0.0
    assert np.hypot(*(track(trace, "walker")[-1] - (route[2].x, route[2].y))) < 0.3
    assert trace.actors[row_of(trace, "walker")].length < 1.0


@pytest.mark.parametrize(("town", "lane"), [("tee-town", ROAD), ("signal-grid", "queen_1_1")])
@pytest.mark.parametrize("behavior", ["reactive", "sumo"])
def test_vehicles_stop_for_a_walker_in_their_lane_and_pass_one_beside_it(
    town: str, lane: str, behavior: str
) -> None:
    far = {"tee-town": "-north_2_0", "signal-grid": "north_3_1"}[town]
    npc = car(
        place(lane, 10, on=town, speed=8.0), place(lane, 105, on=town, speed=8.0),
        behavior=behavior,
    )  # fmt: skip
    for right, passes in ((0.0, False), (4.5, True)):
        what = scenario(
            ego(place(far, 20, on=town), place(far, 100, on=town)),
            on=town,
            npc_vehicles=(npc,),
            npc_walkers=(walker(place(lane, 70, on=town, right=right)),),
            seconds=11.0,
        )
        trace = run(what, standing())
        way = travelled(trace, "npc")
        assert (way > 65.0) if passes else (40.0 < way < 58.0), (right, way)


# --- obstacles ---


def test_an_obstacle_has_its_own_pose_size_and_start_time() -> None:
    spot = place(ROAD, 60)
    what = scenario(
        parked(),
        npc_obstacles=(
            obstacle(
                Waypoint(x=spot.x, y=spot.y, yaw=1.2), length=3.3, width=0.7, start_time=1.5,
            ),
            obstacle(place(ROAD, 90), name="plain", model="static.prop.trafficcone01"),
        ),
        seconds=3.0,
    )  # fmt: skip
    trace = run(what, standing())
    row = row_of(trace, "box")
    assert int(np.argmax(trace.present[:, row])) == 30
    assert trace.present[30:, row].all()
    assert np.all(trace.states[30:, row, :3] == (spot.x, spot.y, 1.2))
    assert np.all(trace.states[30:, row, 3:8] == 0.0)
    assert (trace.actors[row].length, trace.actors[row].width) == (3.3, 0.7)
    assert presence(trace, "plain").all()
    assert trace.actors[row_of(trace, "plain")].length < 1.0


def test_an_ego_hits_the_long_side_of_an_obstacle_that_reaches_into_its_lane() -> None:
    spot = place(ROAD, 70, right=4.0)
    across = (spot.yaw or 0.0) + 0.5 * math.pi
    for yaw, hits in ((spot.yaw, False), (across, True)):
        plank = obstacle(Waypoint(x=spot.x, y=spot.y, yaw=yaw), length=8.0, width=0.5)
        what = scenario(
            ego(place(ROAD, 10), place(ROAD, 120)), npc_obstacles=(plank,), seconds=15.0
        )
        assert bool(run(what, Blind()).contacts) == hits
