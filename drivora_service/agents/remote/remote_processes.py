"""The ADSs that a worker has started or reached, kept from one run to the next."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from drivora_service.agents.manifest import AgentDeadlines, AgentManifest
from drivora_service.agents.remote.agent import RemoteAgent
from drivora_service.agents.remote.confinement import Confinement
from drivora_service.agents.remote.hosts import AddressHost, Host, ProcessHost


@dataclass(slots=True, kw_only=True)
class _Kept:
    manifest: AgentManifest
    python: Path
    host: Host
    in_use: bool = True


class AgentHosts:
    """Assigns ADSs to the egos of a run, and reuses them in the next run."""

    def __init__(self, longest_call_s: float, confinement: Confinement) -> None:
        """Creates it without ADSs.

        Args:
            confinement: User account and limits of the processes.
            longest_call_s: Seconds after which a call of an agent ends the worker; a hanging ADS
                must be detected before.
        """
        self._within = max(longest_call_s - 1.0, 0.5 * longest_call_s)
        self._confinement = confinement
        self._kept: list[_Kept] = []

    def begin_run(self) -> None:
        """Releases all ADSs of the last run."""
        for kept in self._kept:
            kept.in_use = False

    def agent(self, manifest: AgentManifest, python: Path) -> RemoteAgent:
        """Returns an agent for one ego of the run; starts an ADS if no idle one is left.

        Raises:
            AgentError: It cannot be started or reached.
        """
        deadlines = AgentDeadlines(
            start=manifest.deadlines.start,
            setup=min(manifest.deadlines.setup, self._within),
            step=min(manifest.deadlines.step, self._within),
        )
        return RemoteAgent(manifest.name, self._host(manifest, python), deadlines)

    def _host(self, manifest: AgentManifest, python: Path) -> Host:
        for kept in list(self._kept):
            if kept.in_use or kept.manifest.name != manifest.name:
                continue
            if kept.manifest == manifest and kept.python == python and kept.host.is_alive:
                kept.in_use = True
                return kept.host
            # It died in between, or the operator has changed its manifest.
            self._kept.remove(kept)
            kept.host.end()
        host = (
            AddressHost(manifest)
            if manifest.address
            else ProcessHost(manifest, python, self._confinement)
        )
        self._kept.append(_Kept(manifest=manifest, python=python, host=host))
        return host

    def close(self) -> None:
        """Ends all ADSs."""
        for kept in self._kept:
            kept.host.end()
        self._kept.clear()
