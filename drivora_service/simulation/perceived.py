"""What an ego's agent perceived in a recorded run, computed again from the recording.

Perception is a function of the frames, the weather, the heights of the actors, and random draws
that follow from the seed. The trace has the frames, the scenario all else. The kernel and the draws
are those of the episode.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from drivora_service.errors import Conflict
from drivora_service.geometry.arrays import ByteArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.model import Scenario
from drivora_service.simulation.actor_heights import actor_heights
from drivora_service.simulation.arrays import privileged_senses, senses_of
from drivora_service.simulation.perception import perceive
from drivora_service.simulation.plan import EpisodePlan, plan_episode
from drivora_service.simulation.sensor_noise import SensorNoise, ego_seeds, is_noisy
from drivora_service.simulation.world import KIND_OF_ROLE


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Perceived:
    """An ego's perception in the n steps in which its agent was asked.

    Attributes:
        first: Row of the trace with which it begins.
        senses: (6,) columns ``perception.Sense``.
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
        Conflict: The scenario is not that of the run, or actors were added while it ran.
    """
    trace, network = ego.trace, ego.network
    plan = _plan_of(scenario, trace, network)
    heights = np.array(actor_heights(plan))
    count = len(trace.actors)
    sizes = np.array([(actor.length, actor.width) for actor in trace.actors])
    kinds = np.array([KIND_OF_ROLE[actor.role] for actor in trace.actors], dtype=np.int64)
    usual = senses_of(plan.weather, trace.step_length)
    senses = privileged_senses() if trace.privileged[ego.row] else usual
    noise = SensorNoise(ego_seeds(plan.scenario.seed, trace.ego_count)[ego.row])
    draws = np.zeros((count, 5))
    seen, seen_sizes = np.zeros((count, len(Col))), np.zeros((count, 2))
    numbers, sights = np.zeros((2, count), dtype=np.int64), np.zeros(count, dtype=np.int64)
    frames = np.ascontiguousarray(trace.states)
    presence = np.ascontiguousarray(trace.present)
    # In the last row of its part, an agent is not asked any more.
    steps = max(trace.ego_end_steps[ego.row] - ego.first, 0)
    found = Perceived(
        first=ego.first,
        senses=senses,
        sights=np.zeros((steps, count), dtype=np.uint8),
        states=np.full((steps, count, len(Col)), np.nan),
    )
    for k in range(steps):
        if is_noisy(usual):
            noise.draw(draws)
        perceived = perceive(
            ego.row, ego.first + k, frames, presence, sizes, heights, kinds, senses, draws,
            seen, seen_sizes, numbers, sights,
        )  # fmt: skip
        found.sights[k] = sights
        found.states[k, numbers[1, :perceived]] = seen[:perceived]
    return found


def _plan_of(scenario: Scenario, trace: Trace, network: RoadNetwork) -> EpisodePlan:
    """Returns the plan of a recorded run, with the seed that the run had."""
    seed = int(trace.meta.get("seed", scenario.seed))
    plan = plan_episode(replace(scenario, seed=seed), network)
    heights = actor_heights(plan)
    egos = [ego.ego.id for ego in plan.egos]
    if len(heights) != len(trace.actors) or egos != [a.id for a in trace.actors[: len(egos)]]:
        raise Conflict(
            f"the run has {len(trace.actors)} actors and its scenario {len(heights)}: what was "
            "perceived among actors that a program added cannot be computed again"
        )
    return plan
