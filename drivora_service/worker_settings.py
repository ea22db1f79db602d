"""The executor, and the set-up and the limits of its workers, from the settings."""

from __future__ import annotations

import stat
from pathlib import Path

from drivora_service.agents.remote.confinement import Confinement, account
from drivora_service.errors import ConfigurationError
from drivora_service.execution.executor import Executor
from drivora_service.execution.executor import Limits as RunLimits
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.oracles.laws.sources import read_law_sources
from drivora_service.settings import Settings
from drivora_service.worker.setup import WorkerSetup


def worker_setup(settings: Settings) -> WorkerSetup:
    """Returns the configuration of every worker.

    Raises:
        ConfigurationError: ADSs cannot run under the configured account.
    """
    return WorkerSetup(
        shipped_networks=shipped_networks(),
        imported_networks=settings.imported_networks_dir,
        agents=settings.agents_folder,
        agent_deadline_s=settings.agent_deadline_s,
        laws=read_law_sources(settings.laws_folder),
        confinement=_confinement(settings),
    )


def _confinement(settings: Settings) -> Confinement:
    memory = settings.agent_memory_mb << 20
    if not settings.agent_user:
        return Confinement(memory_bytes=memory)
    user, group = account(settings.agent_user)
    data = settings.data_dir.resolve()
    if settings.agents_folder.is_relative_to(data):
        raise ConfigurationError(
            f"DRIVORA_AGENT_USER: ADSs of the account {settings.agent_user!r} cannot read the "
            f"folder of agents {settings.agents_folder}, as it lies in the data folder, which they "
            "must not read; set DRIVORA_AGENTS_DIR to a folder outside it"
        )
    if data.exists() and stat.S_IMODE(data.stat().st_mode) & 0o077:
        raise ConfigurationError(
            f"DRIVORA_AGENT_USER: other accounts may read the data folder {data}; run "
            f"`chmod 700 {data}`"
        )
    return Confinement(user=user, group=group, memory_bytes=memory)


def run_limits(settings: Settings) -> RunLimits:
    """Returns the limits of a worker."""
    return RunLimits(
        wall_time_s=settings.wall_time_limit_s,
        agent_deadline_s=settings.agent_deadline_s,
        memory_bytes=settings.memory_limit_mb << 20,
        runs_per_worker=settings.runs_per_worker,
    )


def with_shared_paths(settings: Settings) -> Settings:
    """Returns the settings with a data folder that other machines find, if there are any."""
    if settings.executor == "local":
        return settings
    return settings.model_copy(update={"data_dir": settings.data_dir.resolve()})


def start_executor(
    settings: Settings, *, slots: int, folder: Path, shared_folder: Path | None = None
) -> Executor:
    """Starts the executor that the settings name; the caller closes it.

    Args:
        settings: Settings of the installation.
        slots: Worker processes on this machine; the nodes of a cluster have their own numbers.
        folder: For logs.
        shared_folder: Folder that the nodes of a cluster share, for the logs of their workers;
            ``None``: they keep no logs.

    Raises:
        ConfigurationError: The executor cannot be used.
    """
    if settings.executor == "local":
        return LocalExecutor(
            slots=slots,
            setup=worker_setup(settings),
            folder=folder,
            limits=run_limits(settings),
        )
    from drivora_service.execution.ray.ray_executor import RayExecutor

    return RayExecutor(
        address=settings.ray_address,
        setup=worker_setup(settings),
        folder=folder,
        node_folder=shared_folder,
        slots_per_node=settings.workers_per_node,
        limits=run_limits(settings),
    )
