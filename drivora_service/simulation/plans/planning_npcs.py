"""Planning of NPC vehicles and walkers: their paths, and the routes of those that SUMO drives."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from shapely import LineString, Point

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.heights import is_flat, line_heights
from drivora_service.networks.projection import nearest_lane_position, project_points
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.route_line import QuickChange
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.observations.ground import frictions_along, patch_array
from drivora_service.observations.trace import Role
from drivora_service.scenario.model import NpcBehavior, NpcVehicle, NpcWalker, RouteEnd, Waypoint
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel, actor_model
from drivora_service.scenario.waypoint_speeds import most_lateral, waypoint_speeds
from drivora_service.simulation.followers.follower_path import (
    FollowerPath,
    PathPlan,
    build_path,
    planned_grip,
    slower_on,
)
from drivora_service.simulation.plans.episode_plan import DrivenPlan, FollowerPlan, PatchPlan
from drivora_service.simulation.plans.planning_places import nearest_edge

JOIN_DISTANCE = 10.0
"""Waypoints of a reactive NPC further apart than this are joined along the lanes, metres."""
WALKING_SPEED = 1.4
WALKING_ACCELERATION = 2.0
"""Acceleration of walkers, m/s²: from standing to walking within a step or two."""
COMFORTABLE_BRAKING_SHARE = 0.4
"""Share of its hardest braking with which an NPC vehicle brakes for a lower speed."""


def route_points(waypoints: Sequence[Waypoint]) -> tuple[RoutePoint, ...]:
    """Returns waypoints as the planner of routes takes them."""
    return tuple(RoutePoint(x=point.x, y=point.y, yaw=point.yaw) for point in waypoints)


def _with_heights(path: FollowerPath, network: RoadNetwork) -> FollowerPath:
    """Sets the heights of a path to those of the lanes that it follows."""
    if is_flat(network):
        return path
    lanes = project_points(network, path.line, path.yaw).lane.astype(np.int64)
    return replace(path, height=line_heights(network, path.line, lanes))


def _straight(waypoints: Sequence[Waypoint]) -> tuple[FloatArray, FloatArray]:
    line = np.array([(point.x, point.y) for point in waypoints])
    return line, arc_lengths(line)


def _along_lanes(
    waypoints: Sequence[Waypoint],
    network: RoadNetwork,
    changes: Sequence[QuickChange | None],
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Connects waypoints: near ones straight, distant ones along the lanes between them.

    A waypoint beside its lane's centre keeps its offset, which fades into that of the next.

    Args:
        waypoints: The waypoints.
        network: The network.
        changes: The lane changes on the way to each waypoint.
    """
    pieces: list[FloatArray] = [np.array([(waypoints[0].x, waypoints[0].y)])]
    marks = [0.0]
    edges: list[str] = []
    travelled = 0.0
    for (here, there), change in zip(itertools.pairwise(waypoints), changes[1:], strict=True):
        ends = np.array([(here.x, here.y), (there.x, there.y)])
        piece = ends
        if float(np.hypot(*(ends[1] - ends[0]))) > JOIN_DISTANCE:
            route = plan_route(network, route_points((here, there)), change)
            share = (route.arc / route.length)[:, None]
            offsets = (1.0 - share) * (ends[0] - route.line[0]) + share * (ends[1] - route.line[-1])
            piece = route.line + offsets
            # SUMO needs one connected route: where legs do not join, it gets the route up to there.
            if not edges:
                edges += route.edges
            elif route.edges and edges[-1] == route.edges[0]:
                edges += route.edges[1:]
        travelled += float(arc_lengths(piece)[-1])
        pieces.append(piece[1:])
        marks.append(travelled)
    return np.concatenate(pieces), np.array(marks), tuple(edges)


@lru_cache(maxsize=1024)
def plan_npc(
    npc: NpcVehicle, network: RoadNetwork, friction: float, patches: tuple[PatchPlan, ...] = ()
) -> FollowerPlan:
    """Returns the path and speeds of a replayed or reactive NPC vehicle."""
    model = actor_model(ActorKind.VEHICLE, npc.model)
    is_parked = len(npc.route) == 1
    plan = None if is_parked else _path_plan(npc)
    speeds = waypoint_speeds(npc.route, network, None)
    edges: tuple[str, ...] = ()
    if npc.behavior is NpcBehavior.REACTIVE and not is_parked:
        changes = _lane_changes(npc, model, speeds, friction)
        line, marks, edges = _along_lanes(npc.route, network, changes)
    else:
        line, marks = _straight(npc.route)
    start = npc.route[0]
    yaw = start.yaw
    if yaw is None and is_parked:
        place = nearest_lane_position(network, start.x, start.y)
        yaw = 0.0 if place is None else place.heading
    deceleration = COMFORTABLE_BRAKING_SHARE * model.max_deceleration
    if plan is not None:
        wanted = deceleration if npc.deceleration is None else npc.deceleration
        deceleration = min(wanted, model.max_deceleration, planned_grip(friction))
    path = _with_heights(
        build_path(line, speeds, marks, yaw, friction, deceleration, is_vehicle=True, plan=plan),
        network,
    )
    if patches:
        path = _on_patches(path, friction, patches, deceleration)
    return FollowerPlan(
        id=npc.id,
        role=Role.NPC_VEHICLE,
        model=model,
        path=path,
        edges=edges or (nearest_edge(network, start.x, start.y),),
        on_lanes=bool(edges),
        first_speed=float(speeds[0]),
        start_time=npc.start_time,
        reacts=npc.behavior is NpcBehavior.REACTIVE,
        stays=is_parked or npc.at_end is RouteEnd.STAY,
        is_fixed=is_parked,
        deceleration=0.0 if plan is None else deceleration,
    )


def _path_plan(npc: NpcVehicle) -> PathPlan | None:
    """Returns what a vehicle's path plans beside the speeds; ``None`` if it is told nothing else.

    Vehicles that are told nothing else drive as they did before there was anything to tell.
    """
    waits = np.array([place.wait or 0.0 for place in npc.route])
    stops = npc.at_end is RouteEnd.STAY
    if not (waits.any() or stops or npc.deceleration or npc.lateral_acceleration):
        return None
    return PathPlan(waits=waits, stops_at_end=stops, lateral_acceleration=npc.lateral_acceleration)


def _lane_changes(
    npc: NpcVehicle, model: ActorModel, speeds: FloatArray, friction: float
) -> tuple[QuickChange | None, ...]:
    """Returns the lane changes on the way to each waypoint; ``None``: those of reference lines."""
    if npc.lateral_acceleration is None:
        return (None,) * len(npc.route)
    side = most_lateral(npc.lateral_acceleration, friction)
    turning_circle = model.wheelbase / math.tan(model.max_steer)
    return tuple(
        QuickChange(speed=speed, lateral_acceleration=side, least_radius=turning_circle)
        for speed in speeds.tolist()
    )


def _on_patches(
    path: FollowerPath, friction: float, patches: tuple[PatchPlan, ...], braking: float
) -> FollowerPath:
    """Lowers the speeds of a path to those for which patches leave enough grip."""
    poses = np.column_stack((path.line, path.yaw))
    laid = patch_array([patch.to_record() for patch in patches])
    frictions = frictions_along(poses, path.height, 0.0, friction, laid)
    if not (frictions < friction).any():
        return path
    return slower_on(path, frictions, friction, braking)


@lru_cache(maxsize=1024)
def plan_walker(walker: NpcWalker, network: RoadNetwork) -> FollowerPlan:
    """Returns the path and speeds of a walker: straight from waypoint to waypoint."""
    model = replace(
        actor_model(ActorKind.WALKER, walker.model),
        max_acceleration=WALKING_ACCELERATION,
        max_deceleration=WALKING_ACCELERATION,
    )
    line, marks = _straight(walker.route)
    speeds = waypoint_speeds(walker.route, network, WALKING_SPEED)
    start = walker.route[0]
    return FollowerPlan(
        id=walker.id,
        role=Role.NPC_WALKER,
        model=model,
        path=_with_heights(
            build_path(
                line, speeds, marks, start.yaw, 1.0, model.max_deceleration, is_vehicle=False
            ),
            network,
        ),
        edges=(nearest_edge(network, start.x, start.y),),
        on_lanes=False,
        first_speed=float(speeds[0]),
        start_time=walker.start_time,
        reacts=False,
        stays=True,
        is_fixed=True,
    )


def plan_driven(npc: NpcVehicle, network: RoadNetwork) -> DrivenPlan:
    """Returns the route of an NPC vehicle that SUMO drives, and where it enters and arrives."""
    model = actor_model(ActorKind.VEHICLE, npc.model)
    route = plan_route(network, route_points(npc.route))
    first, last = (network.lanes[int(lane)] for lane in route.point_lanes[[0, -1]])
    speed = npc.route[0].speed
    return DrivenPlan(
        id=npc.id,
        model=model,
        edges=route.edges,
        lane_number=0 if first.is_internal else first.lane_number,
        position=_front_on(first, route.line[0], model.length),
        arrival=_front_on(last, route.line[-1], model.length),
        speed=min(first.speed_limit if speed is None else speed, first.speed_limit),
        start_time=npc.start_time,
    )


def _front_on(lane: Lane, point: FloatArray, length: float) -> float:
    """Returns the front bumper's position on a lane, metres, of a vehicle centred at ``point``."""
    if lane.is_internal:
        # In SUMO, vehicles cannot start or arrive inside a junction.
        return min(length, lane.length)
    s = LineString(lane.shape).project(Point(point)) * lane.length / float(lane.arc[-1])
    return min(max(s + 0.5 * length, length), lane.length)
