"""What reaches into a lane from beside it: SUMO's drivers see it from 0.2 m on, and not before."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import libsumo
import numpy as np
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.observations.trace import Role, TerminalEvent, Trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.model import (
    AgentChoice,
    BackgroundTraffic,
    EgoVehicle,
    NpcVehicle,
    Scenario,
    Waypoint,
)
from tests.simulation.episodes import (
    accelerating,
    car,
    ego,
    network,
    obstacle,
    place,
    presence,
    run,
    scenario,
    speeds,
    standing,
    start,
    track,
    walker,
)

LANE = "harbour_0_0"
WIDTH = network().lane(LANE).width
CAR_WIDTH = 2.13
HIT = 60.0
"""Arc length on the lane where things are in the way."""


def driver() -> NpcVehicle:
    """A vehicle of SUMO's that drives the whole lane."""
    return car(
        place(LANE, 10, speed=10.0), place(LANE, 130, speed=10.0), name="driver", behavior="sumo"
    )


def reaching(
    width: float, reach: float, s: float = HIT, yaw: float = 0.0, *, left: bool = False
) -> Waypoint:
    """A place from which a box ``width`` across reaches into the lane, from either side."""
    aside = 0.5 * WIDTH + 0.5 * width - reach
    at = place(LANE, s, right=-aside if left else aside)
    assert at.yaw is not None
    return replace(at, yaw=at.yaw + yaw)


def witness(name: str = "witness") -> EgoVehicle:
    return ego(place("-north_2_0", 10), place("-north_2_0", 130), name=name)


def in_the_way(kind: str, reach: float, left: bool) -> Scenario:
    """A driver of SUMO's and something that reaches into its lane by ``reach`` metres."""

    def at(width: float, s: float = HIT, yaw: float = 0.0) -> Waypoint:
        return reaching(width, reach, s, yaw, left=left)

    egos = [witness()]
    more: dict[str, Any] = {}
    drivers = [driver()]
    if kind == "obstacle":
        more["npc_obstacles"] = (obstacle(at(2.0), length=3.0, width=2.0),)
    elif kind == "obstacle across":
        across = at(4.0, yaw=0.5 * math.pi)
        more["npc_obstacles"] = (obstacle(across, length=4.0, width=1.0),)
    elif kind == "parked":
        drivers.append(car(at(CAR_WIDTH), name="parked"))
    elif kind == "parked the other way":
        drivers.append(car(at(CAR_WIDTH, yaw=math.pi), name="parked"))
    elif kind == "walker":
        more["npc_walkers"] = (walker(at(0.5)),)
    elif kind == "walker that faces the road":
        more["npc_walkers"] = (walker(at(0.5, yaw=0.5 * math.pi)),)
    elif kind == "wreck":
        # It hits a wall that is clear of the lane, and stands where it did.
        begin, end = at(CAR_WIDTH, HIT - 12.0), at(CAR_WIDTH, HIT + 40.0)
        egos.insert(0, ego(begin, end, name="wreck", initial_speed=6.0))
        wall = reaching(0.4, -1.4, HIT + 3.0, left=left)
        more["npc_obstacles"] = (obstacle(wall, name="wall", length=0.3, width=0.4),)
    return scenario(*egos, npc_vehicles=tuple(drivers), seconds=20.0, **more)


KINDS = (
    "obstacle", "obstacle across", "parked", "parked the other way", "walker",
    "walker that faces the road", "wreck",
)  # fmt: skip


def run_of(kind: str, reach: float, left: bool) -> Trace:
    agents = [standing()]
    if kind == "wreck":
        agents.insert(0, accelerating(0.0))
    return run(in_the_way(kind, reach, left), *agents)


@pytest.mark.parametrize("left", [False, True], ids=["from the verge", "from the oncoming lane"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_driver_stops_behind_what_reaches_in_by_30_cm(kind: str, left: bool) -> None:
    trace = run_of(kind, 0.3, left)
    if kind == "wreck":
        assert trace.ego_ends[0] is TerminalEvent.COLLISION
    assert speeds(trace, "driver")[-1] < 0.1
    # It stands, and did not get there by driving through.
    way = track(trace, "driver")[-1]
    hit = place(LANE, HIT)
    assert np.hypot(*(way - (hit.x, hit.y))) < 20.0
    along = math.cos(hit.yaw or 0.0) * (hit.x - way[0]) + math.sin(hit.yaw or 0.0) * (
        hit.y - way[1]
    )
    assert 3.0 < along < 16.0


@pytest.mark.parametrize("left", [False, True], ids=["from the verge", "from the oncoming lane"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_driver_passes_what_reaches_in_by_10_cm(kind: str, left: bool) -> None:
    trace = run_of(kind, 0.1, left)
    if kind == "wreck":
        assert trace.ego_ends[0] is TerminalEvent.COLLISION
    assert not presence(trace, "driver")[-1]
    here = presence(trace, "driver")
    assert speeds(trace, "driver")[here][60:].min() > 8.0


def test_a_wreck_across_two_lanes_stops_both() -> None:
    town = "highway"
    lanes = ("eb_1_0", "eb_1_1")
    middle = network(town).lane(lanes[0]).width / 2.0
    block = obstacle(place(lanes[0], 150, on=town, right=-middle), length=5.0, width=2.0)
    drivers = tuple(
        car(
            place(lane, 40, on=town, speed=20.0), place(lane, 300, on=town, speed=20.0),
            name=lane, behavior="sumo",
        )
        for lane in lanes
    )  # fmt: skip
    away = ego(place("eb_1_0", 10, on=town), place("eb_1_0", 30, on=town), name="away")
    what = scenario(away, on=town, npc_vehicles=drivers, npc_obstacles=(block,), seconds=12.0)
    trace = run(what, standing())
    spot = place(lanes[0], 150, on=town)
    for lane in lanes:
        before = np.hypot(*(track(trace, lane) - (spot.x, spot.y)).T)
        # They may change lanes further to the left; through the block they must not drive.
        inside = before < 3.0
        assert not inside.any() or lane != lanes[0]
    assert speeds(trace, lanes[0])[-1] < 0.1


def test_traffic_drives_on_when_a_walker_has_crossed() -> None:
    what = scenario(
        witness(),
        npc_vehicles=(driver(),),
        npc_walkers=(
            walker(place(LANE, HIT, right=3.0, speed=0.8), place(LANE, HIT, right=-9.0, speed=0.8)),
        ),
        seconds=30.0,
    )
    trace = run(what, standing())
    here = presence(trace, "driver")
    assert speeds(trace, "driver")[here].min() < 2.0
    assert not here[-1]
    apart = np.hypot(*(track(trace, "driver") - track(trace, "walker")).T)
    assert np.nanmin(apart) > 2.0


def crossed() -> Scenario:
    """A walker that crosses, a container that lies across two lanes for good, and traffic."""
    return scenario(
        ego(place("-north_2_0", 10), place("-north_2_0", 130)),
        npc_walkers=(walker(place(LANE, HIT, right=4.0), place(LANE, HIT, right=-12.0)),),
        npc_obstacles=(obstacle(place("harbour_1_0", 60, right=-2.0), length=3.0, width=2.5),),
        background_traffic=BackgroundTraffic(count=4),
        seconds=16.0,
    )


def test_stand_ins_are_in_sumo_only_and_leave_with_what_they_stand_for() -> None:
    episode = start(crossed(), standing(), mirrored=True)
    held = []
    while not episode.done:
        episode.step()
        known = libsumo.vehicle.getIDList()
        held.append(sum(name.startswith("stand-in") for name in known))
        assert not any(actor.id.startswith("stand-in") for actor in episode.look().actors)
    trace = episode.finish()
    roles = [actor.role for actor in trace.actors]
    assert roles == [Role.EGO, Role.NPC_WALKER, Role.NPC_OBSTACLE, *[Role.BACKGROUND] * 4]
    # One on each lane under the container, and while the walker crosses one or two more.
    assert held[10] == 2
    assert max(held) in (3, 4)
    assert held[-1] == 2
    assert trace_sha256(trace) == trace_sha256(run(crossed(), standing()))


def test_nothing_is_added_where_nothing_reaches_over() -> None:
    episode = start(
        scenario(
            ego(place(LANE, 20), place(LANE, 120)),
            npc_vehicles=(car(place(LANE, 60), name="parked"),),
            npc_walkers=(walker(place(LANE, 80, right=4.0)),),
            npc_obstacles=(obstacle(place(LANE, 100, right=4.5)),),
            seconds=4.0,
        ),
        standing(),
        mirrored=True,
    )
    while not episode.done:
        episode.step()
        assert not any(name.startswith("stand-in") for name in libsumo.vehicle.getIDList())


def test_with_sublanes_what_stands_across_lanes_is_never_on_one() -> None:
    """A vehicle that is taken off its lanes there ends SUMO's process by a segmentation fault."""
    town = "arterial"
    lanes = [lane for lane in network(town).lanes if lane.drivable and lane.arc[-1] > 30.0]
    drawn = np.random.default_rng(1)
    boxes = tuple(
        obstacle(
            place(
                lanes[int(drawn.integers(len(lanes)))].id, float(drawn.uniform(2.0, 28.0)),
                on=town, right=float(drawn.uniform(-3.0, 3.0)),
            ),
            name=f"box {number}", length=float(drawn.uniform(1.0, 8.0)), width=2.0,
            start_time=float(drawn.uniform(0.0, 6.0)),
        )
        for number in range(24)
    )  # fmt: skip
    first = next(lane for lane in lanes if not lane.is_internal and lane.arc[-1] > 100.0)
    sublanes = AgentChoice(name="sumo-krauss", parameters={"lane_change_model": "SL2015"})
    one = replace(ego(place(first.id, 10, on=town), place(first.id, 90, on=town)), agent=sublanes)
    away = ego(place(first.id, 30, on=town), place(first.id, 90, on=town), name="away")
    what = scenario(
        one, away, on=town, npc_obstacles=boxes, background_traffic=BackgroundTraffic(count=25),
        seconds=25.0,
    )  # fmt: skip
    driver = AgentCatalogue().create("sumo-krauss", sublanes.parameters)
    episode = start(what, driver, standing(), mirrored=True)  # type: ignore[arg-type]  # one of SUMO's drivers
    held = 0
    while not episode.done:
        episode.step()
        known = libsumo.vehicle.getIDList()
        held = max(held, sum(name.startswith("stand-in") for name in known))
        for name in known:
            assert not name.startswith("box") or libsumo.vehicle.getLaneID(name) == ""
    assert held > 20
