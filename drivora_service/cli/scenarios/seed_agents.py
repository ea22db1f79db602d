"""Parameters of the agent of generated seeds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from drivora_service.errors import ConfigurationError, InvalidDocument
from drivora_service.scenario.agent_parameters import read_agent_parameter
from drivora_service.scenario.entities import AgentDocument

if TYPE_CHECKING:
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.scenario.documents import ScenarioDocument


def read_parameters_of(
    agents: AgentCatalogue, agent: str, texts: Sequence[str]
) -> Mapping[str, Any]:
    """Reads parameters as ``NAME=VALUE`` and checks them.

    Args:
        agents: The catalogue of agents.
        agent: The agent that takes them.
        texts: The parameters; a later one replaces an earlier one of the same name.

    Raises:
        ConfigurationError: One has another form, names an ego, or the agent does not take it.
    """
    try:
        read = [read_agent_parameter(text) for text in texts]
    except InvalidDocument as error:
        raise ConfigurationError("; ".join(one.message for one in error.problems)) from error
    for parameter in read:
        if parameter.ego:
            raise ConfigurationError(
                f"found the ego {parameter.ego!r} before {parameter.name!r}; seeds have one ego: "
                "write NAME=VALUE"
            )
    given = {parameter.name: parameter.value for parameter in read}
    problems = agents.parameter_problems(agent, given)
    if problems:
        raise ConfigurationError("; ".join(problem.message for problem in problems))
    return given


def with_parameters(document: ScenarioDocument, parameters: Mapping[str, Any]) -> ScenarioDocument:
    """Returns a document whose egos' agents have these parameters."""
    if not parameters:
        return document
    egos = tuple(
        ego.model_copy(
            update={"agent": AgentDocument(name=ego.agent.name, parameters=dict(parameters))}
        )
        for ego in document.ego_vehicles
        if ego.agent is not None
    )
    return document.model_copy(update={"ego_vehicles": egos})
