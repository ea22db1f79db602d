"""Checks the agents that a document names, against whoever knows them."""

from __future__ import annotations

import difflib
from abc import abstractmethod
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

from drivora_service.errors import Problem
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.entities import EgoDocument
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


def check_agents(
    document: ScenarioDocument, agents: Collection[str] | None, driven_by: str
) -> list[Problem]:
    """Checks the agents of all egos.

    Args:
        document: Names them.
        agents: Those that exist; in a mapping, with the reason why one cannot be used, or ""; in a
            directory, with their parameters. ``None``: any will do.
        driven_by: Drives every ego in place of whom the document names, with the parameters of the
            egos that name it; "": as documented.
    """
    if agents is None:
        return []
    return [
        problem
        for index, ego in enumerate(document.ego_vehicles)
        if ego.agent_name is not None and driven_by in ("", ego.agent_name)
        for problem in _check_ego(index, ego, ego.agent_name, agents)
    ]


def _check_ego(
    index: int, ego: EgoDocument, name: str, agents: Collection[str]
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
