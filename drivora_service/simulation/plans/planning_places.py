"""Planning of what stays in its place: obstacles and slippery patches."""

from __future__ import annotations

import numpy as np

from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.patch_checks import patch_yaw
from drivora_service.scenario.model import FrictionPatch, NpcObstacle, Waypoint
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.simulation.plans.episode_plan import ObstaclePlan, PatchPlan


def plan_patch(patch: FrictionPatch, network: RoadNetwork) -> PatchPlan:
    """Returns a slippery patch with its height and heading on the network."""
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


def plan_obstacle(obstacle: NpcObstacle, network: RoadNetwork) -> ObstaclePlan:
    """Returns a static object with its size, its pose and the nearest edge."""
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
        edge=nearest_edge(network, place.x, place.y),
    )


def nearest_edge(network: RoadNetwork, x: float, y: float) -> str:
    """Returns the road edge nearest to a place; in a junction, or far from all, the first one."""
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
