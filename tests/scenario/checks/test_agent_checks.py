"""The agents that a document names are checked, with their parameters and together."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from typing import Any, Final

import pytest

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.scenario.checks.agent_checks import AgentDirectory
from drivora_service.scenario.validation import validate_data


@pytest.mark.parametrize(
    ("choice", "pointer"),
    [
        ({"agent": {"name": "imd"}}, "/ego_vehicles/0/agent/name"),
        ({"config_path": "configs/imd.yaml"}, "/ego_vehicles/0/config_path"),
    ],
)
def test_unknown_agents(
    refused: Any, good: dict[str, Any], choice: dict[str, Any], pointer: str
) -> None:
    del good["ego_vehicles"][0]["agent"]
    good["ego_vehicles"][0].update(choice)
    (problem,) = refused(good)
    assert (problem.pointer, problem.code) == (pointer, "unknown_agent")
    assert "did you mean 'idm'? Known: idm" in problem.message


class Drivers(AgentDirectory):
    """Agents of which one cannot be used; none of them takes a negative parameter."""

    known: Final = {"idm": "", "slow": "", "gone": "run `install`"}

    def __getitem__(self, name: str) -> str:
        return self.known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.known)

    def __len__(self) -> int:
        return len(self.known)

    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        return tuple(
            Problem(pointer=f"/{key}", code="negative", message=f"{name}: {key} is {value}")
            for key, value in parameters.items()
            if value < 0
        )

    def lane_change_model(self, name: str, parameters: Mapping[str, Any]) -> str:
        return str(parameters.get("model", "")) if name == "slow" else ""


class WithModels(Drivers):
    """Takes any parameters."""

    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        return ()


def two_drivers(good: dict[str, Any]) -> dict[str, Any]:
    first, second = good["ego_vehicles"][0], copy.deepcopy(good["ego_vehicles"][0])
    second["id"], second["start_time"] = "ego_1", 20.0
    second["route"][0]["x"], second["route"][1]["x"] = 80.0, 20.0
    first["agent"] = {"name": "idm", "parameters": {"a": -1, "b": 2, "c": -3}}
    second["agent"] = {"name": "slow", "parameters": {"a": -4}}
    good["ego_vehicles"] = [first, second]
    return good


@pytest.mark.parametrize(
    ("driven_by", "places"),
    [
        ("", ["0/agent/parameters/a", "0/agent/parameters/c", "1/agent/parameters/a"]),
        ("idm", ["0/agent/parameters/a", "0/agent/parameters/c"]),
        ("slow", ["1/agent/parameters/a"]),
    ],
)
def test_parameters_that_an_agent_does_not_take_are_named_with_their_place(
    networks: NetworkCatalogue, good: dict[str, Any], driven_by: str, places: list[str]
) -> None:
    with pytest.raises(InvalidDocument) as caught:
        validate_data(two_drivers(good), networks, Drivers(), driven_by=driven_by)
    assert [p.pointer for p in caught.value.problems] == [f"/ego_vehicles/{at}" for at in places]
    assert {problem.code for problem in caught.value.problems} == {"negative"}


def test_parameters_of_egos_that_another_agent_will_drive_do_not_matter(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    content = two_drivers(good)
    content["ego_vehicles"][0]["agent"]["name"] = "nobody"
    content["ego_vehicles"][1]["agent"]["name"] = "gone"
    valid = validate_data(content, networks, Drivers(), driven_by="idm")
    assert len(valid.scenario.ego_vehicles) == 2


@pytest.mark.parametrize(
    ("models", "driven_by", "found"),
    [
        (("A", "A"), "", []),
        (("A", "B"), "", ["/ego_vehicles/1"]),
        (("A", None), "", []),
        (("A", None), "slow", []),
        (("A", "B"), "idm", []),
    ],
)
def test_egos_whose_drivers_cannot_drive_in_one_run(
    networks: NetworkCatalogue,
    good: dict[str, Any],
    models: tuple[str | None, ...],
    driven_by: str,
    found: list[str],
) -> None:
    content = two_drivers(good)
    for ego, model in zip(content["ego_vehicles"], models, strict=True):
        ego["agent"] = {"name": "idm"}
        if model is not None:
            ego["agent"] = {"name": "slow", "parameters": {"model": model}}
    problems: list[Problem] = []
    try:
        validate_data(content, networks, WithModels(), driven_by=driven_by)
    except InvalidDocument as error:
        problems.extend(error.problems)
    assert [problem.pointer for problem in problems] == found
    assert {problem.code for problem in problems} <= {"other_lane_change_model"}


def test_of_an_agent_that_cannot_be_used_only_that_is_told(
    networks: NetworkCatalogue, good: dict[str, Any]
) -> None:
    good["ego_vehicles"][0]["agent"] = {"name": "gone", "parameters": {"a": -1}}
    with pytest.raises(InvalidDocument) as caught:
        validate_data(good, networks, Drivers())
    assert [problem.code for problem in caught.value.problems] == ["agent_not_installed"]


def test_no_agent_is_noted(valid: Any, good: dict[str, Any]) -> None:
    del good["ego_vehicles"][0]["agent"]
    result = valid(good)
    assert result.scenario.ego_vehicles[0].agent.name == "idm"
    assert result.notes == ("ego 'ego_0' names no agent; 'idm' drives it",)
