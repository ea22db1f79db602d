"""Checks of a document's or a scenario's agents against the directory of agents."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from drivora_service.errors import Problem
from drivora_service.known_names import unknown_name_message
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import EgoDocument
from drivora_service.scenario.model import EgoVehicle, Scenario
from drivora_service.scenario.plain_data import pointer


class AgentDirectory(Mapping[str, str]):
    """The existing agents, each with the reason why it cannot be used, or "".

    Unlike a plain mapping, it knows the parameters of the agents.
    """

    @abstractmethod
    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        """Returns the problems of an existing agent's parameters.

        Returns:
            Problems with pointers relative to the parameters.
        """

    @abstractmethod
    def lane_change_model(self, name: str, parameters: Mapping[str, Any]) -> str:
        """Returns the lane-change model that SUMO must use in a run of this agent; "": any."""


def check_agents(
    content: ScenarioDocument | Scenario, agents: Collection[str] | None, driven_by: str
) -> list[Problem]:
    """Checks the agents of all egos.

    Args:
        content: Document or scenario with the egos.
        agents: The existing agents; in a mapping, with the reason why one cannot be used, or ""; in
            a directory, with their parameters. ``None``: any name is accepted.
        driven_by: Agent that drives every ego instead of those of the content, with the
            parameters of the egos that name it; "": no replacement.
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
    """Returns the name of an ego's agent; ``None`` if a document has none."""
    return ego.agent_name if isinstance(ego, EgoDocument) else ego.agent.name


def _check_ego(
    index: int, ego: EgoDocument | EgoVehicle, name: str, agents: Collection[str]
) -> Iterator[Problem]:
    key: tuple[str, ...] = ("config_path",) if ego.agent is None else ("agent", "name")
    place = pointer(("ego_vehicles", index, *key))
    if name not in agents:
        yield Problem(
            pointer=place,
            code="unknown_agent",
            message=f"{unknown_name_message('agent', name, sorted(agents))}. "
            "See `drivora agents list`",
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
    """Yields problems for egos whose drivers exclude each other in one run."""
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
