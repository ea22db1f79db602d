from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from drivora_service.api.answers.catalogue_lookups import KnownAgents, KnownNetworks
from drivora_service.errors import Problem, UnknownName
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.agent_checks import AgentDirectory


class CountedNetworks:
    def __init__(self) -> None:
        self._networks = NetworkCatalogue(shipped_networks())
        self.asked: list[str] = []

    def get(self, name: str) -> RoadNetwork:
        self.asked.append(name)
        return self._networks.get(name)


class CountedAgents(AgentDirectory):
    def __init__(self) -> None:
        self.asked: list[str] = []

    def __getitem__(self, name: str) -> str:
        self.asked.append(name)
        return {"idm": "", "pdm": "not here"}[name]

    def __iter__(self) -> Iterator[str]:
        return iter(("idm", "pdm"))

    def __len__(self) -> int:
        return 2

    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        self.asked.append(f"{name} {dict(parameters)}")
        return tuple(Problem(pointer=f"/{key}", code="no", message="no") for key in parameters)

    def lane_change_model(self, name: str, parameters: Mapping[str, Any]) -> str:
        self.asked.append(f"{name} model {dict(parameters)}")
        return str(parameters.get("model", ""))


def test_a_network_is_looked_up_once_and_so_is_one_that_is_missing() -> None:
    counted = CountedNetworks()
    known = KnownNetworks(counted)
    assert {known.get("tee-town").name for _ in range(3)} == {"tee-town"}
    for _ in range(3):
        with pytest.raises(UnknownName, match="Town99"):
            known.get("Town99")
    assert counted.asked == ["tee-town", "Town99"]


def test_an_agent_is_looked_up_once_with_each_of_its_parameters() -> None:
    counted = CountedAgents()
    known = KnownAgents(counted)
    for _ in range(3):
        assert (known["idm"], known["pdm"], "none" in known, list(known)) == (
            "",
            "not here",
            False,
            ["idm", "pdm"],
        )
        assert known.parameter_problems("idm", {}) == ()
        assert len(known.parameter_problems("idm", {"a": 1, "b": 2})) == 2
        assert known.lane_change_model("idm", {"model": "SL2015"}) == "SL2015"
        assert known.lane_change_model("idm", {"model": "LC2013"}) == "LC2013"
    once = [name for name in counted.asked if name != "none"]
    assert len(once) == len(set(once)) == 6
