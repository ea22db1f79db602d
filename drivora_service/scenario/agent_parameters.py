"""Parameters of agents that a command or a request sets, overriding the documents."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.scenario.checks.agent_checks import AgentDirectory
from drivora_service.scenario.model import AgentChoice, Scenario
from drivora_service.scenario.plain_data import plain_data, pointer


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentParameter:
    """A parameter of an agent and its value.

    Attributes:
        ego: Id of the ego whose agent it is for; "" for the agents of all egos.
        value: Value as in a document.
    """

    ego: str
    name: str
    value: Any


def read_agent_parameter(text: str) -> AgentParameter:
    """Reads ``NAME=VALUE`` or ``EGO:NAME=VALUE``; a value that is not JSON is text.

    Raises:
        InvalidDocument: It has another form, or its value cannot be read or is nested too deeply.
    """
    place, equals, value = text.partition("=")
    ego, _, name = place.rpartition(":")
    if not equals or not name:
        message = (
            f"found {text!r}; allowed: NAME=VALUE, or EGO:NAME=VALUE for the agent of one ego, "
            "such as ego_0:speed_factor=1.2"
        )
        raise InvalidDocument((Problem(pointer="", code="agent_parameter", message=message),))
    try:
        read = json.loads(value)
    except ValueError:
        read = value
    except RecursionError:
        message = f"the value of {name[:80]!r} is nested too deeply; allowed: what its agent takes"
        raise InvalidDocument(
            (Problem(pointer="", code="agent_parameter", message=message),)
        ) from None
    # It becomes part of the scenario, so the depth limit of documents applies.
    plain_data({name: read})
    return AgentParameter(ego=ego, name=name, value=read)


def with_agent_parameters(
    scenario: Scenario,
    parameters: Sequence[AgentParameter],
    agents: Collection[str] | None,
    *,
    driven_by: str = "",
) -> Scenario:
    """Returns a scenario with the parameters set for its egos' agents.

    Args:
        scenario: A valid scenario.
        parameters: Parameters; a later one replaces an earlier one of the same ego and name.
        agents: The existing agents; in an ``AgentDirectory``, with their parameters.
        driven_by: Agent that drives every ego instead of the documented one; "": no replacement.

    Raises:
        InvalidDocument: An agent rejects them, or the ego does not exist; with all problems.
    """
    if not parameters:
        return scenario
    known = [ego.id for ego in scenario.ego_vehicles]
    problems = [
        Problem(
            pointer="",
            code="unknown_ego",
            message=f"the parameter {parameter.name!r} is set for the ego {parameter.ego!r}, which "
            f"is not in the scenario; its egos: {', '.join(known)}",
        )
        for parameter in parameters
        if parameter.ego and parameter.ego not in known
    ]
    egos = []
    for index, ego in enumerate(scenario.ego_vehicles):
        given = {p.name: p.value for p in parameters if p.ego in ("", ego.id)}
        name = driven_by or ego.agent.name
        base = ego.agent.parameters if name == ego.agent.name else {}
        problems += _problems(index, name, given, agents)
        egos.append(replace(ego, agent=AgentChoice(name=name, parameters={**base, **given})))
    if problems:
        raise InvalidDocument(tuple(problems))
    return replace(scenario, ego_vehicles=tuple(egos))


def _problems(
    index: int, name: str, given: dict[str, Any], agents: Collection[str] | None
) -> Iterator[Problem]:
    if not given or not isinstance(agents, AgentDirectory):
        return
    above = pointer(("ego_vehicles", index, "agent", "parameters"))
    for problem in agents.parameter_problems(name, given):
        yield replace(problem, pointer=f"{above}{problem.pointer}")
