"""Checks the agents that a document or a scenario names against the directory of agents."""

from __future__ import annotations

import difflib
from abc import abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from drivora_service.errors import Problem
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import EgoDocument
from drivora_service.scenario.model import EgoVehicle, Scenario
from drivora_service.scenario.plain_data import pointer


class AgentDirectory(Mapping[str, str]):
    """The agents that exist, each with the reason why it cannot be used, or "".

    What a plain mapping does not know is which parameters an agent takes.
    """

    @abstractmethod
    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        """Finds what is wrong with the parameters of an agent that exists.

        Returns:
            With pointers that begin at the parameters.
        """

    @abstractmethod
    def lane_change_model(self, name: str, parameters: Mapping[str, Any]) -> str:
        """Returns the lane-change model that SUMO must have in a run of this agent; "": any."""


def check_agents(
    content: ScenarioDocument | Scenario, agents: Collection[str] | None, driven_by: str
) -> list[Problem]:
    """Checks the agents of all egos.

    Args:
        content: Names them.
        agents: Those that exist; in a mapping, with the reason why one cannot be used, or ""; in a
            directory, with their parameters. ``None``: any will do.
        driven_by: Drives every ego in place of the agent that the content names, with the
            parameters of the egos that name it; "": as named.
    """
    if agents is None:
        return []
    egos: Sequence[EgoDocument | EgoVehicle] = content.ego_vehicles
    problems = [
        problem
        for index, ego in enumerate(egos)
        if (name := _agent_name(ego)) is not None and driven_by in ("", name)
        for problem in _check_ego(index, ego, name, agents)
    ]
    if not problems and isinstance(agents, AgentDirectory):
        problems.extend(_check_team(egos, agents, driven_by))
    return problems


def _agent_name(ego: EgoDocument | EgoVehicle) -> str | None:
    """Returns the name of an ego's agent; ``None`` where a document names none."""
    return ego.agent_name if isinstance(ego, EgoDocument) else ego.agent.name


def _check_ego(
    index: int, ego: EgoDocument | EgoVehicle, name: str, agents: Collection[str]
) -> Iterator[Problem]:
    key: tuple[str, ...] = ("config_path",) if ego.agent is None else ("agent", "name")
    place = pointer(("ego_vehicles", index, *key))
    if name not in agents:
        close = difflib.get_close_matches(name, sorted(agents), n=3) or sorted(agents)
        yield Problem(
            pointer=place,
            code="unknown_agent",
            message=f"found agent {name!r}, which is not in the catalogue; known: "
            f"{', '.join(close)}. See `drivora agents list`",
        )
        return
    reason = agents[name] if isinstance(agents, Mapping) else ""
    if reason:
        yield Problem(
            pointer=place,
            code="agent_not_installed",
            message=f"found agent {name!r}, which cannot be run here: {reason}",
        )
    elif isinstance(agents, AgentDirectory) and ego.agent is not None:
        above = pointer(("ego_vehicles", index, "agent", "parameters"))
        for problem in agents.parameter_problems(name, ego.agent.parameters):
            yield replace(problem, pointer=f"{above}{problem.pointer}")


def _check_team(
    egos: Sequence[EgoDocument | EgoVehicle], agents: AgentDirectory, driven_by: str
) -> Iterator[Problem]:
    """Finds egos whose drivers cannot drive in one run."""
    first: tuple[int, str] | None = None
    for index, ego in enumerate(egos):
        named = _agent_name(ego)
        name = driven_by or named
        if name is None or name not in agents:
            continue
        own = ego.agent.parameters if ego.agent is not None and name == named else {}
        wanted = agents.lane_change_model(name, own)
        if not wanted:
            continue
        if first is None:
            first = index, wanted
        elif wanted != first[1]:
            yield Problem(
                pointer=pointer(("ego_vehicles", index)),
                code="other_lane_change_model",
                message=f"found an ego that SUMO drives by the lane-change model {wanted}, and "
                f"ego number {first[0]} by {first[1]}; SUMO has one in a run: set "
                "`lane_change_model` to the same for all",
            )
