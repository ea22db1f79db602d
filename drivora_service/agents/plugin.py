"""Plug-ins of agents for the catalogue."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from drivora_service.agents.entry import AgentEntry
from drivora_service.agents.interface import Agent
from drivora_service.agents.package_files import PackageFile
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError
from drivora_service.parameters import read_parameters

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

P = TypeVar("P", bound="DataclassInstance")


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchedAgentPlugin:
    """A built-in agent that runs in process and needs files of other packages, such as weights.

    ``drivora agents install NAME`` fetches the files into the agent's folder; until then
    its entry is not installed. Drivora itself ships none of them.

    Attributes:
        entry: Entry of the agent; ``licence`` is shown before fetching.
        parameters: As :attr:`AgentPlugin.parameters`.
        files: Files to fetch. A change invalidates older installations.
        create: Takes the document's parameters and the folder that holds the files; raises
            ``AgentError`` if it cannot use them.
    """

    entry: AgentEntry
    parameters: type[DataclassInstance]
    files: tuple[PackageFile, ...]
    create: Callable[[Mapping[str, Any], Path], Agent]

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.entry.name


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentPlugin:
    """The object of an entry point of the group ``drivora_service.agents``: an entry and a factory.

    :func:`agent_plugin` makes one of an agent whose parameters are the fields of a dataclass.

    Attributes:
        entry: Entry of the catalogue.
        create: Takes the document's parameters; raises ``AgentError`` if it cannot use them.
        parameters: A frozen dataclass with a default for every field: which checks documents by
            its types and limits before runs. ``None``: only ``create`` checks.
    """

    entry: AgentEntry
    create: Callable[[Mapping[str, Any]], Agent | SumoDriver]
    parameters: type[DataclassInstance] | None = None

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.entry.name


@dataclass(frozen=True, slots=True, kw_only=True)
class NoParameters:
    """The parameters of an agent that takes none."""


def agent_plugin(
    entry: AgentEntry, parameters: type[P], make: Callable[[P], Agent | SumoDriver]
) -> AgentPlugin:
    """Makes the plug-in of an agent whose parameters are the fields of a dataclass.

    Args:
        entry: Entry of the catalogue.
        parameters: As :attr:`AgentPlugin.parameters`.
        make: Makes the agent from the parameters.
    """

    def create(written: Mapping[str, Any]) -> Agent | SumoDriver:
        return make(read_agent_parameters(entry.name, parameters, written))

    return AgentPlugin(entry=entry, create=create, parameters=parameters)


def read_agent_parameters(name: str, type_: type[P], written: Mapping[str, Any]) -> P:
    """Returns an agent's parameters from those of a document.

    Raises:
        AgentError: The agent rejects a parameter.
    """
    error = partial(AgentError, cause="agent_parameters")
    return read_parameters(type_, written, of=f"agent {name!r}", error=error)
