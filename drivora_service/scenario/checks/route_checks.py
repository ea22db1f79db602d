"""Checks that all routes are drivable, by the rules of the episode.

An ego's route is planned through all its waypoints. A reactive NPC connects waypoints more than
``JOIN_DISTANCE`` apart along the lanes and nearer ones by straight lines. A replayed NPC uses its
waypoints as they are. An NPC driven by SUMO needs a start on a lane outside junctions and a route
through all its waypoints.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from drivora_service.errors import NoRoute, Problem
from drivora_service.networks.heights import is_flat
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.routing import RoutePoint, check_way, plan_route
from drivora_service.scenario.checks.placed_actors import PlacedActor
from drivora_service.scenario.checks.start_overlaps import StartPose
from drivora_service.scenario.model import NpcBehavior, Waypoint

JOIN_DISTANCE = 10.0
"""Metres between waypoints of a reactive NPC beyond which they are connected along the lanes."""
MIN_ROUTE_LENGTH = 2.0
"""Minimum length of an ego's route, metres."""


RouteCheck = Callable[[PlacedActor, RoadNetwork], tuple[Sequence[Problem], StartPose | None]]
""":func:`check_route`, or a cached version of it."""


def check_route(actor: PlacedActor, network: RoadNetwork) -> tuple[list[Problem], StartPose | None]:
    """Checks the route of an actor whose places are on the network.

    Returns:
        Problems, and the start pose; ``None`` without a route.
    """
    if actor.is_ego:
        problems, pose = _check_ego(actor, network)
    elif actor.behavior is NpcBehavior.SUMO:
        problems, pose = _check_driven(actor, network)
    elif actor.behavior is NpcBehavior.REACTIVE:
        problems, pose = _check_reactive(actor, network)
    else:
        problems, pose = [], _standing_pose(actor, network)
    if pose is not None and not is_flat(network):
        pose = replace(pose, height=_height(pose, network))
    return problems, pose


def route_points(places: Sequence[Waypoint]) -> tuple[RoutePoint, ...]:
    """Returns waypoints as the points of a route."""
    return tuple(RoutePoint(x=place.x, y=place.y, yaw=place.yaw) for place in places)


def _check_ego(actor: PlacedActor, network: RoadNetwork) -> tuple[list[Problem], StartPose | None]:
    start, destination = actor.places[0], actor.places[-1]
    if len(actor.places) == 2 and _distance(start, destination) < MIN_ROUTE_LENGTH:
        message = (
            f"the destination is {_distance(start, destination):.2f} m from the start; "
            f"at least {MIN_ROUTE_LENGTH:.0f} m are needed"
        )
        return [_at(actor, 1, "no_way_to_go", message)], None
    route = _plan(actor, actor.places, network)
    if isinstance(route, Problem):
        return [route], None
    if route.length < MIN_ROUTE_LENGTH:
        message = (
            f"the route is {route.length:.2f} m long; at least {MIN_ROUTE_LENGTH:.0f} m are needed"
        )
        return [_at(actor, len(actor.places) - 1, "no_way_to_go", message)], None
    return [], _pose(actor, start, _first_heading(route))


def _check_driven(
    actor: PlacedActor, network: RoadNetwork
) -> tuple[list[Problem], StartPose | None]:
    if len(actor.places) < 2:
        message = "found 1 waypoint; behavior sumo needs at least 2 (a parked vehicle: replay)"
        return [Problem(pointer=f"{actor.pointer}/route", code="too_short", message=message)], None
    start = actor.places[0]
    route = _plan(actor, actor.places, network)
    if isinstance(route, Problem):
        return [route], None
    lane = network.lanes[int(route.point_lanes[0])]
    if lane.is_internal:
        message = (
            "the route of a vehicle that SUMO drives must start on a road, not inside a junction"
        )
        return [_at(actor, 0, "starts_in_junction", message)], None
    near = nearest_lane_position(network, start.x, start.y, heading=start.yaw)
    if near is None or actor.model is None:
        return [], None
    if lane.length < actor.model.length:
        message = (
            f"the lane {lane.id} is {lane.length:.1f} m long, too short for a vehicle of "
            f"{actor.model.length:.1f} m that SUMO drives to start on"
        )
        return [_at(actor, 0, "starts_on_short_lane", message)], None
    front = min(max(near.s + 0.5 * actor.model.length, actor.model.length), lane.length)
    x, y, yaw = lane.position_at(front - 0.5 * actor.model.length)
    return [], StartPose(actor=actor, x=x, y=y, yaw=yaw)


def _check_reactive(
    actor: PlacedActor, network: RoadNetwork
) -> tuple[list[Problem], StartPose | None]:
    problems: list[Problem] = []
    first_heading: float | None = None
    points = route_points(actor.places)
    for index, (here, there) in enumerate(itertools.pairwise(actor.places)):
        if _distance(here, there) <= JOIN_DISTANCE:
            continue
        # Only the first leg needs geometry; feasibility is cheaper to check.
        if index > 0 and _drivable(network, points[index : index + 2]):
            continue
        route = _plan(actor, (here, there), network, first=index)
        if isinstance(route, Problem):
            problems.append(route)
        else:
            first_heading = _first_heading(route)
    pose = _standing_pose(actor, network)
    if first_heading is not None:
        pose = StartPose(actor=actor, x=pose.x, y=pose.y, yaw=first_heading)
    return problems, pose


def _standing_pose(actor: PlacedActor, network: RoadNetwork) -> StartPose:
    """Returns the pose with the heading to the next place, else the given one, else the lane's."""
    start = actor.places[0]
    for place in actor.places[1:]:
        if _distance(start, place) > 0.1:
            heading = math.atan2(place.y - start.y, place.x - start.x)
            return StartPose(actor=actor, x=start.x, y=start.y, yaw=heading)
    near = None
    if start.yaw is None:
        near = nearest_lane_position(network, start.x, start.y)
    return _pose(actor, start, 0.0 if near is None else near.heading)


def _pose(actor: PlacedActor, start: Waypoint, heading: float) -> StartPose:
    yaw = heading if start.yaw is None else start.yaw
    return StartPose(actor=actor, x=start.x, y=start.y, yaw=yaw)


def _height(pose: StartPose, network: RoadNetwork) -> float:
    """Returns a pose's height: the given one for fixed actors, else that of its lane, metres."""
    start = pose.actor.places[0]
    if start.z is not None and not pose.actor.is_vehicle:
        return start.z
    near = nearest_lane_position(network, pose.x, pose.y, heading=pose.yaw)
    if near is None:
        return 0.0
    lane = network.lanes[near.lane]
    return float(np.interp(near.s, lane.arc, lane.heights))


def _plan(
    actor: PlacedActor, places: Sequence[Waypoint], network: RoadNetwork, first: int = 0
) -> LaneRoute | Problem:
    """Plans a route through places, the first of which is the actor's waypoint ``first``."""
    points = route_points(places)
    try:
        return plan_route(network, points)
    except NoRoute as error:
        reachable, blocked = 1, len(points)
        while blocked - reachable > 1:
            middle = (reachable + blocked) // 2
            if _drivable(network, points[:middle]):
                reachable = middle
            else:
                blocked = middle
        here, there = places[blocked - 2], places[blocked - 1]
        message = (
            f"no drivable way from waypoint {first + blocked - 2} ({here.x:.2f}, {here.y:.2f}) to "
            f"waypoint {first + blocked - 1} ({there.x:.2f}, {there.y:.2f}): {error}"
        )
        return _at(actor, first + blocked - 1, "no_route", message)


def _drivable(network: RoadNetwork, points: Sequence[RoutePoint]) -> bool:
    try:
        check_way(network, points)
    except NoRoute:
        return False
    return True


def _first_heading(route: LaneRoute) -> float:
    step = route.line[min(1, len(route.line) - 1)] - route.line[0]
    return math.atan2(float(step[1]), float(step[0]))


def _distance(one: Waypoint, other: Waypoint) -> float:
    return math.hypot(one.x - other.x, one.y - other.y)


def _at(actor: PlacedActor, place: int, code: str, message: str) -> Problem:
    return Problem(pointer=actor.place_pointer(place), code=code, message=message)
