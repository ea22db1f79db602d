"""Scenes that several benchmarks share."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import (
    AgentChoice,
    BackgroundTraffic,
    EgoVehicle,
    LightTimes,
    MapRegion,
    NpcBehavior,
    NpcObstacle,
    NpcVehicle,
    NpcWalker,
    Scenario,
    TrafficLights,
    Waypoint,
    Weather,
)
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.scenario.validation import validate_document

_NPC_SPEED = 8.0
_NPC_WAYPOINTS = 5
_APART = 3
_MIXED_SECONDS = 20.0
_CROWD_GAP = 25.0
"""Metres between two vehicles of a crowd, at least."""


def _waypoints(route: ET.Element, network: RoadNetwork) -> list[Waypoint]:
    offset_x, offset_y = network.net_offset
    return [
        Waypoint(
            x=float(point.attrib["x"]) + offset_x,
            y=-float(point.attrib["y"]) + offset_y,
            yaw=-math.radians(float(point.attrib["yaw"])),
            speed=_NPC_SPEED,
        )
        for point in route.findall("waypoint")
    ]


def town_scene(routes: Path, network: RoadNetwork, *, npcs: int) -> Scenario:
    """Returns an ego on a town's first Leaderboard route and NPCs on the next ones."""
    found = [r for r in ET.parse(routes).getroot() if r.get("town") == network.name]
    ways = [_waypoints(route, network) for route in found]
    last = max(len(way) for way in ways[1:]) - 1
    pieces = [
        tuple(way[first : first + _NPC_WAYPOINTS])
        for shift in range(_APART)
        for first in range(1 + shift, last, _APART)
        for way in ways[1:]
        if first < len(way) - 1
    ]
    if npcs > len(pieces):
        raise ValueError(f"{npcs} NPCs on {network.name}: its routes have room for {len(pieces)}")
    vehicles = [
        NpcVehicle(
            id=f"npc{number}",
            model="vehicle.audi.tt",
            route=piece,
            behavior=NpcBehavior.REACTIVE,
        )
        for number, piece in enumerate(pieces[:npcs])
    ]
    return Scenario(
        ego_vehicles=(
            EgoVehicle(
                id="ego",
                model="vehicle.lincoln.mkz_2017",
                route=tuple(ways[0]),
                agent=AgentChoice(name="idm"),
            ),
        ),
        npc_vehicles=tuple(vehicles),
        map_region=MapRegion(town=network.name),
    )


def usual_scenes(count: int, seed: int) -> list[Scenario]:
    """Returns scenes of the usual size on tee-town: one ego, ten reactive NPCs, 60 s."""
    networks = NetworkCatalogue(shipped_networks())
    ways = [
        validate_document(document, networks, ("idm",)).scenario
        for document in generate_seeds(
            networks.get("tee-town"),
            count=40,
            min_length=450,
            max_length=1200,
            seed=seed,
            agent="idm",
        )
    ]
    return [
        replace(
            ways[number % len(ways)],
            npc_vehicles=tuple(
                NpcVehicle(
                    id=f"npc{k}",
                    model="vehicle.audi.tt",
                    route=tuple(
                        replace(point, speed=_NPC_SPEED)
                        for point in ways[(number + 3 * k + 1) % len(ways)].ego_vehicles[0].route
                    ),
                    start_time=0.5 * k,
                )
                for k in range(10)
            ),
            max_sim_time=60.0,
            seed=number,
        )
        for number in range(count)
    ]


def crowd_scene(network: RoadNetwork, *, npcs: int, seconds: float = 60.0) -> Scenario:
    """Returns an ego on a long way and NPCs that stay on the road for the whole run.

    The NPCs are spread evenly over the long lanes of the network, and drive along them.

    Raises:
        ValueError: The network's long lanes have no room for so many.
    """
    networks = NetworkCatalogue(shipped_networks())
    (document,) = generate_seeds(
        network, count=1, min_length=700, max_length=3000, seed=1, agent="idm"
    )
    ego = validate_document(document, networks, ("idm",)).scenario.ego_vehicles[0]
    ahead = _NPC_SPEED * seconds + _CROWD_GAP
    places = [
        (lane.index, along)
        for lane in network.lanes
        if lane.drivable and not lane.is_internal and lane.length > ahead
        for along in np.arange(_CROWD_GAP, lane.length - ahead, _CROWD_GAP)
        if math.dist(lane.position_at(along)[:2], (ego.route[0].x, ego.route[0].y)) > _CROWD_GAP
    ]
    if npcs > len(places):
        raise ValueError(
            f"{npcs} NPCs on {network.name}: its long lanes have room for {len(places)}"
        )
    chosen = [places[number * len(places) // npcs] for number in range(npcs)]
    return Scenario(
        ego_vehicles=(ego,),
        npc_vehicles=tuple(
            NpcVehicle(
                id=f"npc{number}",
                model="vehicle.audi.tt",
                route=tuple(
                    _waypoint(network, lane, at) for at in (along, along + ahead - _CROWD_GAP / 2)
                ),
                behavior=NpcBehavior.REACTIVE,
            )
            for number, (lane, along) in enumerate(chosen)
        ),
        map_region=MapRegion(town=network.name),
        max_sim_time=seconds,
    )


def _waypoint(network: RoadNetwork, lane: int, along: float) -> Waypoint:
    x, y, yaw = network.lanes[lane].position_at(along)
    return Waypoint(x=x, y=y, yaw=yaw, speed=_NPC_SPEED)


def mixed_scenarios(count: int, seed: int) -> list[Scenario]:
    """Returns short scenarios over all shipped networks that use every kind of actor.

    The egos' ways are generated seeds; NPCs of all three behaviours, walkers, an obstacle, weather
    with and without noise, light times and background traffic are drawn on top of them.
    """
    networks = NetworkCatalogue(shipped_networks())
    rng = np.random.default_rng(seed)
    names = networks.names()
    share = math.ceil(count / len(names))
    found: list[Scenario] = []
    for name in names:
        network = networks.get(name)
        seeds = list(
            generate_seeds(
                network, count=2 * share, min_length=100, max_length=400, seed=seed, agent="idm"
            )
        )
        egos = [validate_document(s, networks, AgentCatalogue().names()).scenario for s in seeds]
        found += [_add_actors(egos[n], egos[share + n], network, rng) for n in range(share)]
    return found[:count]


def _add_actors(
    scenario: Scenario, other: Scenario, network: RoadNetwork, rng: np.random.Generator
) -> Scenario:
    way = other.ego_vehicles[0].route
    behavior = tuple(NpcBehavior)[int(rng.integers(3))]
    start = scenario.ego_vehicles[0].route[0]
    x, y, _ = network.lanes[_some_lane(network, rng)].position_at(10.0)
    agents = ("idm", "idm", "idm", "sumo-krauss", "sumo-idm", "sumo-eidm")
    ego = replace(
        scenario.ego_vehicles[0],
        agent=AgentChoice(name=agents[int(rng.integers(len(agents)))]),
        start_time=float(rng.integers(0, 3)),
    )
    return replace(
        scenario,
        ego_vehicles=(ego,),
        npc_vehicles=(
            NpcVehicle(
                id="npc",
                model="vehicle.audi.tt",
                route=tuple(replace(point, speed=7.0) for point in way),
                behavior=behavior,
                start_time=float(rng.uniform(0.0, 4.0)),
            ),
        ),
        npc_walkers=(
            NpcWalker(
                id="walker",
                model="walker.pedestrian.0001",
                route=(Waypoint(x=x, y=y - 8.0), Waypoint(x=x, y=y + 8.0)),
                start_time=float(rng.uniform(0.0, 6.0)),
            ),
        ),
        npc_obstacles=(
            NpcObstacle(
                id="cone",
                model="static.prop.trafficcone01",
                location=Waypoint(x=start.x + 30.0, y=start.y + 9.0),
            ),
        ),
        weather=Weather(
            fog_density=float(rng.choice([0.0, 60.0])), wetness=float(rng.choice([0.0, 80.0]))
        ),
        traffic_lights=TrafficLights(times=LightTimes(green=float(rng.integers(8, 20)))),
        background_traffic=BackgroundTraffic(count=int(rng.integers(0, 16))),
        seed=int(rng.integers(1_000_000)),
        max_sim_time=_MIXED_SECONDS,
    )


def _some_lane(network: RoadNetwork, rng: np.random.Generator) -> int:
    lanes = [
        lane.index
        for lane in network.lanes
        if lane.drivable and not lane.is_internal and lane.length > 20.0
    ]
    return lanes[int(rng.integers(len(lanes)))]
