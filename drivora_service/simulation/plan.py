"""Planning of an episode from a validated scenario: routes, paths, programmes, sizes.

Frame: the network's plane, metres, radians counter-clockwise from east.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache

import numpy as np
from shapely import LineString, Point

from drivora_service.geometry.arrays import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.heights import is_flat, line_heights
from drivora_service.networks.lane_route import LaneRoute
from drivora_service.networks.projection import nearest_lane_position, project_points
from drivora_service.networks.road_network import Lane, RoadNetwork, make_read_only
from drivora_service.networks.route_line import QuickChange
from drivora_service.networks.routing import RoutePoint, plan_route
from drivora_service.observations.ground import frictions_along, patch_array
from drivora_service.observations.trace import Role
from drivora_service.scenario.actor_models import ActorKind, ActorModel, actor_model
from drivora_service.scenario.model import (
    EgoVehicle,
    FrictionPatch,
    NpcBehavior,
    NpcObstacle,
    NpcVehicle,
    NpcWalker,
    RouteEnd,
    Scenario,
    Waypoint,
)
from drivora_service.scenario.patch_checks import patch_yaw
from drivora_service.scenario.weather import WeatherEffects, weather_effects
from drivora_service.simulation.follower_path import (
    FollowerPath,
    PathPlan,
    build_path,
    most_lateral,
    planned_grip,
    slower_on,
)
from drivora_service.simulation.lights import RunningProgram, longest_wait, run_programs
from drivora_service.simulation.route_tracking import STUCK_AFTER

JOIN_DISTANCE = 10.0
"""Waypoints of a reactive NPC further apart than this are joined along the lanes, metres."""
WALKING_SPEED = 1.4
WALKING_ACCELERATION = 2.0
"""Acceleration of walkers, m/s²: from standing to walking within a step or two."""
OFF_ROAD_SPEED = 8.0
TIME_PER_METRE = 0.8
"""Time limit of an ego in seconds for each metre of route (CARLA Leaderboard)."""
TIME_TO_START = 5.0
COMFORTABLE_BRAKING_SHARE = 0.4
"""Share of its hardest braking with which an NPC vehicle brakes for a lower speed."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EgoPlan:
    """An ego and its route.

    Attributes:
        heights: (n,) heights along the route's reference line, metres.
        start: x, y, yaw of the box centre at the start.
        time_limit: Simulation time in seconds by which it must have arrived, without the time that
            it waits at signals.
    """

    ego: EgoVehicle
    model: ActorModel
    route: LaneRoute
    heights: FloatArray
    start: tuple[float, float, float]
    time_limit: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowerPlan:
    """An NPC vehicle or walker that follows a path.

    Attributes:
        edges: SUMO edges of its path, not empty; for a path off the road, the nearest edge.
        on_lanes: Whether its path keeps to those edges.
        first_speed: m/s at the start.
        stays: Whether it stays at the end of its path.
        is_fixed: Whether it has ended in SUMO's eyes from its start on, and needs to be checked in
            each step: a parked vehicle, a walker.
        deceleration: m/s² of its braking where its path plans it within the grip; 0: the path plans
            comfortably.
    """

    id: str
    role: Role
    model: ActorModel
    path: FollowerPath
    edges: tuple[str, ...]
    on_lanes: bool
    first_speed: float
    start_time: float
    reacts: bool
    stays: bool
    is_fixed: bool
    deceleration: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrivenPlan:
    """An NPC vehicle that SUMO drives.

    Attributes:
        position: Front bumper's position on the first lane at the start, in SUMO's metres.
        arrival: Front bumper's position on the last lane at the destination, in SUMO's metres.
    """

    id: str
    model: ActorModel
    edges: tuple[str, ...]
    lane_number: int
    position: float
    arrival: float
    speed: float
    start_time: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ObstaclePlan:
    """A static object and the SUMO edge nearest to it."""

    obstacle: NpcObstacle
    model: ActorModel
    pose: tuple[float, float, float]
    height: float
    length: float
    width: float
    edge: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchPlan:
    """A slippery rectangle of the road: centre, height and size in metres, heading in radians."""

    id: str
    x: float
    y: float
    z: float
    yaw: float
    length: float
    width: float
    friction: float

    def recorded(self) -> dict[str, str | float]:
        """Returns it as traces record it."""
        return asdict(self)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EpisodePlan:
    """The plan of an episode, without the agents.

    Attributes:
        patches: Slippery places of the road.
        max_sim_time: Seconds after which it ends.
        stuck_after: Seconds that an ego may stand before its part ends.
    """

    scenario: Scenario
    network: RoadNetwork
    weather: WeatherEffects
    programs: tuple[RunningProgram, ...]
    egos: tuple[EgoPlan, ...]
    followers: tuple[FollowerPlan, ...]
    driven: tuple[DrivenPlan, ...]
    obstacles: tuple[ObstaclePlan, ...]
    patches: tuple[PatchPlan, ...]
    max_sim_time: float
    stuck_after: float

    @property
    def patch_array(self) -> FloatArray:
        """(P, 8) ``patches``, columns ``ground.PatchCol``."""
        return patch_array([patch.recorded() for patch in self.patches])


def plan_episode(scenario: Scenario, network: RoadNetwork) -> EpisodePlan:
    """Prepares an episode; actors that join it are prepared when they do.

    Raises:
        NoRoute: If there is no route for an actor; validation rules that out.
        UnknownName: If a model is not in the catalogue; validation rules that out.
    """
    weather = weather_effects(scenario.weather)
    egos = tuple(_plan_ego(ego, network) for ego in scenario.ego_vehicles)
    vehicles = [npc for npc in scenario.npc_vehicles if npc.behavior is not NpcBehavior.SUMO]
    patches = tuple(plan_patch(patch, network) for patch in scenario.friction_patches)
    followers = [
        plan_npc(npc, network, weather.friction, patches) for npc in vehicles if not npc.joins
    ]
    followers += [
        plan_walker(walker, network) for walker in scenario.npc_walkers if not walker.joins
    ]
    programs = run_programs(
        network.programs, scenario.traffic_lights, step_length=scenario.step_length
    )
    latest = max(ego.time_limit + signal_time(ego.route, programs) for ego in egos)
    return EpisodePlan(
        scenario=scenario,
        network=network,
        weather=weather,
        programs=programs,
        egos=egos,
        followers=tuple(followers),
        driven=tuple(
            plan_driven(npc, network)
            for npc in scenario.npc_vehicles
            if npc.behavior is NpcBehavior.SUMO and not npc.joins
        ),
        obstacles=tuple(plan_obstacle(item, network) for item in scenario.npc_obstacles),
        patches=patches,
        max_sim_time=latest if scenario.max_sim_time is None else scenario.max_sim_time,
        stuck_after=STUCK_AFTER if scenario.stuck_after is None else scenario.stuck_after,
    )


def signal_time(route: LaneRoute, programs: Sequence[RunningProgram]) -> float:
    """Returns the maximum seconds of waiting at the signals on a route."""
    by_id = {program.id: program for program in programs}
    return sum(
        longest_wait(by_id[signal.traffic_light], signal.link_index)
        for signal in route.signals
        if signal.traffic_light in by_id
    )


def _route_points(waypoints: Sequence[Waypoint]) -> tuple[RoutePoint, ...]:
    return tuple(RoutePoint(x=point.x, y=point.y, yaw=point.yaw) for point in waypoints)


def _plan_ego(ego: EgoVehicle, network: RoadNetwork) -> EgoPlan:
    route = plan_route(network, _route_points(ego.route))
    ahead = route.line[min(1, len(route.line) - 1)] - route.line[0]
    start = ego.route[0]
    yaw = math.atan2(ahead[1], ahead[0]) if start.yaw is None else start.yaw
    return EgoPlan(
        ego=ego,
        model=actor_model(ActorKind.VEHICLE, ego.model),
        route=route,
        heights=_route_heights(network, route),
        start=(start.x, start.y, yaw),
        time_limit=ego.start_time + TIME_PER_METRE * route.length + TIME_TO_START,
    )


@lru_cache(maxsize=512)
def _route_heights(network: RoadNetwork, route: LaneRoute) -> FloatArray:
    """Returns the (n,) heights of a route's points; read-only, since routes are shared."""
    heights = line_heights(network, route.line, route.point_lanes)
    make_read_only(heights)
    return heights


def _waypoint_speeds(
    waypoints: Sequence[Waypoint], network: RoadNetwork, default: float | None
) -> FloatArray:
    speeds = []
    for point in waypoints:
        if point.speed is not None:
            speeds.append(point.speed)
        elif default is not None:
            speeds.append(default)
        else:
            place = nearest_lane_position(network, point.x, point.y)
            limit = OFF_ROAD_SPEED if place is None else network.lanes[place.lane].speed_limit
            speeds.append(limit)
    return np.array(speeds)


def _nearest_edge(network: RoadNetwork, x: float, y: float) -> str:
    place = nearest_lane_position(network, x, y, max_distance=200.0)
    lane = None if place is None else network.lanes[place.lane]
    if lane is not None and not lane.is_internal:
        return lane.edge_id
    return next(lane.edge_id for lane in network.lanes if lane.drivable and not lane.is_internal)


def _height_at(network: RoadNetwork, point: Waypoint, yaw: float) -> float:
    if point.z is not None:
        return point.z
    lane = nearest_lane_position(network, point.x, point.y, heading=yaw)
    if lane is None:
        return 0.0
    return float(np.interp(lane.s, network.lanes[lane.lane].arc, network.lanes[lane.lane].heights))


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
            route = plan_route(network, _route_points((here, there)), change)
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
    """Prepares a replayed or reactive NPC vehicle."""
    model = actor_model(ActorKind.VEHICLE, npc.model)
    is_parked = len(npc.route) == 1
    plan = None if is_parked else _path_plan(npc)
    speeds = _waypoint_speeds(npc.route, network, None)
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
        edges=edges or (_nearest_edge(network, start.x, start.y),),
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
    laid = patch_array([patch.recorded() for patch in patches])
    frictions = frictions_along(poses, path.height, 0.0, friction, laid)
    if not (frictions < friction).any():
        return path
    return slower_on(path, frictions, friction, braking)


def plan_patch(patch: FrictionPatch, network: RoadNetwork) -> PatchPlan:
    """Prepares a slippery patch."""
    yaw = patch_yaw(patch, network)
    place = patch.location
    return PatchPlan(
        id=patch.id,
        x=place.x,
        y=place.y,
        z=_height_at(network, place, yaw),
        yaw=yaw,
        length=patch.length,
        width=patch.width,
        friction=patch.friction,
    )


@lru_cache(maxsize=1024)
def plan_walker(walker: NpcWalker, network: RoadNetwork) -> FollowerPlan:
    """Prepares a walker."""
    model = replace(
        actor_model(ActorKind.WALKER, walker.model),
        max_acceleration=WALKING_ACCELERATION,
        max_deceleration=WALKING_ACCELERATION,
    )
    line, marks = _straight(walker.route)
    speeds = _waypoint_speeds(walker.route, network, WALKING_SPEED)
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
        edges=(_nearest_edge(network, start.x, start.y),),
        on_lanes=False,
        first_speed=float(speeds[0]),
        start_time=walker.start_time,
        reacts=False,
        stays=True,
        is_fixed=True,
    )


def plan_driven(npc: NpcVehicle, network: RoadNetwork) -> DrivenPlan:
    """Prepares an NPC vehicle that SUMO drives."""
    model = actor_model(ActorKind.VEHICLE, npc.model)
    route = plan_route(network, _route_points(npc.route))
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


def plan_obstacle(obstacle: NpcObstacle, network: RoadNetwork) -> ObstaclePlan:
    """Prepares a static object."""
    model = actor_model(ActorKind.OBSTACLE, obstacle.model)
    place = obstacle.location
    yaw = place.yaw
    if yaw is None:
        lane = nearest_lane_position(network, place.x, place.y)
        yaw = 0.0 if lane is None else lane.heading
    return ObstaclePlan(
        obstacle=obstacle,
        model=model,
        pose=(place.x, place.y, yaw),
        height=_height_at(network, place, yaw),
        length=model.length if obstacle.length is None else obstacle.length,
        width=model.width if obstacle.width is None else obstacle.width,
        edge=_nearest_edge(network, place.x, place.y),
    )
