"""Planning a route along lanes through places given as points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from drivora_service.errors import NoRoute
from drivora_service.networks.lane_graph import LaneGraph, lane_graph
from drivora_service.networks.lane_route import LaneRoute
from drivora_service.networks.projection import lane_positions_near
from drivora_service.networks.road_network import LanePosition, RoadNetwork
from drivora_service.networks.route_line import build_route
from drivora_service.networks.route_search import Candidate, EdgePass, search

MAX_DISTANCE = 20.0
"""Metres from a point to the nearest drivable lane."""

CANDIDATE_MARGIN = 4.0
"""Metres by which a lane may be further away than the nearest and still be meant."""

ON_LANE_MARGIN = 0.2
"""Metres beside a lane that still count as on it."""

DISTANCE_COST = 20.0
"""Metres of detour that are worth one metre between the point and the lane."""

HEADING_COST = 300.0
"""Metres of detour that are worth a right angle between the point's and the lane's direction."""

OFF_LANE_COST = 500.0
"""Metres of detour that are worth leaving the road that the point is on. On the same edge a start
is never moved to another lane, while a later point may be passed in the lane beside it."""

MAX_EXTRA_COST = 600.0
"""Metres by which a lane may cost more than the cheapest for its point; a dearer one, such as the
opposite lane of a point with a heading, is not meant even where no other is reachable."""

MIN_LENGTH = 0.1
"""Metres; a shorter way is none, and the route goes around instead."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RoutePoint:
    """A place to pass: metres, and the wanted heading in radians where it is known."""

    x: float
    y: float
    yaw: float | None = None


_SHORT = 20.0
"""Metres below which a way may turn out to be none when it is drawn."""


def plan_route(network: RoadNetwork, points: Sequence[RoutePoint]) -> LaneRoute:
    """Plans the shortest route along drivable lanes that passes points in order.

    A point stands for the nearest lane position; where several lanes are near (in a junction, or
    between lanes) for the one that makes the whole route cheapest in metres, where lane changes,
    distance from the point and a heading that disagrees cost extra. A point up to a metre behind
    the one before counts as reached. Where the destination is the start, or just behind it, the
    route goes around.

    Args:
        network: The network.
        points: Start, places to pass, destination; at least two.

    Raises:
        NoRoute: A point is too far from every lane or cannot be reached from the one before.

    Returns:
        The route. It is shared by all callers with the same points, and read-only.
    """
    return _plan(network, tuple(points))


def check_way(network: RoadNetwork, points: Sequence[RoutePoint]) -> None:
    """Checks that :func:`plan_route` finds a way, in half the time since it is not drawn.

    Raises:
        NoRoute: Whenever ``plan_route`` does.
    """
    places = tuple(points)
    if _length(_find_way(network, places)) < _SHORT:
        _plan(network, places)


@lru_cache(maxsize=512)
def _plan(network: RoadNetwork, points: tuple[RoutePoint, ...]) -> LaneRoute:
    """Plans a route once: batches and searches ask for the same places again and again."""
    route = build_route(network, _find_way(network, points))
    if len(route.line) < 2:
        raise NoRoute(
            f"the {len(points)} points of the route are the same place on network "
            f"{network.name!r}: there is nothing to drive; move one of them"
        )
    return route


@lru_cache(maxsize=2048)
def _find_way(network: RoadNetwork, points: tuple[RoutePoint, ...]) -> tuple[EdgePass, ...]:
    if len(points) < 2:
        raise NoRoute(f"a route needs a start and a destination, but has {len(points)} point(s)")
    graph = lane_graph(network)
    places = [_candidates(network, points, number) for number in range(len(points))]
    way = search(graph, places)
    if not isinstance(way, int) and _length(way) < MIN_LENGTH:
        way = _around(graph, places)
    if isinstance(way, int):
        raise NoRoute(
            f"{_named(points, way)} cannot be reached from {_named(points, way - 1)} on network "
            f"{network.name!r}: no drivable way leads there; move one of them, or check that they "
            "lie on the side of the road that leads that way"
        )
    return way


def _candidates(
    network: RoadNetwork, points: Sequence[RoutePoint], number: int
) -> tuple[Candidate, ...]:
    """Gives the lane positions that a point may stand for."""
    point = points[number]
    if not (math.isfinite(point.x) and math.isfinite(point.y)):
        raise NoRoute(f"{_named(points, number)} is not a place: coordinates must be finite")
    near = _positions_near(network, point.x, point.y)
    if not near:
        raise NoRoute(
            f"{_named(points, number)} is more than {MAX_DISTANCE:g} m from every drivable lane "
            f"of network {network.name!r}; move it onto a lane"
        )
    nearest = abs(near[0].lateral)
    near = tuple(p for p in near if abs(p.lateral) <= nearest + CANDIDATE_MARGIN)
    on_lane = [p for p in near if _is_on(network, p)] or [near[0]]
    taken = {network.lanes[p.lane].edge_id for p in on_lane}
    candidates = []
    for position in near:
        cost = DISTANCE_COST * (abs(position.lateral) - nearest)
        if point.yaw is not None:
            cost += HEADING_COST * (1.0 - math.cos(position.heading - point.yaw))
        if position not in on_lane:
            beside = network.lanes[position.lane].edge_id in taken
            if beside and number == 0:
                continue
            cost += 0.0 if beside else OFF_LANE_COST
        candidates.append(Candidate(lane=position.lane, s=position.s, cost=cost))
    limit = min(candidate.cost for candidate in candidates) + MAX_EXTRA_COST
    return tuple(candidate for candidate in candidates if candidate.cost <= limit)


@lru_cache(maxsize=4096)
def _positions_near(network: RoadNetwork, x: float, y: float) -> tuple[LanePosition, ...]:
    """Gives the lane positions near a place: it ends one leg of a route and begins the next."""
    return lane_positions_near(network, x, y, max_distance=MAX_DISTANCE)


def _is_on(network: RoadNetwork, position: LanePosition) -> bool:
    return abs(position.lateral) <= 0.5 * network.lanes[position.lane].width + ON_LANE_MARGIN


def _around(graph: LaneGraph, places: Sequence[Sequence[Candidate]]) -> tuple[EdgePass, ...] | int:
    """Finds a way around where all places are as good as one; see :func:`search`."""
    last = len(places) - 1
    for start in sorted(places[0], key=lambda candidate: candidate.cost):
        ends = [candidate for candidate in places[last] if candidate.lane == start.lane]
        way = search(graph, [[start], ends], around=True) if ends else last
        if not isinstance(way, int):
            return way
    return last


def _length(way: Sequence[EdgePass]) -> float:
    """Gives the length of a way without lane changes in metres; one with a change is longer."""
    if any(one.lane != one.exit_lane for one in way):
        return math.inf
    return sum(one.exit_s - one.s for one in way)


def _named(points: Sequence[RoutePoint], number: int) -> str:
    point = points[number]
    kind = "start" if number == 0 else "destination" if number == len(points) - 1 else "point"
    return f"{kind} {number} at ({point.x:.2f}, {point.y:.2f})"
