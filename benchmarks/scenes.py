"""Scenes that several benchmarks share."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import (
    AgentChoice,
    EgoVehicle,
    MapRegion,
    NpcBehavior,
    NpcVehicle,
    Scenario,
    Waypoint,
)

_NPC_SPEED = 8.0
_NPC_WAYPOINTS = 5
_APART = 3


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
    """Gives an ego on a town's first Leaderboard route and NPCs on the next ones."""
    found = [r for r in ET.parse(routes).getroot() if r.get("town") == network.name]
    ways = [_waypoints(route, network) for route in found]
    vehicles = []
    for number in range(npcs):
        way = ways[1 + number % (len(ways) - 1)]
        first = 1 + _APART * (number // (len(ways) - 1))
        vehicles.append(
            NpcVehicle(
                id=f"npc{number}",
                model="vehicle.audi.tt",
                route=tuple(way[first : first + _NPC_WAYPOINTS]),
                behavior=NpcBehavior.REACTIVE,
            )
        )
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
