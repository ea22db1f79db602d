"""The motion of the actors of a scenario as planned: without SUMO, and without other actors.

Vehicles that replay their path, walkers and obstacles move so in an episode, too. A reactive
vehicle, which brakes for others, is never further on its path than planned, but may be later.
"""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.arrays import BoolArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.ground import patch_array
from drivora_service.observations.planned_motion import PlannedMotion
from drivora_service.observations.trace import Col
from drivora_service.scenario.model import NpcBehavior, Scenario
from drivora_service.scenario.weather import weather_effects
from drivora_service.simulation.arrays import lay_followers
from drivora_service.simulation.follower_state import FollowerCol, Reaction
from drivora_service.simulation.followers import advance_followers
from drivora_service.simulation.plan import (
    FollowerPlan,
    plan_npc,
    plan_obstacle,
    plan_patch,
    plan_walker,
)


def planned_motions(
    scenario: Scenario, network: RoadNetwork, until: float
) -> tuple[PlannedMotion, ...]:
    """Returns the planned motion of NPC vehicles, walkers and obstacles, in this order.

    Vehicles that SUMO drives are left out: their paths are not planned.

    Args:
        scenario: A validated scenario.
        network: Its road network.
        until: Seconds of simulation time up to which they are needed.
    """
    friction = weather_effects(scenario.weather).friction
    vehicles = [npc for npc in scenario.npc_vehicles if npc.behavior is not NpcBehavior.SUMO]
    patches = tuple(plan_patch(patch, network) for patch in scenario.friction_patches)
    plans = [plan_npc(npc, network, friction, patches) for npc in vehicles]
    plans += [plan_walker(walker, network) for walker in scenario.npc_walkers]
    count = round(until / scenario.step_length) + 1
    times = scenario.step_length * np.arange(count, dtype=np.float64)
    laid = patch_array([patch.recorded() for patch in patches])
    states, present = _advanced(plans, count, scenario.step_length, friction, laid)
    moving = tuple(
        PlannedMotion(
            id=plan.id,
            length=plan.model.length,
            width=plan.model.width,
            times=times,
            poses=states[:, index, [Col.X, Col.Y, Col.YAW]],
            present=present[:, index],
            may_be_late=plan.reacts,
        )
        for index, plan in enumerate(plans)
    )
    standing = []
    for obstacle in scenario.npc_obstacles:
        planned = plan_obstacle(obstacle, network)
        standing.append(
            PlannedMotion(
                id=obstacle.id,
                length=planned.length,
                width=planned.width,
                times=times,
                poses=np.tile(np.array(planned.pose), (count, 1)),
                present=times >= obstacle.start_time - 1e-9,
                may_be_late=False,
            )
        )
    return (*moving, *standing)


def _advanced(
    plans: list[FollowerPlan], count: int, step: float, friction: float, patches: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Returns (count, F, 9) states and (count, F) presence of followers that react to nothing."""
    states = np.full((count, len(plans), len(Col)), np.nan)
    present = np.zeros((count, len(plans)), dtype=np.bool_)
    if not plans:
        return states, present
    followers = lay_followers(plans, range(len(plans)))
    followers.state[:, FollowerCol.REACTION] = Reaction.NONE
    sizes = np.array([(plan.model.length, plan.model.width) for plan in plans], dtype=np.float64)
    nobody = np.zeros(len(plans), dtype=np.bool_)
    for row in range(count):
        advance_followers(
            (row - 1) * step, step, friction, patches, followers.places, followers.path,
            followers.state, states[row - 1], sizes, nobody, states[row], present[row],
        )  # fmt: skip
    return states, present
