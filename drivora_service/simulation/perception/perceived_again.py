"""What an ego's agent perceived in a recorded run, computed again from the recording.

Perception is a function of the frames, the weather, the heights of the actors, and random draws
that follow from the seed. The trace has the frames, the scenario all else. The kernel and the draws
are those of the episode.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace

import numpy as np

from drivora_service.errors import Conflict
from drivora_service.geometry.array_shapes import ByteArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.model import NpcWalker, Scenario
from drivora_service.scenario.models.actor_models import ActorKind, ActorModel, actor_model
from drivora_service.simulation.episode_changes import joining_actors, weather_by_step
from drivora_service.simulation.perception.actor_heights import actor_heights
from drivora_service.simulation.perception.ego_perception import Draw, empty_seen, perceive
from drivora_service.simulation.perception.sensor_noise import SensorNoise, ego_seeds, is_noisy
from drivora_service.simulation.planning import plan_episode
from drivora_service.simulation.plans.episode_plan import EpisodePlan
from drivora_service.simulation.plans.plan_arrays import privileged_senses, senses_of
from drivora_service.simulation.world import KIND_OF_ROLE, WorldFrames


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Perceived:
    """An ego's perception in the n steps in which its agent was asked.

    Attributes:
        first: Row of the trace with which it begins.
        senses: (6,) columns ``perception.Sense``, in the weather of the first step.
        sights: (n, N) ``perception.Sight`` of every actor.
        states: (n, N, 9) perceived states, columns ``Col``; NaN for actors that are not perceived.
    """

    first: int
    senses: FloatArray
    sights: ByteArray
    states: FloatArray


def perceive_again(scenario: Scenario, ego: EgoView) -> Perceived:
    """Computes what the agent of an ego perceived.

    Args:
        scenario: The scenario of the run.
        ego: The ego, which SUMO does not drive.

    Raises:
        Conflict: The scenario is not that of the run, or lacks actors that were added to it.
    """
    trace, network = ego.trace, ego.network
    plan = _plan_of(scenario, trace, network)
    known, joined = actor_heights(plan), _find_joined_models(plan.scenario, trace)
    heights = np.array((*known, *(model.height for _, model in joined)))
    join_steps = [step for step, _ in joined]
    count = len(trace.actors)
    sizes = np.array([(actor.length, actor.width) for actor in trace.actors])
    kinds = np.array([KIND_OF_ROLE[actor.role] for actor in trace.actors], dtype=np.int64)
    weather_at = weather_by_step(plan.scenario)
    usual = senses_of(weather_at(ego.first), trace.step_length)
    senses = privileged_senses() if trace.privileged[ego.row] else usual
    noise = SensorNoise(ego_seeds(plan.scenario.seed, trace.ego_count)[ego.row])
    draws = np.zeros((count, len(Draw)))
    seen, sights = empty_seen(count), np.zeros(count, dtype=np.int64)
    frames = WorldFrames(
        np.ascontiguousarray(trace.states), np.ascontiguousarray(trace.present), sizes
    )
    # In the last row of its part, an agent is not asked any more.
    steps = max(trace.ego_end_steps[ego.row] - ego.first, 0)
    found = Perceived(
        first=ego.first,
        senses=senses,
        sights=np.zeros((steps, count), dtype=np.uint8),
        states=np.full((steps, count, len(Col)), np.nan),
    )
    for k in range(steps):
        usual = senses_of(weather_at(ego.first + k), trace.step_length)
        if is_noisy(usual):
            # A draw has numbers for the actors that there are at the time.
            noise.draw(draws[: len(known) + bisect_right(join_steps, ego.first + k)])
        senses = privileged_senses() if trace.privileged[ego.row] else usual
        perceived = perceive(
            ego.row, ego.first + k, frames, heights, kinds, senses, draws, seen, sights
        )
        found.sights[k] = sights
        found.states[k, seen.ids[:perceived]] = seen.states[:perceived]
    return found


def _plan_of(scenario: Scenario, trace: Trace, network: RoadNetwork) -> EpisodePlan:
    """Returns the plan of a recorded run, with the seed that the run had."""
    seed = int(trace.meta.get("seed", scenario.seed))
    plan = plan_episode(replace(scenario, seed=seed), network)
    count = len(actor_heights(plan)) + len(_find_joined_models(plan.scenario, trace))
    egos = [ego.ego.id for ego in plan.egos]
    if count != len(trace.actors) or egos != [a.id for a in trace.actors[: len(egos)]]:
        raise Conflict(
            f"the run has {len(trace.actors)} actors and its scenario {count}: what was "
            "perceived among actors that a program added cannot be computed again"
        )
    return plan


def _find_joined_models(scenario: Scenario, trace: Trace) -> list[tuple[int, ActorModel]]:
    """Returns the steps in which actors joined a run, with their models, in order of the rows."""
    return [
        (
            step,
            actor_model(
                ActorKind.WALKER if isinstance(actor, NpcWalker) else ActorKind.VEHICLE,
                actor.model,
            ),
        )
        for step, actor in joining_actors(scenario)
        if step < trace.step_count - 1
    ]
