"""The waypoints of an NPC vehicle: places on its path or beside it, and what lies between them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from drivora_service.networks.routes.route_line import QuickChange
from drivora_service.scenario.checks.route_checks import JOIN_DISTANCE
from drivora_service.scenario.model import Waypoint
from drivora_service.search.space.driven_path import DrivenPath

LEAST_STEP = 2.0
"""Least distance between waypoints, metres."""
CHANGE_ROOM = 12.0
"""Metres that a waypoint on the neighbouring lane keeps from the waypoints before and behind it,
and from the ends of its lane, so that it can be reached and left on the way."""
_TIME_DIGITS = 3
_TURN = 1.3
"""Ratio of lengths up to which a straight line may stand for a path."""
_REPLAY_SPACING = 4.0
"""Metres between the waypoints of a vehicle that follows straight lines between them."""
_QUICK_SPACING = 1.0
"""The same during a quick lane change, whose corners would slow the vehicle down."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """A planned waypoint.

    Attributes:
        s: Arc length on the path, metres.
        side: The lane: -1 to the right, 0 the path's own, 1 to the left.
        speed: Desired speed, m/s.
        wait: Seconds for which the vehicle stands there.
    """

    s: float
    side: int
    speed: float
    wait: float = 0.0


def has_room_beside(path: DrivenPath, s: float, side: int) -> bool:
    """Returns whether a waypoint on the lane to the side can be reached and left again."""
    if side == 0:
        return False
    index, low, high = path.lane_ranges[path.range_at(s)]
    lane = path.network.lanes[index]
    if (lane.left if side > 0 else lane.right) < 0:
        return False
    return low + CHANGE_ROOM <= s <= high - CHANGE_ROOM


def place_beside(path: DrivenPath, s: float, side: int) -> float | None:
    """Returns the place nearest to ``s`` on its lane with room on the lane to the side, if any."""
    _, low, high = path.lane_ranges[path.range_at(s)]
    place = min(max(s, low + CHANGE_ROOM), high - CHANGE_ROOM)
    return place if has_room_beside(path, place, side) else None


def _offset(path: DrivenPath, stop: Stop) -> float:
    """Returns the metres to the left of the path at which a waypoint lies."""
    if stop.side == 0:
        return 0.0
    own = path.network.lanes[path.lane_ranges[path.range_at(stop.s)][0]]
    other = path.network.lanes[own.left if stop.side > 0 else own.right]
    return stop.side * 0.5 * (own.width + other.width)


def make_planned_waypoints(
    path: DrivenPath, stops: Sequence[Stop], allowed: Callable[[float, float], float]
) -> tuple[Waypoint, ...]:
    """Returns waypoints between which the planner reproduces the path.

    Args:
        path: Their path.
        stops: The waypoints placed by genes.
        allowed: Returns the speed at an arc length, given the desired one.
    """
    route = [_waypoint(path, stops[0])]
    for before, stop in pairwise(stops):
        route.extend(
            path.at(s).waypoint(allowed(s, stop.speed)) for s in _ties(path, before.s, stop.s)
        )
        route.append(_waypoint(path, stop))
    return tuple(route)


def _ties(path: DrivenPath, begin: float, end: float) -> list[float]:
    """Returns the places to pass between two waypoints, so that the path is unique.

    For waypoints on roads that are not adjacent, it is the middle of the longest road between them;
    for waypoints so near to one another that a straight line would join them although the path
    turns, the middle of the turn.
    """
    first, last = path.range_at(begin), path.range_at(end)
    roads = [
        (high - low, 0.5 * (low + high))
        for lane, low, high in path.lane_ranges[first + 1 : last]
        if not path.network.lanes[lane].is_internal
    ]
    if roads:
        return [max(roads)[1]]
    here, there = path.at(begin), path.at(end)
    straight = math.hypot(there.x - here.x, there.y - here.y)
    if straight <= JOIN_DISTANCE and end - begin > _TURN * straight + LEAST_STEP:
        return [0.5 * (begin + end)]
    return []


def make_replay_waypoints(
    path: DrivenPath, stops: Sequence[Stop], change: Callable[[float], QuickChange] | None
) -> tuple[Waypoint, ...]:
    """Returns waypoints so near to one another that straight lines between them follow the path.

    Args:
        path: Their path.
        stops: The waypoints placed by genes.
        change: Returns the lane changes at a speed; ``None``: each takes the whole way between two
            waypoints.
    """
    route = [_waypoint(path, stops[0])]
    for before, stop in pairwise(stops):
        here, there = _offset(path, before), _offset(path, stop)
        way, spacing = stop.s - before.s, _REPLAY_SPACING
        length = way
        if change is not None and here != there:
            length = min(change(stop.speed).length(abs(there - here)), way)
            spacing = _QUICK_SPACING
        count = max(math.ceil(way / spacing), 1)
        for step in range(1, count + 1):
            share = step / count
            done = share if length == way else min(share * way / length, 1.0)
            aside = here + (there - here) * 0.5 * (1.0 - math.cos(math.pi * done))
            s = before.s + share * way
            last = step == count
            route.append(
                _add_wait(path.at(s).beside(aside).waypoint(stop.speed), stop.wait if last else 0.0)
            )
    return tuple(route)


def _waypoint(path: DrivenPath, stop: Stop) -> Waypoint:
    return _add_wait(path.at(stop.s).beside(_offset(path, stop)).waypoint(stop.speed), stop.wait)


def _add_wait(waypoint: Waypoint, wait: float) -> Waypoint:
    return replace(waypoint, wait=round(wait, _TIME_DIGITS)) if wait > 0.0 else waypoint
