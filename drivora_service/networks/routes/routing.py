"""Planning of routes along lanes through points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

from drivora_service.errors import NoRoute
from drivora_service.networks.projection import lane_positions_near
from drivora_service.networks.road_network import LanePosition, RoadNetwork
from drivora_service.networks.routes.lane_graph import LaneGraph, lane_graph
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.route_line import QuickChange, build_route
from drivora_service.networks.routes.route_matching import (
    MIN_TRACK,
    Place,
    RouteMatch,
    match_places,
)
from drivora_service.networks.routes.route_search import Candidate, EdgePass, Way, search
from drivora_service.networks.routes.tight_turns import tight_turns

MAX_DISTANCE = 20.0
"""Maximum distance of a point from the nearest drivable lane, metres."""

CANDIDATE_MARGIN = 4.0
"""Metres by which a candidate lane may be further away than the nearest."""

WIDE_MARGIN = 8.0
"""The same limit if the nearer lanes cost a detour, for all lanes of an edge with such a lane. It
does not apply to a start, where the ego stands."""

ON_LANE_MARGIN = 0.2
"""Metres beside a lane that count as on it."""

DISTANCE_COST = 20.0
"""Cost of one metre between the point and the lane, metres of detour."""

HEADING_COST = 300.0
"""Cost of a right angle between the point's and the lane's direction, metres of detour."""

SHIFT_COST = 2.0
"""Cost of one metre between a point's lane and the lane of the same edge in which it is passed,
if nearer lanes cost a detour; metres of detour."""

OFF_LANE_COST = 500.0
"""Cost of leaving the road of the point, metres of detour. On the same edge a start
is never moved to another lane, while a later point may be passed in an adjacent lane."""

MAX_EXTRA_COST = 600.0
"""Metres by which a lane may cost more than the cheapest for its point; a costlier one, such as the
opposite lane of a point with a heading, is no candidate even if no other is reachable: that costs
twice ``HEADING_COST``, as 1 - cos(pi) is 2."""

MIN_LENGTH = 0.1
"""Metres; instead of a shorter way, the route goes around."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RoutePoint:
    """A point of a route: metres, and the desired heading in radians if it is known."""

    x: float
    y: float
    yaw: float | None = None


_SHORT = 20.0
"""Length below which a way may turn out to be too short in its geometry, metres."""


def plan_route(
    network: RoadNetwork, points: Sequence[RoutePoint], change: QuickChange | None = None
) -> LaneRoute:
    """Plans the shortest route along drivable lanes that passes points in order.

    A point is matched to the nearest lane position; if several lanes are near (in a junction, or
    between lanes), to the one that makes the whole route cheapest in metres, with extra costs of
    lane changes, distance from the point and a different heading. If that costs a lap, a point
    is passed in another lane of its edge, or is omitted (:mod:`route_matching`). A point up to a
    metre behind the preceding one counts as reached. If the destination is the start, or just
    behind it, the route goes around.

    Args:
        network: The network.
        points: Start, intermediate points, destination; at least two.
        change: How lanes are changed; ``None``: in a fixed time.

    Raises:
        NoRoute: A point is too far from all lanes or cannot be reached from the preceding one.

    Returns:
        The route. It is read-only and shared by all callers with the same points.
    """
    return _plan(network, tuple(points), change)


def match_route(network: RoadNetwork, points: Sequence[RoutePoint]) -> RouteMatch:
    """Returns the match of :func:`plan_route`: the legs, and the omitted points.

    Raises:
        NoRoute: As ``plan_route``, except for a route without length.
    """
    return _find_way(network, tuple(points))


def check_way(network: RoadNetwork, points: Sequence[RoutePoint]) -> None:
    """Checks that :func:`plan_route` finds a way; twice as fast, without geometry.

    Raises:
        NoRoute: As ``plan_route``.
    """
    places = tuple(points)
    if _length(_find_way(network, places).passes) < _SHORT:
        _plan(network, places, None)


@lru_cache(maxsize=512)
def _plan(
    network: RoadNetwork, points: tuple[RoutePoint, ...], change: QuickChange | None
) -> LaneRoute:
    """Plans a route; cached, since batches and searches repeat the same places."""
    route = build_route(network, _find_way(network, points).passes, change)
    if len(route.line) < 2:
        raise NoRoute(
            f"the {len(points)} points of the route are the same place on network "
            f"{network.name!r}: there is nothing to drive; move one of them"
        )
    return route


@lru_cache(maxsize=2048)
def _find_way(network: RoadNetwork, points: tuple[RoutePoint, ...]) -> RouteMatch:
    if len(points) < 2:
        raise NoRoute(f"a route needs a start and a destination, but has {len(points)} point(s)")
    places = [_place(network, points, number) for number in range(len(points))]
    match = match_places(network, places)
    if not isinstance(match, int) and _length(match.passes) < MIN_LENGTH:
        around = _around(lane_graph(network), [place.named for place in places])
        match = around if isinstance(around, int) else replace(match, passes=around.passes)
    if isinstance(match, int):
        raise NoRoute(
            f"{_describe_point(points, match)} cannot be reached from "
            f"{_describe_point(points, match - 1)} on network {network.name!r}: no "
            f"drivable way leads there; move one of them, or check that they lie on the side "
            f"of the road that leads that way{_turn_hint(network)}"
        )
    return match


def _turn_hint(network: RoadNetwork) -> str:
    if not tight_turns(network):
        return ""
    return (
        "; a turn that is tighter than a car can drive is used only between two waypoints, one on "
        "the road before it and one on the road behind it"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _NearLane:
    """A lane position that a point may be matched to, with the costs that only the place decides.

    Attributes:
        lane: Index of the lane.
        s: Arc length, metres.
        heading: Direction of the lane, radians.
        aside: Metres by which it is further away than the nearest lane.
        off_cost: Cost of leaving the road of the point.
        passing_cost: Cost of being passed in this lane.
        may_start: Whether an ego that stands at the point may start on it.
    """

    lane: int
    s: float
    heading: float
    aside: float
    off_cost: float
    passing_cost: float
    may_start: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class _Surroundings:
    """The lane positions of a point, the nearest first, and whether it is on a lane."""

    near: tuple[_NearLane, ...]
    on_road: bool


def _place(network: RoadNetwork, points: Sequence[RoutePoint], number: int) -> Place:
    """Returns the possible lane positions of a point."""
    point = points[number]
    if not (math.isfinite(point.x) and math.isfinite(point.y)):
        raise NoRoute(
            f"{_describe_point(points, number)} is not a place: coordinates must be finite"
        )
    surroundings = _surroundings(network, point.x, point.y)
    if not surroundings.near:
        raise NoRoute(
            f"{_describe_point(points, number)} is more than {MAX_DISTANCE:g} m from every "
            f"drivable lane of network {network.name!r}; move it onto a lane"
        )
    around = _around_point(points, number)
    named, beside, passed = [], [], []
    for one in surroundings.near:
        if number == 0 and not one.may_start:
            continue
        turned = 0.0
        if point.yaw is not None:
            turned = HEADING_COST * (1.0 - math.cos(one.heading - point.yaw))
        cost = DISTANCE_COST * one.aside + turned + one.off_cost
        candidate = Candidate(lane=one.lane, s=one.s, cost=cost)
        beside.append(candidate)
        if one.aside <= CANDIDATE_MARGIN:
            named.append(candidate)
        passing_cost = one.passing_cost + min(turned + one.off_cost, around)
        if passing_cost != cost:
            candidate = Candidate(lane=one.lane, s=one.s, cost=passing_cost)
        passed.append(candidate)
    return Place(
        x=point.x,
        y=point.y,
        named=_cheap(named),
        beside=tuple(beside),
        near=_cheap(passed),
        on_road=surroundings.on_road,
    )


def _cheap(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Omits lanes that cost more than the cheapest by more than ``MAX_EXTRA_COST``."""
    limit = min([candidate.cost for candidate in candidates]) + MAX_EXTRA_COST
    return tuple([candidate for candidate in candidates if candidate.cost <= limit])


def _around_point(points: Sequence[RoutePoint], number: int) -> float:
    """Returns the length of the polyline from the preceding to the following point, metres.

    The road and the heading of one point in a dense track count less than those of points
    far apart. Those of a start, of a destination and of the points of a short list count fully.
    """
    if number in (0, len(points) - 1) or len(points) < MIN_TRACK:
        return math.inf
    neighbours = points[number - 1 : number + 2]
    return sum(math.hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(neighbours))


@lru_cache(maxsize=4096)
def _surroundings(network: RoadNetwork, x: float, y: float) -> _Surroundings:
    """Returns the lane positions around a place; cached, as it belongs to two legs of a route."""
    positions = lane_positions_near(network, x, y, max_distance=MAX_DISTANCE)
    on_lane = [position for position in positions if _is_on(network, position)]
    own = on_lane or positions[:1]
    starts = {position.lane for position in own}
    taken = {network.lanes[position.lane].edge_id for position in own}
    near: list[_NearLane] = []
    wide: dict[str, float] = {}
    for position in positions:
        edge, distance = network.lanes[position.lane].edge_id, abs(position.lateral)
        nearest = abs(positions[0].lateral)
        # The nearest come first: of an edge that counts, the nearest lane is known by now.
        if distance <= nearest + WIDE_MARGIN:
            wide.setdefault(edge, distance)
        elif edge not in wide:
            continue
        aside = distance - nearest
        passing_cost = DISTANCE_COST * (wide[edge] - nearest)
        passing_cost += SHIFT_COST * (distance - wide[edge])
        near.append(
            _NearLane(
                lane=position.lane,
                s=position.s,
                heading=position.heading,
                aside=aside,
                off_cost=0.0 if edge in taken else OFF_LANE_COST,
                passing_cost=passing_cost,
                may_start=aside <= CANDIDATE_MARGIN
                and (position.lane in starts or edge not in taken),
            )
        )
    return _Surroundings(near=tuple(near), on_road=bool(on_lane))


def _is_on(network: RoadNetwork, position: LanePosition) -> bool:
    return abs(position.lateral) <= 0.5 * network.lanes[position.lane].width + ON_LANE_MARGIN


def _around(graph: LaneGraph, places: Sequence[Sequence[Candidate]]) -> Way | int:
    """Finds a way around if all places coincide; see :func:`search`."""
    last = len(places) - 1
    for start in sorted(places[0], key=lambda candidate: candidate.cost):
        ends = [candidate for candidate in places[last] if candidate.lane == start.lane]
        way = search(graph, [[start], ends], around=True) if ends else last
        if not isinstance(way, int):
            return way
    return last


def _length(way: Sequence[EdgePass]) -> float:
    """Returns the length of a way without lane changes in metres; one with a change is longer."""
    if any(one.lane != one.exit_lane for one in way):
        return math.inf
    return sum(one.exit_s - one.s for one in way)


def _describe_point(points: Sequence[RoutePoint], number: int) -> str:
    point = points[number]
    kind = "start" if number == 0 else "destination" if number == len(points) - 1 else "point"
    return f"{kind} {number} at ({point.x:.2f}, {point.y:.2f})"
