"""What an agent brings to the catalogue."""

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

    ``drivora agents install NAME`` fetches the files into a folder of the agent's own; until then
    its entry says that it is not installed. Drivora itself ships none of them.

    Attributes:
        entry: As for every agent; ``licence`` is shown before anything is fetched.
        parameters: As :attr:`AgentPlugin.parameters`.
        files: What to fetch. A change here makes an older installation count as none.
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
    """What an entry point of the group ``drivora_service.agents`` gives: an entry and a factory.

    :func:`agent_plugin` makes one of an agent whose parameters are the fields of a dataclass.

    Attributes:
        entry: What the catalogue says of it.
        create: Takes the document's parameters; raises ``AgentError`` if it cannot use them.
        parameters: A frozen dataclass with a default for every field: documents are checked against
            its types and limits before anything runs. ``None``: only ``create`` knows.
    """

    entry: AgentEntry
    create: Callable[[Mapping[str, Any]], Agent | SumoDriver]
    parameters: type[DataclassInstance] | None = None

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.entry.name


def agent_plugin(
    entry: AgentEntry, parameters: type[P], make: Callable[[P], Agent | SumoDriver]
) -> AgentPlugin:
    """Makes the plug-in of an agent whose parameters are the fields of a dataclass.

    Args:
        entry: What the catalogue says of it.
        parameters: As :attr:`AgentPlugin.parameters`.
        make: Makes the agent from what a document sets.
    """

    def create(written: Mapping[str, Any]) -> Agent | SumoDriver:
        return make(read_agent_parameters(entry.name, parameters, written))

    return AgentPlugin(entry=entry, create=create, parameters=parameters)


def read_agent_parameters(name: str, type_: type[P], written: Mapping[str, Any]) -> P:
    """Makes an agent's parameters from what a document sets.

    Raises:
        AgentError: It sets what the agent does not take.
    """
    error = partial(AgentError, cause="agent_parameters")
    return read_parameters(type_, written, of=f"agent {name!r}", error=error)
