"""The motion of the actors of a scenario as planned: without SUMO, and without other actors.

Vehicles that replay their path, walkers and obstacles move so in an episode, too. A reactive
vehicle, which brakes for others, is never further on its path than planned, but may be later.
Actors that join the episode do so at their times, and the weather changes at its times.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.ground import patch_array
from drivora_service.observations.planned_motion import PlannedMotion
from drivora_service.observations.trace import Col
from drivora_service.scenario.model import NpcBehavior, NpcWalker, Scenario
from drivora_service.simulation.episode_changes import Joining, join_step, weather_by_step
from drivora_service.simulation.followers.follower_state import FollowerCol, Reaction
from drivora_service.simulation.followers.followers import Followers, advance_followers
from drivora_service.simulation.plans.episode_plan import FollowerPlan, PatchPlan
from drivora_service.simulation.plans.plan_arrays import lay_followers
from drivora_service.simulation.plans.planning_npcs import plan_npc, plan_walker
from drivora_service.simulation.plans.planning_places import plan_obstacle, plan_patch


def plan_motions(
    scenario: Scenario, network: RoadNetwork, until: float
) -> tuple[PlannedMotion, ...]:
    """Returns the planned motion of NPC vehicles, walkers and obstacles, in this order.

    Vehicles that SUMO drives are left out: their paths are not planned.

    Args:
        scenario: A validated scenario.
        network: Its road network.
        until: Seconds of simulation time up to which they are needed.
    """
    weather_at = weather_by_step(scenario)
    vehicles = [npc for npc in scenario.npc_vehicles if npc.behavior is not NpcBehavior.SUMO]
    patches = tuple(plan_patch(patch, network) for patch in scenario.friction_patches)
    count = round(until / scenario.step_length) + 1
    frictions = [weather_at(-1).friction] * count
    if scenario.weather_changes:
        # Row 0 is made before the first step, in the weather of the beginning.
        frictions = [weather_at(row - 1).friction for row in range(count)]
    actors: Sequence[Joining] = (*vehicles, *scenario.npc_walkers)
    plans = [_plan(one, network, scenario.step_length, frictions, patches) for one in actors]
    times = scenario.step_length * np.arange(count, dtype=np.float64)
    laid = patch_array([patch.to_record() for patch in patches])
    states, present = _simulate_followers(plans, scenario.step_length, frictions, laid)
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


def _plan(
    actor: Joining,
    network: RoadNetwork,
    step_length: float,
    frictions: Sequence[float],
    patches: tuple[PatchPlan, ...],
) -> FollowerPlan:
    """Returns the plan of an actor; of one that joins, in the weather of that time."""
    first = join_step(actor.start_time, step_length) + 1 if actor.joins else 0
    if isinstance(actor, NpcWalker):
        plan = plan_walker(actor, network)
    else:
        plan = plan_npc(actor, network, frictions[min(first, len(frictions) - 1)], patches)
    return replace(plan, start_time=max(plan.start_time, first * step_length))


def _simulate_followers(
    plans: list[FollowerPlan], step: float, frictions: Sequence[float], patches: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Returns (n, F, 9) states and (n, F) presence of followers that react to nothing.

    Args:
        plans: The F followers.
        step: Seconds between rows.
        frictions: Friction coefficients of the road beside patches on the way to each of n rows.
        patches: (P, 8) places with less, columns ``ground.PatchCol``.
    """
    count = len(frictions)
    states = np.full((count, len(plans), len(Col)), np.nan)
    present = np.zeros((count, len(plans)), dtype=np.bool_)
    if not plans:
        return states, present
    followers = lay_followers(plans, range(len(plans)))
    followers.state[:, FollowerCol.REACTION] = Reaction.NONE
    sizes = np.array([(plan.model.length, plan.model.width) for plan in plans], dtype=np.float64)
    nobody = np.zeros(len(plans), dtype=np.bool_)
    _advance_rows(
        step, np.array(frictions, dtype=np.float64), patches, followers, sizes, nobody, states,
        present,
    )  # fmt: skip
    return states, present


@compiled
def _advance_rows(
    step: float,
    frictions: FloatArray,
    patches: FloatArray,
    followers: Followers,
    sizes: FloatArray,
    nobody: BoolArray,
    states: FloatArray,
    present: BoolArray,
) -> None:
    """Moves followers from row to row of ``states`` (n, F, 9), to which nobody else is present."""
    for row in range(frictions.shape[0]):
        advance_followers(
            (row - 1) * step, step, frictions[row], patches, followers, states[row - 1], sizes,
            nobody, states[row], present[row],
        )  # fmt: skip
