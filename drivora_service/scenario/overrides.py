"""The agent and the seed of a run in place of those of its scenario."""

from __future__ import annotations

from dataclasses import replace

from drivora_service.scenario.model import AgentChoice, Scenario


def with_overrides(scenario: Scenario, *, agent: str, seed: int | None) -> Scenario:
    """Returns what a run drives.

    Args:
        scenario: The scenario as it was posted.
        agent: Agent that drives every ego instead of the documented ones, without parameters unless
            it is the documented one; "": none.
        seed: Seed instead of the documented one, or ``None``.
    """
    if agent:
        choice = AgentChoice(name=agent)
        egos = tuple(
            ego if ego.agent.name == agent else replace(ego, agent=choice)
            for ego in scenario.ego_vehicles
        )
        scenario = replace(scenario, ego_vehicles=egos)
    return scenario if seed is None else replace(scenario, seed=seed)
