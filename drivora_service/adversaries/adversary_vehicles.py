"""Vehicles that an adversary adds: where they start relative to the ego, and how they drive.

All are reactive NPC vehicles, which brake for actors ahead. Their ways follow the ego's route, on
its lane or a neighbouring one, or a path that crosses it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from drivora_service.adversaries.adversary_situation import Situation
from drivora_service.errors import SearchError
from drivora_service.geometry import elementary
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.runs.adversary import Action
from drivora_service.scenario.model import NpcVehicle, Region, Waypoint
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.relations import Relation
from drivora_service.search.space.vehicles.npc_paths import find_npc_paths

MODEL = "vehicle.tesla.model3"
_SPACING = 5.0
"""Metres between waypoints; nearer than where the way would be planned along the lanes."""
_LEAST_WAY = 6.0
"""Metres that a vehicle must be able to drive."""
_LEAST_SPEED = 5.0
"""m/s with which speeds relative to a slow ego are reckoned."""
_CROSSING_SPEED = 9.0
_CROSSING_REACH = (10.0, 90.0)
"""Metres ahead of the ego within which another path crosses its route."""
_APPROACH = 12.0
"""Least metres that a crossing vehicle drives before it meets the ego's route."""
_PATHS = 24
_MEETING = 1.6
"""Metres between two lines that meet."""
_ANGLE = math.cos(math.radians(30.0))
"""Cosine of the angle from which on two paths cross."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """A part of a vehicle's way.

    Attributes:
        length: Metres along the ego's route.
        side: Share of the way to the neighbouring lane at its end: 1 left, -1 right, 0 none.
        speed: m/s, as a factor of the ego's speed and a summand.
    """

    length: float
    side: float
    speed: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manoeuvre:
    """A vehicle's start and way relative to the ego.

    Attributes:
        ahead: Start ahead of the ego's centre: metres, and seconds at the ego's speed.
        side: Lane of the start: 0 the ego's, 1 the one to the left, -1 to the right.
        legs: Its way.
    """

    ahead: tuple[float, float]
    side: int
    legs: tuple[Leg, ...]


def _cut_in(side: int) -> Manoeuvre:
    return Manoeuvre(
        ahead=(7.0, 0.2),
        side=side,
        legs=(
            Leg(length=10.0, side=side, speed=(1.15, 1.0)),
            Leg(length=15.0, side=0.0, speed=(1.0, 0.0)),
            Leg(length=90.0, side=0.0, speed=(0.4, 0.0)),
        ),
    )


MANOEUVRES = {
    Action.VEHICLE_BRAKES: Manoeuvre(
        ahead=(9.0, 0.8),
        side=0,
        legs=(
            Leg(length=15.0, side=0.0, speed=(1.0, 0.0)),
            Leg(length=30.0, side=0.0, speed=(0.0, 0.5)),
        ),
    ),
    Action.VEHICLE_SLOW: Manoeuvre(
        ahead=(10.0, 1.5), side=0, legs=(Leg(length=120.0, side=0.0, speed=(0.35, 0.0)),)
    ),
    # It leaves after 20 s: one that stayed would only end the ego's part.
    Action.VEHICLE_STANDS: Manoeuvre(
        ahead=(12.0, 2.5), side=0, legs=(Leg(length=6.0, side=0.0, speed=(0.0, 0.3)),)
    ),
    Action.VEHICLE_CUTS_IN_LEFT: _cut_in(1),
    Action.VEHICLE_CUTS_IN_RIGHT: _cut_in(-1),
    Action.VEHICLE_FOLLOWS: Manoeuvre(
        ahead=(-10.0, -0.5), side=0, legs=(Leg(length=150.0, side=0.0, speed=(1.3, 1.0)),)
    ),
}
"""Vehicles on the ego's road."""


def vehicle_on_route(situation: Situation, manoeuvre: Manoeuvre, name: str) -> NpcVehicle | None:
    """Returns the vehicle of a manoeuvre; ``None`` where the road has no place for it."""
    speed = max(situation.ego.speed, _LEAST_SPEED)
    start = situation.arc + manoeuvre.ahead[0] + manoeuvre.ahead[1] * situation.ego.speed
    room = situation.path.length - start
    if start < 0.0 or room < _LEAST_WAY:
        return None
    route: list[Waypoint] = []
    at, side = start, float(manoeuvre.side)
    for leg in manoeuvre.legs:
        wanted = leg.speed[0] * speed + leg.speed[1]
        count = max(round(min(leg.length, situation.path.length - at) / _SPACING), 1)
        shares = np.linspace(0.0, 1.0, count + 1)
        for share in (shares if not route else shares[1:]).tolist():
            place = at + share * leg.length
            if place > situation.path.length:
                break
            # On the way to the ego's lane, a share of the distance between the two lanes.
            now = side + share * (leg.side - side)
            beside = _offset(situation, place, manoeuvre.side if now else 0)
            if beside is None:
                return None
            lateral = beside * abs(now)
            route.append(situation.path.at(place).beside(lateral).waypoint(wanted))
        at, side = at + leg.length, leg.side
    return _vehicle(name, route)


def _offset(situation: Situation, arc: float, side: int) -> float | None:
    """Returns the metres to the left from the route to a lane beside it; ``None`` if none."""
    if side == 0:
        return 0.0
    lane = situation.neighbour(arc, side)
    if lane is None:
        return None
    return side * 0.5 * (situation.lane_at(arc).width + lane.width)


def vehicle_across(situation: Situation, name: str) -> NpcVehicle | None:
    """Returns a vehicle that meets the ego where its path crosses the route; ``None``: no path."""
    least, most = _CROSSING_REACH
    ahead = [
        crossing
        for crossing in _crossings(situation.network, situation.path, situation.region)
        if least <= crossing.on_route - situation.arc <= most
    ]
    if not ahead:
        return None
    crossing = min(ahead, key=lambda one: one.on_route)
    seconds = (crossing.on_route - situation.arc) / max(situation.ego.speed, _LEAST_SPEED)
    # Where its path is too short for the time, it joins later.
    start = max(crossing.on_path - _CROSSING_SPEED * seconds, 0.0)
    wait = seconds - (crossing.on_path - start) / _CROSSING_SPEED
    end = min(crossing.on_path + 60.0, crossing.path.length)
    count = max(round((end - start) / _SPACING), 1)
    places = np.linspace(start, end, count + 1).tolist()
    route = [crossing.path.at(place).waypoint(_CROSSING_SPEED) for place in places]
    return _vehicle(name, route, start_time=round(situation.time + wait, 2) if wait > 0.1 else 0.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Crossing:
    """A place where a path crosses the ego's route.

    Attributes:
        on_route: Metres along the route.
        on_path: Metres along the path.
    """

    path: DrivenPath
    on_route: float
    on_path: float


@lru_cache(maxsize=64)
def _crossings(
    network: RoadNetwork, route: DrivenPath, region: Region | None
) -> tuple[_Crossing, ...]:
    """Returns the first crossing of each path around a route."""
    try:
        paths = find_npc_paths(network, [route], reach=80.0, count=_PATHS, region=region)
    except SearchError:
        return ()
    found = (
        _first_crossing(route, one.path)
        for one in paths
        if one.relation in (Relation.CROSSING, Relation.MERGING)
    )
    return tuple(one for one in found if one is not None)


def _first_crossing(route: DrivenPath, path: DrivenPath) -> _Crossing | None:
    gaps = np.hypot(*(route.line[:, None] - path.line[None]).transpose(2, 0, 1))
    here, there = np.nonzero(gaps <= _MEETING)
    cosines = elementary.cos(route.yaw[here] - path.yaw[there])
    crosses = (cosines < _ANGLE) & (path.arc[there] >= _APPROACH)
    if not crosses.any():
        return None
    k = int(np.flatnonzero(crosses)[0])
    return _Crossing(
        path=path, on_route=float(route.arc[here[k]]), on_path=float(path.arc[there[k]])
    )


def _vehicle(name: str, route: Sequence[Waypoint], *, start_time: float = 0.0) -> NpcVehicle:
    return NpcVehicle(id=name, model=MODEL, route=tuple(route), start_time=start_time)
