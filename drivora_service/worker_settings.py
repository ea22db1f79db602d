"""What the settings mean for workers: their set-up and their limits."""

from __future__ import annotations

from drivora_service.execution.executor import Limits as RunLimits
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.worker_setup import WorkerSetup
from drivora_service.settings import Settings


def worker_setup(settings: Settings) -> WorkerSetup:
    """Gives what every worker is told."""
    return WorkerSetup(
        shipped_networks=shipped_networks(),
        imported_networks=settings.imported_networks_dir,
        agents=settings.agents_folder,
        agent_deadline_s=settings.agent_deadline_s,
    )


def run_limits(settings: Settings) -> RunLimits:
    """Gives what a worker may use."""
    return RunLimits(
        wall_time_s=settings.wall_time_limit_s,
        agent_deadline_s=settings.agent_deadline_s,
        memory_bytes=settings.memory_limit_mb << 20,
        runs_per_worker=settings.runs_per_worker,
    )
