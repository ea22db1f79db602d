"""The agents that a document may name."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from drivora_service.agents.idm.agent import IdmAgent, IdmParameters
from drivora_service.agents.idm_mobil.agent import MobilAgent, MobilParameters
from drivora_service.agents.interface import Agent
from drivora_service.agents.pdm_closed.agent import PdmClosedAgent, PdmParameters
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError
from drivora_service.parameters import read_parameters
from drivora_service.plugin_table import PluginTable

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

P = TypeVar("P", bound="DataclassInstance")


class AgentKind(StrEnum):
    """How an ADS is built."""

    MODULE_BASED = "module-based"
    END_TO_END = "end-to-end"
    LANGUAGE_BASED = "language-based"
    BASELINE = "baseline"


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentEntry:
    """What the catalogue says of an agent.

    Attributes:
        source: Where it comes from: paper, package.
        installed: Whether it can be run here.
        reason: Why not, or "".
        privileged: Whether it sees more than the perception model lets through.
    """

    name: str
    kind: AgentKind
    description: str
    source: str
    licence: str
    installed: bool = True
    reason: str = ""
    privileged: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentPlugin:
    """What an entry point of the group ``drivora_service.agents`` gives: an entry and a factory.

    The factory takes the document's parameters and raises ``AgentError`` if it cannot use them.
    """

    entry: AgentEntry
    create: Callable[[Mapping[str, Any]], Agent | SumoDriver]

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.entry.name


def _built_in(
    entry: AgentEntry, type_: type[P], make: Callable[[P], Agent | SumoDriver]
) -> AgentPlugin:
    """Makes the plug-in of an agent whose parameters are the fields of a dataclass."""
    error = partial(AgentError, cause="agent_parameters")

    def create(parameters: Mapping[str, Any]) -> Agent | SumoDriver:
        return make(read_parameters(type_, parameters, of=f"agent {entry.name!r}", error=error))

    return AgentPlugin(entry=entry, create=create)


@dataclass(frozen=True, slots=True, kw_only=True)
class _NoParameters:
    """What SUMO's drivers take."""


def _sumo_plugin(name: str, model: str, type_id: str) -> AgentPlugin:
    return _built_in(
        AgentEntry(
            name=name,
            kind=AgentKind.BASELINE,
            description=f"SUMO's own driver: {model} with the lane-change model LC2013",
            source="Eclipse SUMO",
            licence="EPL-2.0",
            privileged=True,
        ),
        _NoParameters,
        lambda _: SumoDriver(type_id=type_id),
    )


BUILT_IN: tuple[AgentPlugin, ...] = (
    _built_in(
        AgentEntry(
            name="idm",
            kind=AgentKind.MODULE_BASED,
            description=(
                "intelligent driver model and pure pursuit along the route; obeys lights and right "
                "of way, changes lanes where the route needs it"
            ),
            source="written here after Treiber, Hennecke, Helbing 2000 and Coulter 1992",
            licence="Apache-2.0",
        ),
        IdmParameters,
        lambda parameters: IdmAgent(parameters.speed_factor),
    ),
    _built_in(
        AgentEntry(
            name="idm-mobil",
            kind=AgentKind.MODULE_BASED,
            description=(
                "`idm` that overtakes: lane changes where they pay off and cost others little, "
                "and back in time for its route"
            ),
            source="written here after Kesting, Treiber, Helbing 2007",
            licence="Apache-2.0",
        ),
        MobilParameters,
        MobilAgent,
    ),
    _built_in(
        AgentEntry(
            name="pdm-closed",
            kind=AgentKind.MODULE_BASED,
            description=(
                "drives the best of fifteen simulated proposals: three lateral offsets and five "
                "speeds, scored by nuPlan's terms"
            ),
            source="written here after Dauner, Hallgarten, Geiger, Chitta 2023",
            licence="Apache-2.0",
        ),
        PdmParameters,
        PdmClosedAgent,
    ),
    _sumo_plugin("sumo-krauss", "Krauss car following", "krauss-LC2013"),
    _sumo_plugin("sumo-idm", "IDM car following", "idm-LC2013"),
    _sumo_plugin("sumo-eidm", "EIDM car following", "eidm-LC2013"),
)


class AgentCatalogue:
    """The built-in agents and those that installed packages bring by entry point."""

    def __init__(self, built_in: tuple[AgentPlugin, ...] = BUILT_IN) -> None:
        self._table = PluginTable(
            kind="agent",
            group="drivora_service.agents",
            type_=AgentPlugin,
            built_in=built_in,
            error=partial(AgentError, cause="agent_plugin"),
        )

    def names(self) -> tuple[str, ...]:
        """Gives all names, sorted."""
        return self._table.names()

    def entry(self, name: str) -> AgentEntry:
        """Gives what is known of an agent; of a plug-in that cannot be loaded, why.

        Raises:
            UnknownName: If there is no such agent.
        """
        try:
            return self._table.plugin(name).entry
        except AgentError as error:
            return AgentEntry(
                name=name,
                kind=AgentKind.BASELINE,
                description="a plug-in that cannot be loaded",
                source=self._table.package(name),
                licence="",
                installed=False,
                reason=str(error),
            )

    def entries(self) -> tuple[AgentEntry, ...]:
        """Gives all entries, by name."""
        return tuple(self.entry(name) for name in self.names())

    def create(self, name: str, parameters: Mapping[str, Any]) -> Agent | SumoDriver:
        """Makes an agent for one ego and one run.

        Raises:
            UnknownName: If there is no such agent.
            AgentError: If it does not take these parameters, or its plug-in cannot be loaded.
        """
        plugin = self._table.plugin(name)
        try:
            return plugin.create(parameters)
        except AgentError:
            raise
        except (Exception, SystemExit) as error:
            raise AgentError(
                f"agent {name!r} raised {type(error).__name__} when it was made: {error}",
                log="".join(traceback.format_exception(error))[-4000:],
            ) from error
