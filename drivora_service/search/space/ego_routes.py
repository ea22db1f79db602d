"""Routes of egos: the seed's own, and others near it that conflict with one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drivora_service.errors import SearchError
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import plan_route
from drivora_service.scenario.checks.route_checks import route_points
from drivora_service.scenario.model import EgoVehicle, Scenario, Waypoint
from drivora_service.search.space.driven_path import DrivenPath, plan_walk, walk_points
from drivora_service.search.space.lane_walks import LaneWalk
from drivora_service.search.space.relations import Relation
from drivora_service.search.space.roadside import Roadside
from drivora_service.search.space.space_options import SpaceOptions
from drivora_service.search.space.walk_choice import find_walks, take_in_turns

MOST_ROUTES = 12
"""Greatest number of routes that several egos choose from."""
_LEAST_SHARE = 0.6
"""Least length of another route, as a share of the length of the seed's."""
_TURNS = (
    Relation.CROSSING,
    Relation.MERGING,
    Relation.ONCOMING,
    Relation.CROSSING,
    Relation.MERGING,
    Relation.LEADING,
    Relation.TRAILING,
    Relation.BESIDE,
)
"""Order of taking routes by their relation to the seed's: conflicting ones twice."""
_START_SHARE = 0.25
_START_ROOM = 30.0
"""Greatest move of an ego's start along its route, metres."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EgoRoute:
    """A route that an ego may have.

    Attributes:
        path: The path.
        waypoints: Start, waypoints between, and destination.
        room: Metres from the beginning within which it may start.
        roadside: Places beside it.
    """

    path: DrivenPath
    waypoints: tuple[Waypoint, ...]
    room: float
    roadside: Roadside

    def from_start(self, s: float) -> tuple[Waypoint, ...]:
        """Returns the waypoints of the route from arc length ``s`` (at most ``room``) on."""
        if s <= 0.0:
            return self.waypoints
        return (self.path.at(s).waypoint(), *self.waypoints[1:])


def routes_of_egos(
    seed: Scenario, network: RoadNetwork, options: SpaceOptions
) -> tuple[EgoRoute, ...]:
    """Returns the routes that the egos of a space may have, the seed's own first.

    Raises:
        SearchError: One of the seed's has no place for a requested walker or obstacle, or there is
            none for a further ego.
    """
    own = tuple(_seed_route(network, ego) for ego in seed.ego_vehicles)
    for ego, route in zip(seed.ego_vehicles, own, strict=True):
        missing = _describe_missing_place(route, options)
        if missing:
            raise SearchError(
                f"the route of ego {ego.id!r}, {route.path.length:.0f} m long, {missing}; use a "
                "seed scenario with a longer route"
            )
    if options.egos == 1:
        return own
    others = _further_routes(seed, network, [route.path for route in own], options)
    if not others:
        raise SearchError(
            f"no route for a further ego was found on {network.name!r} within {options.reach:g} m "
            "of the seed's and in its region; raise `reach`, use one ego, or choose another seed "
            "scenario"
        )
    return own + others


def _describe_missing_place(route: EgoRoute, options: SpaceOptions) -> str:
    """Returns what a route lacks; "" if nothing."""
    if options.walkers and not len(route.roadside.crossings):
        return "leads nowhere along a road that a walker can cross: use no walkers"
    if options.obstacles and not len(route.roadside.straights):
        return "is nowhere straight, with no place for an obstacle: use no obstacles"
    return ""


def _seed_route(network: RoadNetwork, ego: EgoVehicle) -> EgoRoute:
    """Returns an ego's own route."""
    path = DrivenPath(network, plan_route(network, route_points(ego.route)))
    return _route(path, ego.route)


def _further_routes(
    seed: Scenario, network: RoadNetwork, own: Sequence[DrivenPath], options: SpaceOptions
) -> tuple[EgoRoute, ...]:
    """Returns routes besides the seed's.

    They begin near one of the seed's, are as long as the seed's longest, and as many as possible
    cross it or merge with it.
    """
    length = max(path.length for path in own)
    walks = find_walks(network, own, reach=options.reach, length=length, most=2 * MOST_ROUTES)

    def route(walk: LaneWalk, _relation: Relation) -> EgoRoute | None:
        planned = plan_walk(network, walk)
        if planned is None or planned.length < _LEAST_SHARE * length:
            return None
        if not planned.is_within(seed.map_region.region_segment):
            return None
        waypoints = tuple(
            Waypoint(x=point.x, y=point.y, yaw=point.yaw) for point in walk_points(network, walk)
        )
        made = _route(planned, waypoints)
        return None if _describe_missing_place(made, options) else made

    return take_in_turns(walks, _TURNS, max(MOST_ROUTES - len(own), 1), route)


def _route(path: DrivenPath, waypoints: tuple[Waypoint, ...]) -> EgoRoute:
    return EgoRoute(
        path=path, waypoints=waypoints, room=_room(path, waypoints), roadside=Roadside(path)
    )


def _room(path: DrivenPath, waypoints: Sequence[Waypoint]) -> float:
    """Returns the metres by which the start may move: on the first road, up to the waypoint."""
    room = min(_START_ROOM, _START_SHARE * path.length)
    first = path.route.runs[0]
    if len(path.route.runs) > 1:
        room = min(room, first.change_from - first.start_s)
    if len(waypoints) > 2:
        following, _ = path.place_of(waypoints[1].x, waypoints[1].y)
        room = min(room, 0.5 * following)
    inside = path.in_junction
    if inside.any():
        room = min(room, max(float(path.arc[inside][0]) - 1.0, 0.0))
    return max(room, 0.0)
