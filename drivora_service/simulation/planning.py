"""Planning of an episode from a validated scenario."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.heights import line_heights
from drivora_service.networks.road_network import RoadNetwork, make_read_only
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.routing import plan_route
from drivora_service.scenario.model import EgoVehicle, NpcBehavior, Scenario
from drivora_service.scenario.models.actor_models import ActorKind, actor_model
from drivora_service.scenario.weather import weather_effects
from drivora_service.simulation.motion.route_tracking import STUCK_AFTER
from drivora_service.simulation.plans.episode_plan import EgoPlan, EpisodePlan
from drivora_service.simulation.plans.light_programs import (
    RunningProgram,
    longest_wait,
    run_programs,
)
from drivora_service.simulation.plans.planning_npcs import (
    plan_driven,
    plan_npc,
    plan_walker,
    route_points,
)
from drivora_service.simulation.plans.planning_places import plan_obstacle, plan_patch

TIME_PER_METRE = 0.8
"""Time limit of an ego in seconds for each metre of route (CARLA Leaderboard)."""
TIME_TO_START = 5.0


def plan_episode(scenario: Scenario, network: RoadNetwork) -> EpisodePlan:
    """Returns the plan of an episode; actors that join it are planned when they do.

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


def _plan_ego(ego: EgoVehicle, network: RoadNetwork) -> EgoPlan:
    route = plan_route(network, route_points(ego.route))
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
