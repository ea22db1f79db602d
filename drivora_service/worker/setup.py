"""What every worker is told once, when it starts."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from drivora_service.agents.remote.confinement import Confinement


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerSetup:
    """Where a worker finds what documents only name, and what its slot expects of it.

    It lies apart from the performing of runs so that the process that owns the workers can make one
    without loading the simulator.

    Attributes:
        agents: Folder of installed agents and of the operator's manifests.
        agent_deadline_s: Seconds of one call of an agent after which the slot ends the worker; an
            ADS in a process of its own must be found to hang before.
        installed_oracles: Whether oracles of installed packages judge as well.
        confinement: User account and limits of ADSs in processes of their own.
    """

    shipped_networks: Path
    imported_networks: Path | None = None
    agents: Path | None = None
    agent_deadline_s: float = 10.0
    installed_oracles: bool = True
    confinement: Confinement = field(default_factory=Confinement)
