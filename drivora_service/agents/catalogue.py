"""The agents that a document may name."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Any

from drivora_service.agents.idm.agent import IdmAgent
from drivora_service.agents.interface import Agent
from drivora_service.agents.metadrive_ppo import agent as metadrive_ppo
from drivora_service.agents.metadrive_ppo.weights import WEIGHTS_FILE as METADRIVE_WEIGHTS
from drivora_service.agents.package_files import PackageFile
from drivora_service.agents.puffer_drive import agent as puffer_drive
from drivora_service.agents.puffer_drive.weights import WEIGHTS_FILE as PUFFER_WEIGHTS
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError
from drivora_service.plugin_table import PluginTable


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
class FetchedAgentPlugin:
    """A built-in agent that runs in process and needs files of other packages, such as weights.

    ``drivora agents install NAME`` fetches the files into a folder of the agent's own; until then
    its entry says that it is not installed. Drivora itself ships none of them.

    Attributes:
        entry: As for every agent; ``licence`` is shown before anything is fetched.
        files: What to fetch. A change here makes an older installation count as none.
        create: Takes the document's parameters and the folder that holds the files; raises
            ``AgentError`` if it cannot use them.
    """

    entry: AgentEntry
    files: tuple[PackageFile, ...]
    create: Callable[[Mapping[str, Any], Path], Agent]

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return self.entry.name


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


def _idm(parameters: Mapping[str, Any]) -> IdmAgent:
    known = {"speed_factor"}
    unknown = set(parameters) - known
    if unknown:
        raise AgentError(
            f"agent 'idm' has no parameter {sorted(unknown)[0]!r}; known: speed_factor",
            cause="agent_parameters",
        )
    factor = parameters.get("speed_factor", 1.0)
    if isinstance(factor, bool) or not isinstance(factor, int | float) or not 0.1 <= factor <= 2.0:
        raise AgentError(
            f"agent 'idm': speed_factor is {factor!r}; allowed: a number from 0.1 to 2",
            cause="agent_parameters",
        )
    return IdmAgent(speed_factor=float(factor))


def _sumo(type_id: str) -> Callable[[Mapping[str, Any]], SumoDriver]:
    def create(parameters: Mapping[str, Any]) -> SumoDriver:
        if parameters:
            raise AgentError(
                "SUMO's drivers take no parameters: leave `parameters` out",
                cause="agent_parameters",
            )
        return SumoDriver(type_id=type_id)

    return create


def _sumo_plugin(name: str, model: str, type_id: str) -> AgentPlugin:
    return AgentPlugin(
        entry=AgentEntry(
            name=name,
            kind=AgentKind.BASELINE,
            description=f"SUMO's own driver: {model} with the lane-change model LC2013",
            source="Eclipse SUMO",
            licence="EPL-2.0",
            privileged=True,
        ),
        create=_sumo(type_id),
    )


BUILT_IN: tuple[AgentPlugin, ...] = (
    AgentPlugin(
        entry=AgentEntry(
            name="idm",
            kind=AgentKind.MODULE_BASED,
            description=(
                "intelligent driver model and pure pursuit along the route; obeys lights and right "
                "of way, changes lanes where the route needs it"
            ),
            source="written here after Treiber, Hennecke, Helbing 2000 and Coulter 1992",
            licence="Apache-2.0",
        ),
        create=_idm,
    ),
    _sumo_plugin("sumo-krauss", "Krauss car following", "krauss-LC2013"),
    _sumo_plugin("sumo-idm", "IDM car following", "idm-LC2013"),
    _sumo_plugin("sumo-eidm", "EIDM car following", "eidm-LC2013"),
)

FETCHED: tuple[FetchedAgentPlugin, ...] = (
    FetchedAgentPlugin(
        entry=AgentEntry(
            name="metadrive-ppo",
            kind=AgentKind.END_TO_END,
            description=(
                "expert policy trained by PPO in MetaDrive, from rays and the nearest vehicles to "
                "steering and throttle; knows neither lights nor right of way nor limits: its "
                "adapter brakes for lights and holds back at the limit"
            ),
            source="metadrive-simulator 0.4.3 (Li et al. 2022)",
            licence="Apache-2.0",
        ),
        files=(METADRIVE_WEIGHTS,),
        create=metadrive_ppo.create,
    ),
    FetchedAgentPlugin(
        entry=AgentEntry(
            name="puffer-drive",
            kind=AgentKind.END_TO_END,
            description=(
                "self-play policy trained on recorded city scenes, from roads and vehicles to a "
                "choice of acceleration and steering; reckless; knows neither lights nor right of "
                "way nor limits: its adapter brakes for lights and holds back at the limit"
            ),
            source="pufferlib 3.0.0 (Suarez 2024; scenes of GPUDrive, Kazemkhani et al. 2024)",
            licence="MIT",
        ),
        files=(PUFFER_WEIGHTS,),
        create=puffer_drive.create,
    ),
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
