"""The agents that a document may name."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from drivora_service.agents.entry import AgentEntry as AgentEntry
from drivora_service.agents.entry import AgentKind as AgentKind
from drivora_service.agents.idm.agent import IdmAgent, IdmParameters
from drivora_service.agents.idm_mobil.agent import MobilAgent, MobilParameters
from drivora_service.agents.installing import (
    environment_python,
    install_environment,
    install_files,
    installed_files,
)
from drivora_service.agents.interface import Agent
from drivora_service.agents.manifest import AgentManifest, read_manifest
from drivora_service.agents.manifest_files import operator_manifests, shipped_manifests
from drivora_service.agents.metadrive_ppo import agent as metadrive_ppo
from drivora_service.agents.metadrive_ppo.weights import WEIGHTS_FILE as METADRIVE_WEIGHTS
from drivora_service.agents.package_files import PackageFile
from drivora_service.agents.pdm_closed.agent import PdmClosedAgent, PdmParameters
from drivora_service.agents.puffer_drive import agent as puffer_drive
from drivora_service.agents.puffer_drive.weights import WEIGHTS_FILE as PUFFER_WEIGHTS
from drivora_service.agents.sumo_driver import SumoDriver
from drivora_service.errors import AgentError, UnknownName
from drivora_service.parameters import read_parameters
from drivora_service.plugin_table import PluginTable

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from drivora_service.agents.remote.processes import AgentHosts

P = TypeVar("P", bound="DataclassInstance")


LONGEST_CALL_S = 10.0
"""Seconds that one call of an agent may take unless the settings say otherwise."""


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
    """The agents that are built in, those that packages bring, and those that an operator brings.

    Packages bring them by entry point; an operator by manifests in a folder, which may come and go
    while the process runs. A built-in agent is never replaced, and one of a package not by a
    manifest.
    """

    def __init__(
        self,
        built_in: tuple[AgentPlugin, ...] = BUILT_IN,
        *,
        fetched: tuple[FetchedAgentPlugin, ...] = FETCHED,
        folder: Path | None = None,
        longest_call_s: float = LONGEST_CALL_S,
    ) -> None:
        """Looks up what there is, without loading it.

        Args:
            built_in: Agents that need nothing.
            fetched: Agents that need files of other packages.
            folder: Where agents are installed, and where the operator's manifests lie; without one
                no agent counts as installed that would have to be.
            longest_call_s: Seconds that one call of an agent may take.
        """
        self._table = PluginTable(
            kind="agent",
            group="drivora_service.agents",
            type_=AgentPlugin,
            built_in=built_in,
            error=partial(AgentError, cause="agent_plugin"),
        )
        self._fetched = {plugin.name: plugin for plugin in fetched}
        self._shipped = shipped_manifests()
        self._folder = folder
        self._longest_call_s = longest_call_s
        self._hosts: AgentHosts | None = None

    def names(self) -> tuple[str, ...]:
        """Gives all names, sorted."""
        return tuple(
            sorted(
                {
                    *self._table.names(),
                    *self._fetched,
                    *self._shipped,
                    *operator_manifests(self._folder),
                }
            )
        )

    def entry(self, name: str) -> AgentEntry:
        """Gives what is known of an agent; of one that cannot be used, why.

        Raises:
            UnknownName: If there is no such agent.
        """
        try:
            fetched = self._fetched.get(name)
            if fetched is not None:
                files = installed_files(name, fetched.files, self._folder)
                return fetched.entry if files is not None else _not_installed(fetched.entry)
            manifest = self._manifest(name)
            if manifest is not None:
                python = environment_python(manifest, self._folder)
                entry = _manifest_entry(manifest)
                return entry if python is not None else _not_installed(entry)
            return self._plugin(name).entry
        except AgentError as error:
            return AgentEntry(
                name=name,
                kind=AgentKind.BASELINE,
                description="an agent that cannot be loaded",
                source=self._table.package(name),
                licence="",
                installed=False,
                reason=str(error),
            )

    def entries(self) -> tuple[AgentEntry, ...]:
        """Gives all entries, by name."""
        return tuple(self.entry(name) for name in self.names())

    def availability(self) -> Mapping[str, str]:
        """Gives by name why an agent cannot be used, "" for one that can; looked up when asked."""
        return _Availability(self)

    def create(self, name: str, parameters: Mapping[str, Any]) -> Agent | SumoDriver:
        """Makes an agent for one ego and one run.

        An ADS in a process of its own is started, unless one is left from an earlier run.

        Raises:
            UnknownName: If there is no such agent.
            AgentError: If it does not take these parameters, is not installed, cannot be loaded,
                started or reached.
        """
        manifest = self._manifest(name)
        if manifest is not None:
            python = environment_python(manifest, self._folder)
            if python is None:
                raise _refusal(self.entry(name))
            return self._all_hosts().agent(manifest, python)
        try:
            fetched = self._fetched.get(name)
            if fetched is None:
                return self._plugin(name).create(parameters)
            files = installed_files(name, fetched.files, self._folder)
            if files is None:
                raise _refusal(self.entry(name))
            return fetched.create(parameters, files)
        except (AgentError, UnknownName):
            raise
        except (Exception, SystemExit) as error:
            raise AgentError(
                f"agent {name!r} raised {type(error).__name__} when it was made: {error}",
                log="".join(traceback.format_exception(error))[-4000:],
            ) from error

    def begin_run(self) -> None:
        """Takes back the ADSs of the last run, whose agents are not used any more."""
        if self._hosts is not None:
            self._hosts.begin_run()

    def close(self) -> None:
        """Ends the ADSs that were started."""
        if self._hosts is not None:
            self._hosts.close()

    def install(self, name: str, *, again: bool = False) -> bool:
        """Installs what an agent needs; gives whether there was anything to do.

        Args:
            name: Of the agent.
            again: Do it even if it is there.

        Raises:
            UnknownName: If there is no such agent.
            AgentError: If it cannot be done.
        """
        if self._folder is None:
            raise AgentError("there is no folder to install agents in", cause="agent_install")
        fetched, manifest = self._fetched.get(name), self._manifest(name)
        if fetched is not None:
            return install_files(name, fetched.files, self._folder, again=again)
        if manifest is not None:
            return install_environment(manifest, self._folder, again=again)
        self._plugin(name)
        return False

    def _manifest(self, name: str) -> AgentManifest | None:
        if name in self._fetched or name in self._table.names():
            return None
        path = self._shipped.get(name) or operator_manifests(self._folder).get(name)
        return None if path is None else read_manifest(path, name)

    def _plugin(self, name: str) -> AgentPlugin:
        if name not in self._table.names():
            raise UnknownName("agent", name, self.names())
        return self._table.plugin(name)

    def _all_hosts(self) -> AgentHosts:
        if self._hosts is None:
            # gRPC takes a while to load, which those who only look names up need not wait for.
            from drivora_service.agents.remote.processes import AgentHosts

            self._hosts = AgentHosts(self._longest_call_s)
        return self._hosts


class _Availability(Mapping[str, str]):
    """Why agents cannot be used, by name."""

    def __init__(self, catalogue: AgentCatalogue) -> None:
        self._catalogue = catalogue
        self._names = catalogue.names()

    def __getitem__(self, name: str) -> str:
        if name not in self._names:
            raise KeyError(name)
        return self._catalogue.entry(name).reason

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _manifest_entry(manifest: AgentManifest) -> AgentEntry:
    return AgentEntry(
        name=manifest.name,
        kind=manifest.kind,
        description=manifest.description,
        source=manifest.source,
        licence=manifest.licence,
    )


def _not_installed(entry: AgentEntry) -> AgentEntry:
    return replace(entry, installed=False, reason=f"run `drivora agents install {entry.name}`")


def _refusal(entry: AgentEntry) -> AgentError:
    return AgentError(
        f"agent {entry.name!r} is not installed: {entry.reason}", cause="agent_not_installed"
    )
