"""The catalogue of agents."""

from __future__ import annotations

import traceback
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivora_service.agents.built_in_agents import BUILT_IN, FETCHED
from drivora_service.agents.configuration import AgentConfiguration, configuration_of
from drivora_service.agents.entry import AgentEntry, AgentKind
from drivora_service.agents.installing import (
    environment_python,
    install_environment,
    install_files,
    installed_files,
)
from drivora_service.agents.interface import Agent
from drivora_service.agents.manifest import AgentManifest, read_manifest
from drivora_service.agents.manifest_files import operator_manifests, shipped_manifests
from drivora_service.agents.manifest_parameters import parameters_type
from drivora_service.agents.plugin import AgentPlugin, FetchedAgentPlugin, read_agent_parameters
from drivora_service.agents.remote.confinement import Confinement
from drivora_service.agents.sumo_driver import SumoDriver, SumoDriverParameters
from drivora_service.errors import AgentError, Problem, UnknownName
from drivora_service.foreign_errors import exception_place
from drivora_service.parameters import (
    ParameterDescription,
    describe_parameters,
    parameter_problems,
)
from drivora_service.plugin_table import PluginTable
from drivora_service.scenario.checks.agent_checks import AgentDirectory
from drivora_service.scenario.model import AgentChoice

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from drivora_service.agents.remote.remote_processes import AgentHosts

LONGEST_CALL_S = 10.0
"""Default limit of one call of an agent, seconds."""


class AgentCatalogue:
    """The built-in agents, those of installed packages, and those of the operator.

    Packages provide them by entry points; an operator by manifests in a folder, which may be added
    and removed while the process runs. A built-in agent is never replaced, and one of a package not
    by a manifest.
    """

    def __init__(
        self,
        built_in: tuple[AgentPlugin, ...] = BUILT_IN,
        *,
        fetched: tuple[FetchedAgentPlugin, ...] = FETCHED,
        folder: Path | None = None,
        longest_call_s: float = LONGEST_CALL_S,
        confinement: Confinement = Confinement(),  # noqa: B008 # frozen
    ) -> None:
        """Looks up the existing agents, without loading them.

        Args:
            built_in: Agents without further requirements.
            fetched: Agents that need files of other packages.
            folder: Folder of installed agents and of the operator's manifests; without one, agents
                that need an installation count as not installed.
            longest_call_s: Limit of one call of an agent, seconds.
            confinement: User account and limits of ADSs in processes of their own.
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
        self._confinement = confinement
        self._hosts: AgentHosts | None = None

    def names(self) -> tuple[str, ...]:
        """Returns all names, sorted."""
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
        """Returns the entry of an agent, with the reason if it cannot be used.

        Raises:
            UnknownName: If there is no such agent.
        """
        try:
            fetched = self._fetched.get(name)
            if fetched is not None:
                files = installed_files(name, fetched.files, self._folder)
                entry = replace(fetched.entry, version=_own_version())
                return entry if files is not None else _make_uninstalled_entry(entry)
            manifest = self._manifest(name)
            if manifest is not None:
                python = environment_python(manifest, self._folder)
                entry = _manifest_entry(manifest)
                if name in self._shipped:
                    entry = replace(entry, version=_own_version())
                return entry if python is not None else _make_uninstalled_entry(entry)
            told = next(iter(self._table.versions(name).values()), _own_version())
            return replace(self._plugin(name).entry, version=told)
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
        """Returns all entries, by name."""
        return tuple(self.entry(name) for name in self.names())

    def versions(self, name: str) -> Mapping[str, str]:
        """Returns the version of an agent by the name of its package or its own name.

        Returns:
            Empty for built-in agents, and if the manifest has no version.

        Raises:
            AgentError: If its manifest cannot be used.
        """
        manifest = None if name in self._shipped else self._manifest(name)
        if manifest is None:
            return self._table.versions(name)
        return {name: manifest.version} if manifest.version else {}

    def availability(self) -> AgentDirectory:
        """Returns the directory for checking documents, with lookup on use."""
        return _Availability(self)

    def parameters(self, name: str) -> tuple[ParameterDescription, ...] | None:
        """Returns the parameters of an agent; ``None`` if it does not declare them.

        Raises:
            UnknownName: If there is no such agent.
        """
        type_ = self._parameters(name)
        return None if type_ is None else _describe(type_)

    def configuration(self, choices: Iterable[AgentChoice]) -> AgentConfiguration:
        """Returns the agents of all egos with the parameters that differ from their defaults."""
        return configuration_of(choices, self.parameters)

    def fill_defaults(self, choice: AgentChoice) -> AgentChoice:
        """Returns a choice with the defaults of the parameters that it does not set.

        Raises:
            UnknownName: If there is no such agent.
        """
        type_ = self._parameters(choice.name)
        defaults = {} if type_ is None else _defaults(type_)
        return AgentChoice(name=choice.name, parameters={**defaults, **choice.parameters})

    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        """Returns the problems of an agent's parameters; empty if it declares none.

        Returns:
            Problems with pointers relative to the parameters.

        Raises:
            UnknownName: If there is no such agent.
        """
        type_ = self._parameters(name) if parameters else None
        if type_ is None:
            return ()
        return parameter_problems(type_, parameters, of=f"agent {name!r}")

    def lane_change_model(self, name: str, parameters: Mapping[str, Any]) -> str:
        """Returns the lane-change model that one of SUMO's drivers needs; "" for any other agent.

        Raises:
            UnknownName: If there is no such agent.
            AgentError: If it rejects these parameters.
        """
        if not self.is_sumo_driver(name):
            return ""
        return read_agent_parameters(name, SumoDriverParameters, parameters).lane_change_model

    def is_sumo_driver(self, name: str) -> bool:
        """Returns whether a name stands for one of SUMO's drivers, which are not asked by step.

        Raises:
            UnknownName: If there is no such agent.
        """
        return self._parameters(name) is SumoDriverParameters

    def create(self, name: str, parameters: Mapping[str, Any]) -> Agent | SumoDriver:
        """Makes an agent for one ego and one run.

        An ADS with its own process is started, unless one is idle from an earlier run.

        Raises:
            UnknownName: If there is no such agent.
            AgentError: If it rejects these parameters, is not installed, cannot be loaded,
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
                f"agent {name!r} raised {type(error).__name__} when it was made: {error}"
                f"{exception_place(error)}",
                log="".join(traceback.format_exception(error))[-4000:],
            ) from error

    def is_in_process(self, name: str) -> bool:
        """Returns whether the code of an agent runs in the calling process.

        Raises:
            AgentError: If its manifest cannot be used.
        """
        return self._manifest(name) is None

    def may_read_sumo(self, name: str) -> bool:
        """Returns whether an agent's code may reach the SUMO of the calling process.

        Those of installed packages may; built-in ones do not, and others have their own process.

        Raises:
            AgentError: If its manifest cannot be used.
        """
        return self._table.is_of_package(name) and self.is_in_process(name)

    def begin_run(self) -> None:
        """Releases the ADSs of the last run, whose agents are no longer used."""
        if self._hosts is not None:
            self._hosts.begin_run()

    def close(self) -> None:
        """Ends the ADSs that were started."""
        if self._hosts is not None:
            self._hosts.close()

    def install(self, name: str, *, again: bool = False) -> bool:
        """Installs an agent's requirements; returns whether this was necessary.

        Args:
            name: Name of the agent.
            again: Reinstall if it is installed.

        Raises:
            UnknownName: If there is no such agent.
            AgentError: If the installation fails.
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

    def _parameters(self, name: str) -> type[DataclassInstance] | None:
        fetched = self._fetched.get(name)
        if fetched is not None:
            return fetched.parameters
        try:
            manifest = self._manifest(name)
            if manifest is None:
                return self._plugin(name).parameters
        except AgentError:
            # Its entry has the reason why it cannot be used.
            return None
        return None if manifest.parameters is None else parameters_type(manifest.parameters)

    def _plugin(self, name: str) -> AgentPlugin:
        if name not in self._table.names():
            raise UnknownName("agent", name, self.names())
        return self._table.plugin(name)

    def _all_hosts(self) -> AgentHosts:
        if self._hosts is None:
            # Imported here, since gRPC is slow to load and not needed for looking up names.
            from drivora_service.agents.remote.remote_processes import AgentHosts

            self._hosts = AgentHosts(self._longest_call_s, self._confinement)
        return self._hosts


class _Availability(AgentDirectory):
    """The agents of a catalogue, by name."""

    def __init__(self, catalogue: AgentCatalogue) -> None:
        self._catalogue = catalogue
        self._names = catalogue.names()

    def __getitem__(self, name: str) -> str:
        if name not in self._names:
            raise KeyError(name)
        return self._catalogue.entry(name).reason

    def parameter_problems(self, name: str, parameters: Mapping[str, Any]) -> tuple[Problem, ...]:
        return self._catalogue.parameter_problems(name, parameters)

    def lane_change_model(self, name: str, parameters: Mapping[str, Any]) -> str:
        return self._catalogue.lane_change_model(name, parameters)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


@cache
def _describe(type_: type[DataclassInstance]) -> tuple[ParameterDescription, ...]:
    return describe_parameters(type_)


@cache
def _defaults(type_: type[DataclassInstance]) -> Mapping[str, Any]:
    return {described.name: described.default for described in _describe(type_)}


@cache
def _own_version() -> str:
    return version("drivora")


def _manifest_entry(manifest: AgentManifest) -> AgentEntry:
    return AgentEntry(
        name=manifest.name,
        kind=manifest.kind,
        description=manifest.description,
        source=manifest.source,
        licence=manifest.licence,
        version=manifest.version,
    )


def _make_uninstalled_entry(entry: AgentEntry) -> AgentEntry:
    return replace(entry, installed=False, reason=f"run `drivora agents install {entry.name}`")


def _refusal(entry: AgentEntry) -> AgentError:
    return AgentError(
        f"agent {entry.name!r} is not installed: {entry.reason}", cause="agent_not_installed"
    )
