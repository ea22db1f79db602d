"""The configuration of every worker, passed at its start."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from drivora_service.agents.remote.confinement import Confinement
from drivora_service.oracles.laws.sources import LawSource


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerSetup:
    """Locations of the things that documents name, and the limits of a worker.

    Its module is apart from ``performing`` so that the process that owns the workers can make one
    without loading the simulator.

    Attributes:
        agents: Folder of installed agents and of the operator's manifests.
        agent_deadline_s: Seconds of one call of an agent after which the slot ends the worker; a
            hang of an ADS in a process of its own must be detected before.
        installed_oracles: Whether oracles and metrics of installed packages judge and measure, too.
        laws: The user's traffic laws, as they were when the service or command started.
        confinement: User account and limits of ADSs in processes of their own.
    """

    shipped_networks: Path
    imported_networks: Path | None = None
    agents: Path | None = None
    agent_deadline_s: float = 10.0
    installed_oracles: bool = True
    laws: tuple[LawSource, ...] = ()
    confinement: Confinement = field(default_factory=Confinement)
