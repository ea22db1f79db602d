"""A hundred scenario documents of many kinds: good and bad drivers, whatever may happen to them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from tests.recomputation.town import RoadLane, Town, lane_length, read_town
from tests.recomputation.ways import Random, Way, find_way

TOWNS = ("tee-town", "signal-grid", "arterial", "roundabout", "highway", "old-town", "rural")
WITH_SIGNALS = ("tee-town", "signal-grid", "arterial", "old-town")
WITH_STOP_SIGNS = ("tee-town", "arterial", "old-town")
DRIVERS = (
    "idm",
    "idm-mobil",
    "pdm-closed",
    "plant-lite",
    "ad-mlp",
    "sumo-krauss",
    "sumo-idm",
    "sumo-eidm",
    "sumo-acc",
)
EXAMPLES = (
    "highway-cut-in",
    "lead-vehicle-and-pedestrian",
    "roundabout-in-fog",
    "rural-in-carla-frame",
    "signalised-grid",
    "three-drivers",
    "walker-behind-van",
    "wet-arterial",
)
_EXAMPLES = Path(__file__).resolve().parents[2] / "openscenario_schemas" / "examples"
CARS = ("vehicle.tesla.model3", "vehicle.audi.tt", "vehicle.mercedes.sprinter")

STEP_LENGTHS = (0.05, 0.05, 0.1, 0.05, 0.02)
"""Seconds."""

Document = dict[str, Any]


def _before_signal(town: Town, random: Random) -> RoadLane:
    """Returns a lane of some length that ends at a signal."""
    lanes = [
        lane
        for lane in town.lanes.values()
        if not lane.inside and lane_length(lane) > 40.0 and any(m.light for m in lane.movements)
    ]
    return lanes[random.integers(len(lanes))]


def _document(town: str, seed: int, seconds: float, egos: list[Document], **more: Any) -> Document:
    return {
        "version": "1.0",
        "frame": "sumo",
        "map_region": {"town": town},
        "ego_vehicles": egos,
        "seed": seed,
        "step_length": STEP_LENGTHS[seed % len(STEP_LENGTHS)],
        "max_sim_time": seconds,
        **more,
    }


def _ego(way: Way, start: float, end: float, agent: str, **more: Any) -> Document:
    parameters = more.pop("parameters", {})
    return {
        "id": more.pop("id", "ego_0"),
        "model": more.pop("model", CARS[0]),
        "dynamics": "dynamic" if len(way.lanes) % 2 else "kinematic",
        "route": way.waypoints(start, end),
        "agent": {"name": agent, "parameters": parameters},
        **more,
    }


def shipped_example(n: int, random: Random) -> Document:
    """A scenario that is shipped."""
    path = _EXAMPLES / f"{EXAMPLES[n]}.json"
    document: Document = json.loads(path.read_text())
    return document


def in_traffic(n: int, random: Random) -> Document:
    """One of all drivers among background traffic."""
    town = TOWNS[n % len(TOWNS)]
    way = find_way(read_town(town), random, 250.0)
    ego = _ego(way, 8.0, way.line.length - 6.0, DRIVERS[n % len(DRIVERS)], model=CARS[n % 3])
    lights = {"green_time": 8.0, "red_time": 8.0, "offset": float(n)}
    more = {"traffic_lights": lights} if town in WITH_SIGNALS else {}
    return _document(town, n, 60.0, [ego], background_traffic={"count": 25}, **more)


def at_signals(n: int, random: Random) -> Document:
    """A script that heeds no signal.

    It drives along its route, or turns off at the signal, or moves over to a lane beside its route.
    """
    town = WITH_SIGNALS[n % len(WITH_SIGNALS)]
    network = read_town(town)
    first = _before_signal(network, random)
    start = max(lane_length(first) - 45.0, 6.0)
    speed = 7.0 + n % 5
    route = find_way(network, random, 150.0, first)
    kind = n // len(WITH_SIGNALS) % 3
    beside = [lane for lane in _others_before_signal(network, first) if kind == 2]
    driven = find_way(network, random, 180.0, *beside, *([] if beside else [first]))
    if kind == 0:
        route = driven
    place = route.place(start)
    begin = driven.line.project(shapely.Point(place["x"], place["y"]))
    ego = _ego(
        route,
        start,
        route.line.length - 6.0,
        "scripted",
        initial_speed=speed,
        model=CARS[n % 3],
        parameters={"trajectory": [[0.0, place["x"], place["y"]], *_over(driven, begin, speed)]},
    )
    lights = {"green_time": 6.0 + n % 4, "red_time": 9.0, "offset": float(2 * n)}
    return _document(town, n, 25.0, [ego], traffic_lights=lights)


def _others_before_signal(town: Town, lane: RoadLane) -> list[RoadLane]:
    """Returns the lanes next to a lane that end at signals as well."""
    return [
        other
        for other in town.lanes.values()
        if other.edge == lane.edge
        and other is not lane
        and any(movement.light for movement in other.movements)
        and np.hypot(*(other.line[-1] - lane.line[-1])) < 5.0
    ]


def _over(way: Way, begin: float, speed: float) -> list[list[float]]:
    """Returns a script that joins a way 16 m ahead of a place on it or beside it."""
    script = way.trajectory(begin + 16.0, speed)
    return [[seconds + 16.0 / speed, x, y] for seconds, x, y in script]


def at_long_reds(n: int, random: Random) -> Document:
    """A driver on a short route that waits longer than the route's time limit."""
    town = "signal-grid"
    network = read_town(town)
    first = _before_signal(network, random)
    way = find_way(network, random, 0.0, first)
    start = max(lane_length(first) - 30.0, 6.0)
    ego = _ego(way, start, lane_length(first) + 30.0, "idm")
    lights = {"green_time": 60.0, "red_time": 62.0, "offset": 45.0 * n}
    return _document(town, n, 140.0, [ego], traffic_lights=lights)


def at_stop_signs(n: int, random: Random) -> Document:
    """A script that stops at signs, or does not."""
    town = WITH_STOP_SIGNS[n % len(WITH_STOP_SIGNS)]
    network = read_town(town)
    before = [
        lane
        for lane in network.lanes.values()
        if not lane.inside and lane_length(lane) > 40.0
        if any(movement.state in ("s", "w") for movement in lane.movements)
    ]
    way = find_way(network, random, 130.0, *before)
    start = max(lane_length(way.lanes[0]) - 40.0, 6.0)
    script = way.trajectory(start, 6.0)
    if n < len(WITH_STOP_SIGNS):
        # A stand of two seconds, with the front a metre or two before the line.
        halt = lane_length(way.lanes[0]) - 6.0
        line = (halt - start - 1.0) / 6.0
        script = [[seconds + 3.0 * (seconds > line), x, y] for seconds, x, y in script]
        place = way.place(halt)
        stand = [[line + after, place["x"], place["y"]] for after in (0.5, 2.5)]
        script = sorted([*script, *stand])
    ego = _ego(
        way,
        start,
        way.line.length - 6.0,
        "scripted",
        initial_speed=6.0,
        parameters={"trajectory": script},
    )
    return _document(town, n, 30.0, [ego])


def off_the_road(n: int, random: Random) -> Document:
    """A script that leaves its lane, and comes back or not."""
    town = TOWNS[n % len(TOWNS)]
    way = find_way(read_town(town), random, 160.0)
    side, width = (-1.0 if n % 3 else 1.0), 2.0 + (n % 5)

    def aside(s: float) -> float:
        return side * width * float(np.sin(np.pi * np.clip((s - 15.0) / 60.0, 0.0, 1.0)) ** 2)

    ego = _ego(
        way,
        10.0,
        way.line.length - 6.0,
        "scripted",
        initial_speed=9.0,
        model=CARS[n % 3],
        parameters={"trajectory": way.trajectory(10.0, 9.0, aside)},
    )
    return _document(town, n, 15.0, [ego])


def beside_signals(n: int, random: Random) -> Document:
    """A script that passes the stop lines of its route beside the lane, near or far."""
    town = WITH_SIGNALS[n % len(WITH_SIGNALS)]
    first = _before_signal(read_town(town), random)
    way = find_way(read_town(town), random, 150.0, first)
    start = max(lane_length(first) - 45.0, 6.0)
    width = (-4.5, 3.5, -7.0, 6.5, -10.0, 11.0)[n % 6]

    def aside(s: float) -> float:
        return width * float(np.clip((s - 4.0) / 24.0, 0.0, 1.0))

    ego = _ego(
        way,
        start,
        way.line.length - 6.0,
        "scripted",
        initial_speed=8.0,
        parameters={"trajectory": way.trajectory(start, 8.0, aside)},
    )
    lights = {"green_time": 6.0, "red_time": 12.0, "offset": float(3 * n)}
    return _document(town, n, 16.0, [ego], traffic_lights=lights)


def astray(n: int, random: Random) -> Document:
    """A script that soon takes another way than its route."""
    town = TOWNS[n % len(TOWNS)]
    network = read_town(town)
    forks = [
        lane
        for lane in network.lanes.values()
        if not lane.inside and lane_length(lane) > 25.0 and len(lane.movements) > 1
    ]
    first = forks[random.integers(len(forks))]
    route = find_way(network, random, 160.0, first)
    others = (find_way(network, random, 220.0, first) for _ in range(40))
    driven = next(way for way in others if way.lanes[1] is not route.lanes[1])
    start = max(lane_length(first) - 30.0, 6.0)
    ego = _ego(
        route,
        start,
        route.line.length - 6.0,
        "scripted",
        initial_speed=9.0,
        parameters={"trajectory": driven.trajectory(start, 9.0)},
    )
    return _document(town, n, 18.0, [ego])


def too_fast(n: int, random: Random) -> Document:
    """A driver that exceeds speed limits."""
    town = TOWNS[n % len(TOWNS)]
    way = find_way(read_town(town), random, 300.0)
    agent, parameters = ("idm", {"speed_factor": 1.2 + 0.1 * (n % 6)})
    if n % 4 == 3:
        agent, parameters = "scripted", {"speed": 17.0}
    ego = _ego(way, 8.0, way.line.length - 6.0, agent, initial_speed=8.0, parameters=parameters)
    return _document(town, n, 22.0, [ego])


def with_obstacles(n: int, random: Random) -> Document:
    """Something lies on the way, or a vehicle is parked there."""
    town = TOWNS[n % len(TOWNS)]
    way = find_way(read_town(town), random, 150.0)
    agent = ("scripted", "ad-mlp", "scripted", "idm", "plant-lite", "pdm-closed")[n % 6]
    ego = _ego(way, 8.0, way.line.length - 6.0, agent, initial_speed=7.0, model=CARS[n % 3])
    place = way.place(45.0 + n, aside=0.4 * (n % 5 - 2))
    if n % 3 == 0:
        parked = {"id": "parked", "model": CARS[2], "route": [place]}
        return _document(town, n, 15.0, [ego], npc_vehicles=[parked])
    model = ("static.prop.container", "static.prop.trafficcone01")[n % 2]
    thing = {"id": "thing", "model": model, "location": place}
    return _document(town, n, 15.0, [ego], npc_obstacles=[thing])


def with_walkers(n: int, random: Random) -> Document:
    """A walker crosses the way, and a vehicle that sees nothing comes behind."""
    town = TOWNS[n % len(TOWNS)]
    way = find_way(read_town(town), random, 150.0)
    agent = ("scripted", "scripted", "idm", "ad-mlp")[n % 4]
    ego = _ego(way, 30.0, way.line.length - 6.0, agent, initial_speed=8.0)
    across = [way.place(62.0 + n, aside) for aside in (6.0, -6.0)]
    walker = {
        "id": "walker",
        "model": "walker.pedestrian.0001",
        "start_time": (32.0 + n) / 8.0 - 3.0 + 0.2 * (n % 5 - 2),
        "route": [{"x": at["x"], "y": at["y"], "speed": 2.0} for at in across],
    }
    behind = {
        "id": "behind",
        "model": CARS[1],
        "behavior": "replay",
        "route": [
            {**{k: v for k, v in way.place(s).items() if k != "yaw"}, "speed": 8.5}
            for s in np.arange(4.0, 140.0, 3.0).tolist()
        ],
    }
    return _document(town, n, 15.0, [ego], npc_walkers=[walker], npc_vehicles=[behind])


def several_egos(n: int, random: Random) -> Document:
    """Three egos on one road, one of which starts late; the last is faster than the others."""
    town = TOWNS[n % len(TOWNS)]
    network = read_town(town)
    long = [lane for lane in network.lanes.values() if not lane.inside and lane_length(lane) > 60.0]
    way = find_way(network, random, 200.0, *long)
    end = way.line.length - 6.0
    egos = [
        _ego(way, 40.0, end, "idm", id="late", start_time=2.0 + 0.03 * n, model=CARS[1]),
        _ego(way, 25.0, end, DRIVERS[n % 5], id="middle", initial_speed=4.0, model=CARS[1]),
        _ego(
            way,
            8.0,
            end,
            "scripted" if n % 2 else "ad-mlp",
            id="last",
            initial_speed=9.0,
            model=CARS[1],
        ),
    ]
    return _document(town, n, 30.0, egos)


KINDS: dict[Callable[[int, Random], Document], int] = {
    shipped_example: len(EXAMPLES),
    in_traffic: 12,
    at_signals: 16,
    at_stop_signs: 6,
    at_long_reds: 3,
    beside_signals: 6,
    off_the_road: 11,
    too_fast: 8,
    astray: 6,
    with_obstacles: 9,
    with_walkers: 8,
    several_egos: 7,
}


def mixed_documents() -> dict[str, Document]:
    """Returns all documents by a name that tells their kind."""
    return {
        f"{make.__name__}-{n}": make(n, np.random.default_rng([*make.__name__.encode(), n]))
        for make, count in KINDS.items()
        for n in range(count)
    }
