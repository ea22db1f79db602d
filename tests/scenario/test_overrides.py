"""The agent and the seed that drive a run in place of those of its scenario."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from drivora_service.scenario.model import AgentChoice
from drivora_service.scenario.overrides import with_overrides

FAST = AgentChoice(name="idm", parameters={"speed_factor": 1.2})
OTHER = AgentChoice(name="nmpc")


@pytest.mark.parametrize(
    ("agent", "driven"),
    [
        ("", [("idm", {"speed_factor": 1.2}), ("nmpc", {})]),
        # Only an ego of this agent keeps its parameters.
        ("idm", [("idm", {"speed_factor": 1.2}), ("idm", {})]),
        ("nmpc", [("nmpc", {}), ("nmpc", {})]),
        ("pdm-closed", [("pdm-closed", {}), ("pdm-closed", {})]),
    ],
)
def test_one_agent_drives_every_ego(
    good: dict[str, Any], valid: Any, agent: str, driven: list[tuple[str, dict[str, float]]]
) -> None:
    scenario = valid(good).scenario
    (ego,) = scenario.ego_vehicles
    egos = (replace(ego, agent=FAST), replace(ego, agent=OTHER))
    found = with_overrides(replace(scenario, ego_vehicles=egos), agent=agent, seed=None)
    assert [(one.agent.name, dict(one.agent.parameters)) for one in found.ego_vehicles] == driven
    assert found.seed == scenario.seed


def test_the_seed_is_the_one_that_was_given(good: dict[str, Any], valid: Any) -> None:
    assert with_overrides(valid(good).scenario, agent="", seed=17).seed == 17
