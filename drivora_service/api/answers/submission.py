"""Runs to be queued, from posted documents."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from drivora_service.api.answers.catalogue_lookups import KnownAgents, KnownNetworks
from drivora_service.api.context import ApiContext
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.known_names import unknown_name_message
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.agent_parameters import AgentParameter, with_agent_parameters
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.overrides import with_overrides
from drivora_service.store.runs.run_records import NewRun, RunOptions

if TYPE_CHECKING:
    from drivora_service.agents.catalogue import AgentCatalogue
    from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
    from drivora_service.scenario.validation import ValidScenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Overrides:
    """The values of a request that override those of its documents.

    Attributes:
        options: Options of its runs.
        parameters: Parameters of the agents; they become part of the scenarios.
    """

    options: RunOptions
    parameters: tuple[AgentParameter, ...] = ()

    @property
    def agent(self) -> str:
        """The agent that drives every ego; "": as documented."""
        return self.options.agent_override


class Checker:
    """Checks the documents of one request; what they have in common is looked up once."""

    def __init__(self, context: ApiContext, overrides: Overrides) -> None:
        self._networks = KnownNetworks(context.networks)
        self._agents = KnownAgents(context.agents.availability())
        self._overrides = overrides

    def validate(
        self, data: bytes | Mapping[str, Any], form: Literal["json", "yaml"] = "json"
    ) -> ValidScenario:
        """Parses and checks a document.

        Raises:
            InvalidDocument: It cannot be run; every problem is named.
        """
        # Imported here: it needs the compiler of kernels.
        from drivora_service.scenario.validation import validate_data

        agent = self._overrides.agent
        valid = validate_data(data, self._networks, self._agents, form, driven_by=agent)
        scenario = with_agent_parameters(
            valid.scenario, self._overrides.parameters, self._agents, driven_by=agent
        )
        return replace(valid, scenario=scenario)


def check_overrides(context: ApiContext, overrides: Overrides) -> None:
    """Checks an agent's name.

    Raises:
        InvalidDocument: There is no such agent, or it is not installed.
    """
    if not overrides.agent:
        return
    known = context.agents.availability()
    if overrides.agent not in known:
        message = unknown_name_message("agent", overrides.agent, known)
        raise InvalidDocument((Problem(pointer="", code="unknown_agent", message=message),))
    if known[overrides.agent]:
        message = f"agent {overrides.agent!r} cannot be run here: {known[overrides.agent]}"
        raise InvalidDocument((Problem(pointer="", code="agent_not_installed", message=message),))


def check_definition(context: ApiContext, definition: FailureDefinition, pointer: str = "") -> None:
    """Checks the oracles that a definition of failures names, also as known failures.

    Args:
        context: The service.
        definition: The definition.
        pointer: Its place in the request; "": a parameter.

    Raises:
        InvalidDocument: There is no such oracle.
    """
    known = context.oracles.names()
    problems = [
        _unknown_oracle(name, known, f"{pointer}/oracles/{place}" if pointer else "")
        for place, name in enumerate(definition.oracles or ())
        if name not in known
    ]
    # The ADS itself may fail, which no oracle finds; "" is any.
    of_known = (str(RunStatus.AGENT_FAILED), *known)
    problems += [
        _unknown_oracle(one.oracle, of_known, f"{pointer}/known/{place}/oracle" if pointer else "")
        for place, one in enumerate(definition.known)
        if one.oracle not in ("", *of_known)
    ]
    if problems:
        raise InvalidDocument(tuple(problems))


def _unknown_oracle(name: str, known: Sequence[str], pointer: str) -> Problem:
    return Problem(
        pointer=pointer,
        code="unknown_oracle",
        message=unknown_name_message("oracle", name, known),
    )


def new_run(
    valid: ValidScenario, options: RunOptions, agents: AgentCatalogue, *, item: int, label: str
) -> NewRun:
    """Returns the run of a scenario that can be run.

    Args:
        valid: The scenario.
        options: Options of the run.
        agents: The agents, for the defaults of their parameters.
        item: Place in the batch.
        label: Display name.
    """
    scenario = valid.scenario
    driven = with_overrides(scenario, agent=options.agent_override, seed=None)
    document = canonical_json(scenario)
    names = dict.fromkeys(ego.agent.name for ego in scenario.ego_vehicles)
    return NewRun(
        document=document,
        scenario_sha256=hashlib.sha256(document.encode()).hexdigest(),
        town=scenario.map_region.town,
        agent=options.agent_override or ",".join(names),
        configuration=agents.configuration(ego.agent for ego in driven.ego_vehicles),
        options=options,
        label=label,
        item=item,
    )
