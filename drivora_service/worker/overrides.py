"""The values of a run's specification that override those of its scenario."""

from __future__ import annotations

from dataclasses import replace

from drivora_service.runs.report import RunSpec
from drivora_service.scenario.model import AgentChoice, Scenario


def with_overrides(scenario: Scenario, spec: RunSpec) -> Scenario:
    """Returns what a run drives: a scenario with the agent and the seed of the specification."""
    if spec.agent:
        choice = AgentChoice(name=spec.agent)
        egos = tuple(
            ego if ego.agent.name == spec.agent else replace(ego, agent=choice)
            for ego in scenario.ego_vehicles
        )
        scenario = replace(scenario, ego_vehicles=egos)
    return scenario if spec.seed is None else replace(scenario, seed=spec.seed)
