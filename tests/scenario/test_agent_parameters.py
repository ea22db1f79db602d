from __future__ import annotations

from typing import Any

import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.errors import InvalidDocument
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.agent_parameters import (
    AgentParameter,
    read_agent_parameter,
    with_agent_parameters,
)
from drivora_service.scenario.model import Scenario
from drivora_service.scenario.validation import validate_data

AGENTS = AgentCatalogue().availability()


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return validate_data(SCENARIO, NetworkCatalogue(shipped_networks()), AGENTS).scenario


@pytest.mark.parametrize(
    ("text", "ego", "name", "value"),
    [
        ("speed_factor=1.2", "", "speed_factor", 1.2),
        ("ego_0:speed_factor=1", "ego_0", "speed_factor", 1),
        ("lane_change_model=SL2015", "", "lane_change_model", "SL2015"),
        ('name="1"', "", "name", "1"),
        ("flag=true", "", "flag", True),
        ("text=a=b:c", "", "text", "a=b:c"),
        ("empty=", "", "empty", ""),
    ],
)
def test_reading(text: str, ego: str, name: str, value: Any) -> None:
    assert read_agent_parameter(text) == AgentParameter(ego=ego, name=name, value=value)


@pytest.mark.parametrize("text", ["", "speed_factor", "=1", "ego_0:=1"])
def test_other_forms_are_refused(text: str) -> None:
    with pytest.raises(InvalidDocument, match="allowed: NAME=VALUE"):
        read_agent_parameter(text)


def test_a_value_is_nested_no_deeper_than_a_document() -> None:
    deep = "[" * 31 + "]" * 31
    assert read_agent_parameter(f"list={deep}").name == "list"
    for levels in (40, 300, 100_000):
        with pytest.raises(InvalidDocument, match="nest"):
            read_agent_parameter(f"list={'[' * levels}{']' * levels}")


def given(*texts: str) -> list[AgentParameter]:
    return [read_agent_parameter(text) for text in texts]


def test_a_later_one_replaces_an_earlier_one(scenario: Scenario) -> None:
    changed = with_agent_parameters(
        scenario, given("speed_factor=1.1", "ego:speed_factor=0.9"), AGENTS
    )
    (ego,) = changed.ego_vehicles
    assert (ego.agent.name, dict(ego.agent.parameters)) == ("idm", {"speed_factor": 0.9})


def test_those_of_the_documented_agent_are_left_behind(scenario: Scenario) -> None:
    slow = with_agent_parameters(scenario, given("speed_factor=0.9"), AGENTS)
    changed = with_agent_parameters(
        slow, given("lane_change_model=LC2013"), AGENTS, driven_by="sumo-idm"
    )
    (ego,) = changed.ego_vehicles
    assert ego.agent.name == "sumo-idm"
    assert dict(ego.agent.parameters) == {"lane_change_model": "LC2013"}


def test_every_problem_is_named_with_its_place(scenario: Scenario) -> None:
    wrong = given("speed=1", "speed_factor=fast", "ego_7:speed_factor=1")
    with pytest.raises(InvalidDocument) as caught:
        with_agent_parameters(scenario, wrong, AGENTS)
    ego, unknown, kind = caught.value.problems
    assert (ego.code, "its egos: ego" in ego.message) == ("unknown_ego", True)
    assert unknown.pointer == "/ego_vehicles/0/agent/parameters/speed"
    assert "agent 'idm' has no parameter 'speed'; known: speed_factor" in unknown.message
    assert kind.pointer == "/ego_vehicles/0/agent/parameters/speed_factor"
    assert 'speed_factor is "fast"; allowed: a number from 0.1 to 2' in kind.message
