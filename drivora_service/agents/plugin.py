"""Plug-ins of agents for the catalogue."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import partial
from inspect import signature
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
    entry: AgentEntry,
    parameters: type[P] | None,
    make: Callable[[P], Agent | SumoDriver] | Callable[[], Agent | SumoDriver],
) -> AgentPlugin:
    """Makes the plug-in of an agent whose parameters are the fields of a dataclass.

    Args:
        entry: Entry of the catalogue.
        parameters: As :attr:`AgentPlugin.parameters`; ``None``: the agent takes none.
        make: Makes the agent from the parameters, or from nothing if it takes none.

    Raises:
        AgentError: The parameters are no such dataclass, or ``make`` does not take them.
    """
    type_: type[DataclassInstance] = NoParameters if parameters is None else parameters
    _check_parameters(entry.name, type_)
    takes_none = parameters is None and _accepts(make, 0)
    if not takes_none and not _accepts(make, 1):
        needed = "no argument" if parameters is None else "one argument, its parameters"
        raise AgentError(
            f"agent {entry.name!r}: `make` must be callable with {needed}", cause="agent_plugin"
        )
    called: Callable[..., Agent | SumoDriver] = make

    def create(written: Mapping[str, Any]) -> Agent | SumoDriver:
        values = read_agent_parameters(entry.name, type_, written)
        return called() if takes_none else called(values)

    return AgentPlugin(entry=entry, create=create, parameters=type_)


def _check_parameters(name: str, type_: object) -> None:
    """Checks the type of an agent's parameters.

    Raises:
        AgentError: It is no dataclass, or a field has no default.
    """
    if not (isinstance(type_, type) and is_dataclass(type_)):
        found = type_.__name__ if isinstance(type_, type) else repr(type_)
        raise AgentError(
            f"agent {name!r}: its parameters are {found}; allowed: a frozen dataclass with a "
            "default for every field, or None if it takes no parameters",
            cause="agent_plugin",
        )
    for one in fields(type_):
        if one.init and one.default is MISSING and one.default_factory is MISSING:
            raise AgentError(
                f"agent {name!r}: its parameter {one.name!r} has no default; each field of "
                f"{type_.__name__} needs one",
                cause="agent_plugin",
            )


def _accepts(make: object, arguments: int) -> bool:
    """Returns whether something can be called with so many arguments, as far as it tells."""
    if not callable(make):
        return False
    try:
        signature(make).bind(*range(arguments))
    except TypeError:
        return False
    except ValueError:
        # A built-in or compiled callable without a signature.
        return True
    return True


def read_agent_parameters(name: str, type_: type[P], written: Mapping[str, Any]) -> P:
    """Returns an agent's parameters from those of a document.

    Raises:
        AgentError: The agent rejects a parameter.
    """
    error = partial(AgentError, cause="agent_parameters")
    return read_parameters(type_, written, of=f"agent {name!r}", error=error)
