"""Pedestrians that an adversary adds: they cross the ego's road ahead of it."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.adversaries.adversary_situation import Situation
from drivora_service.networks.road_network import Lane
from drivora_service.runs.adversary import Action
from drivora_service.scenario.model import NpcWalker

MODEL = "walker.pedestrian.0001"
_VERGE = 0.8
"""Metres beside the outermost lane at which a walker starts and ends."""
_NEAREST = 6.0
"""Least metres ahead of the ego's centre."""
_LEAST_SPEED = 3.0
"""m/s with which the way of a slow ego is reckoned."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """A walk across the road.

    Attributes:
        side: Side of the start: 1 left, -1 right.
        speed: m/s.
        lead: Seconds by which the walker is on the middle of the ego's lane before the ego is.
    """

    side: int
    speed: float
    lead: float


CROSSINGS = {
    Action.WALKER_RIGHT: Crossing(side=-1, speed=1.4, lead=0.5),
    Action.WALKER_LEFT: Crossing(side=1, speed=1.4, lead=0.5),
    Action.RUNNER_RIGHT: Crossing(side=-1, speed=3.0, lead=0.0),
    Action.RUNNER_LEFT: Crossing(side=1, speed=3.0, lead=0.0),
}


def walker_across(situation: Situation, crossing: Crossing, name: str) -> NpcWalker | None:
    """Returns the walker of a crossing; ``None`` if the route ends before."""
    right, left = _edges(situation)
    begin, end = (left, right) if crossing.side > 0 else (right, left)
    seconds = abs(begin) / crossing.speed + crossing.lead
    ahead = max(max(situation.ego.speed, _LEAST_SPEED) * seconds, _NEAREST)
    if situation.arc + ahead > situation.path.length:
        return None
    place = situation.path.at(situation.arc + ahead)
    route = tuple(place.beside(lateral).waypoint(crossing.speed) for lateral in (begin, end))
    return NpcWalker(id=name, model=MODEL, route=route)


def _edges(situation: Situation) -> tuple[float, float]:
    """Returns the metres to the left of the route at which the road ends, right and left.

    To the left of the lanes of the ego's direction there is one of the other direction.
    """
    lane = situation.lane
    half = 0.5 * lane.width
    right = half + _width(situation, lane, -1) + _VERGE
    left = half + _width(situation, lane, 1) + lane.width + _VERGE
    return -right, left


def _width(situation: Situation, lane: Lane, side: int) -> float:
    """Returns the metres of all lanes to a side of a lane."""
    total = 0.0
    while (index := lane.left if side > 0 else lane.right) >= 0:
        lane = situation.network.lanes[index]
        total += lane.width
    return total
