"""The heights of actors, which decide which of them hide others."""

from __future__ import annotations

from drivora_service.simulation.plans.episode_plan import EpisodePlan
from drivora_service.simulation.traffic import background


def actor_heights(plan: EpisodePlan) -> tuple[float, ...]:
    """Returns the heights of the actors of a plan in the order of their rows, metres."""
    flow = plan.scenario.background_traffic
    return (
        *(ego.model.height for ego in plan.egos),
        *(follower.model.height for follower in plan.followers),
        *(driven.model.height for driven in plan.driven),
        *(item.model.height for item in plan.obstacles),
        *(background.HEIGHT for _ in range(0 if flow is None else flow.count)),
    )
