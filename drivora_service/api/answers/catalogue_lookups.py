"""The catalogues as one request sees them: every name is looked up once.

A lookup reads folders and files. The thousands of scenarios of a batch name the same few networks
and agents, and all of them are to be judged by the same state of the installation.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from drivora_service.errors import Problem, UnknownName
from drivora_service.networks.catalogue import NetworkLookup
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.checks.agent_checks import AgentDirectory


class KnownNetworks:
    """Networks by name, each looked up once; also those that do not exist."""

    def __init__(self, networks: NetworkLookup) -> None:
        self._networks = networks
        self._found: dict[str, RoadNetwork | UnknownName] = {}

    def get(self, name: str) -> RoadNetwork:
        """Returns a network.

        Raises:
            UnknownName: There is no such network.
            NetworkError: Its file cannot be used.
        """
        if name not in self._found:
            try:
                self._found[name] = self._networks.get(name)
            except UnknownName as error:
                self._found[name] = error
        found = self._found[name]
        if isinstance(found, UnknownName):
            raise found.with_traceback(None)
        return found


class KnownAgents(AgentDirectory):
    """Agents by name, each with its parameters looked up once."""

    def __init__(self, agents: AgentDirectory) -> None:
        self._agents = agents
        self._names = tuple(agents)
        self._reasons: dict[str, str] = {}
        self._problems: dict[tuple[str, str], tuple[Problem, ...]] = {}
        self._models: dict[tuple[str, str], str] = {}

    def __getitem__(self, name: str) -> str:
        if name not in self._reasons:
            self._reasons[name] = self._agents[name]
        return self._reasons[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        """Finds what is wrong with the parameters of an agent that exists."""
        key = name, _key(parameters)
        if key not in self._problems:
            self._problems[key] = self._agents.parameter_problems(name, parameters)
        return self._problems[key]

    def lane_change_model(self, name: str, parameters: Mapping[str, Any]) -> str:
        """Returns the lane-change model that SUMO must have in a run of an agent; "": any."""
        key = name, _key(parameters)
        if key not in self._models:
            self._models[key] = self._agents.lane_change_model(name, parameters)
        return self._models[key]


def _key(parameters: Mapping[str, Any]) -> str:
    return json.dumps(dict(parameters), default=repr) if parameters else ""
