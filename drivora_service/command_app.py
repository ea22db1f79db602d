"""The application of one command: the API in the command's own process, with no server around it.

It holds no ``ServerLock``, so that commands work beside a service on the same data folder. The runs
that a command asks for are handed to its own workers alone, and are cancelled when it ends or dies;
its campaigns run in its process. The database is opened by the first request that needs it, and
made if the command stores data.
"""

from __future__ import annotations

import contextlib
import tempfile
import threading
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

from fastapi import FastAPI

from drivora_service.api.answers.network_imports import NetworkImports
from drivora_service.api.application import create_api
from drivora_service.api.context import ApiContext, Limits
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.stored_gene_spaces import GeneSpaces
from drivora_service.campaigns.evaluation.evaluator_catalogue import evaluator_plugins
from drivora_service.campaigns.evaluation.local_evaluator import LOCAL, LocalEvaluator
from drivora_service.campaigns.evaluation.shared_pool import SharedPool
from drivora_service.campaigns.evaluator import Evaluator, EvaluatorContext
from drivora_service.campaigns.hosts.command_campaigns import CommandCampaigns
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.search.tester_calls import CallMemory
from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.executor import Executor
from drivora_service.execution.infrastructure import Infrastructure, folder_probe
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.ownership import Ownership, cancel_runs_of_dead_commands
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.laws.sources import read_law_sources
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.settings import Settings
from drivora_service.store.command_database import CommandDatabase
from drivora_service.store.database import Database
from drivora_service.store.locks.command_locks import CommandLocks
from drivora_service.store.traces.stored_traces import find_trace_path
from drivora_service.store.traces.trace_places import TracePlaces
from drivora_service.store.upkeep.lost_runs import refuse_lost_runs
from drivora_service.studies.command_studies import CommandSetup, CommandStudies
from drivora_service.suites.minimization.minimization_runner import MinimizationRunner
from drivora_service.trace_settings import trace_places
from drivora_service.worker_settings import (
    run_limits,
    start_executor,
    with_shared_paths,
    worker_setup,
)

_NO_LIMIT = 1 << 60
"""A command is bounded by its own memory."""

_STORAGE_PATIENCE_S = 5.0
"""Seconds after which a command ends if nothing can be stored."""

LOCAL_EVALUATOR = "local"


class CommandRuns:
    """The dispatcher of a command and its workers; they start with the first runs."""

    def __init__(
        self, settings: Settings, database: CommandDatabase, places: TracePlaces, most: int
    ) -> None:
        """Starts no worker yet; ``most`` is the number of worker processes at once."""
        self._settings, self._database, self._places = settings, database, places
        self._most = most
        self._stack = contextlib.ExitStack()
        self._starting = threading.Lock()
        self._dispatcher: Dispatcher | None = None
        self._executor: Executor | None = None
        self._reserved = 0
        self._infrastructure: Infrastructure | None = None
        self._owner_id = ""

    @property
    def fault(self) -> str:
        """Why no run can be started, "" while they can, or while a storage fault may pass."""
        if self._dispatcher is None or self._infrastructure is None:
            return ""
        return self._infrastructure.fault_for(_STORAGE_PATIENCE_S) or self._dispatcher.fault

    @property
    def owner_id(self) -> str:
        """Id of the process that owns the runs; "" before any were reserved."""
        return self._owner_id

    def reserve(self, runs: int) -> str:
        """Prepares for a number of runs, and returns the id of the process that owns them.

        Raises:
            StoreError: The database cannot be used.
        """
        with self._starting:
            self._reserved += runs
            slots = min(self._most, max(1, self._reserved))
            if self._executor is None:
                self._dispatcher = self._start_dispatcher(slots)
            elif isinstance(self._executor, LocalExecutor):
                self._executor.grow(slots)
        return self._owner_id

    def wake(self) -> None:
        """Notifies the dispatcher of queued or cancelled runs."""
        if self._dispatcher is not None:
            self._dispatcher.wake()

    def close(self) -> None:
        """Stops the workers; runs that have not ended are cancelled."""
        if self._dispatcher is not None:
            self._dispatcher.stop()
        self._stack.close()

    def _start_dispatcher(self, slots: int) -> Dispatcher:
        database, settings = self._database(), self._settings
        folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory(prefix="drivora-")))
        infrastructure = Infrastructure(
            {
                "database": database.probe,
                "traces": self._places.storage_probe() or folder_probe(settings.traces_dir),
            },
        )
        executor = self._stack.enter_context(
            contextlib.closing(start_executor(settings, slots=slots, folder=folder))
        )
        ownership = Ownership(
            database, RetryPolicy(), CommandLocks(settings.data_dir), is_command=True
        )
        database.damage.listen(partial(infrastructure.note_damage, "database"))
        dispatcher = Dispatcher(
            database, executor, self._places.of_runs(), infrastructure, ownership
        )
        infrastructure.start(on_change=dispatcher.wake)
        self._stack.callback(infrastructure.stop)
        dispatcher.start()
        self._executor, self._owner_id = executor, ownership.owner_id
        self._infrastructure = infrastructure
        return dispatcher


def create_command_app(
    settings: Settings,
    *,
    workers: int | None = None,
    evaluator: str = LOCAL_EVALUATOR,
    makes_data: bool = True,
    on_error: Callable[[BaseException], None] = lambda _error: None,
) -> FastAPI:
    """Builds the application of a command.

    Args:
        settings: Settings of the installation.
        workers: Worker processes at once; ``None``: as the settings have it, and for a campaign as
            its file has it.
        evaluator: Name of the evaluator of campaigns.
        makes_data: Whether data folder and database are made if they do not exist.
        on_error: Called with the error that stopped a campaign.

    Raises:
        UnknownName: There is no such evaluator.
    """
    settings = with_shared_paths(settings)
    plugin = evaluator_plugins().plugin(evaluator)
    places = trace_places(settings)

    def prepare(opened: Database) -> None:
        refuse_lost_runs(opened, places.of_runs(), settings.campaigns_dir)
        cancel_runs_of_dead_commands(opened, RetryPolicy(), CommandLocks(settings.data_dir))

    database = CommandDatabase(
        settings.data_dir,
        settings.resolved_database_url,
        makes_data=makes_data,
        on_opened=prepare,
    )
    trace_path = partial(find_trace_path, database, places.of_runs())
    runs = CommandRuns(settings, database, places, workers or settings.workers)
    catalogues = Catalogues(
        NetworkCatalogue(shipped_networks(), settings.imported_networks_dir),
        settings.agents_folder,
        read_law_sources(settings.laws_folder),
    )

    failure_traces = places.of_failures()

    def campaign_folder(campaign_id: str) -> CampaignFolder:
        return CampaignFolder(settings.campaigns_dir, campaign_id, failure_traces)

    @contextlib.contextmanager
    def open_evaluator(wanted: int | None) -> Iterator[Evaluator]:
        with tempfile.TemporaryDirectory(prefix="drivora-") as folder:
            if settings.executor != "local" and plugin is LOCAL:
                executor = start_executor(settings, slots=settings.workers, folder=Path(folder))
                with contextlib.closing(LocalEvaluator(executor)) as on_executor:
                    yield on_executor
                return
            context = EvaluatorContext(
                workers=workers or wanted or settings.workers,
                setup=worker_setup(settings),
                limits=run_limits(settings),
                folder=Path(folder),
            )
            with contextlib.closing(plugin.create(context)) as made:
                yield made

    memory = CallMemory(settings.campaign_memory_mb << 20)
    campaigns = CommandCampaigns(
        database, campaign_folder, catalogues, open_evaluator, on_error=on_error, memory=memory
    )

    @contextlib.contextmanager
    def open_pool(wanted: int | None) -> Iterator[SharedPool]:
        with (
            tempfile.TemporaryDirectory(prefix="drivora-") as folder,
            contextlib.closing(
                start_executor(
                    settings, slots=workers or wanted or settings.workers, folder=Path(folder)
                )
            ) as executor,
            SharedPool(executor) as pool,
        ):
            yield pool

    studies = CommandStudies(
        CommandSetup(
            database=database,
            campaign_folder=campaign_folder,
            catalogues=catalogues,
            pool=open_pool,
            on_error=on_error,
            memory=memory,
        )
    )
    minimizations = MinimizationRunner(
        database,
        catalogues,
        trace_path,
        owner_id=lambda: runs.owner_id,
        at_once=workers or settings.workers,
        on_queued=runs.wake,
    )
    stopping = threading.Event()

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        try:
            yield
        finally:
            stopping.set()
            studies.close()
            campaigns.close()
            minimizations.stop()
            runs.close()
            database.close()

    def faults() -> Mapping[str, str]:
        return {"workers": campaigns.fault or studies.fault or runs.fault or minimizations.fault}

    context = ApiContext(
        opened=database,
        revision=lambda: None,
        catalogues=catalogues,
        tokens=None,
        limits=Limits(
            body_bytes=_NO_LIMIT,
            network_bytes=_NO_LIMIT,
            batch_items=_NO_LIMIT,
            queued_runs=_NO_LIMIT,
        ),
        trace_path=trace_path,
        gene_spaces=GeneSpaces(catalogues),
        campaign_folder=campaign_folder,
        wake=runs.wake,
        campaigns=campaigns,
        studies=studies,
        minimizations=minimizations,
        imports=NetworkImports(settings.imported_networks_dir),
        reserve=runs.reserve,
        faults=faults,
        storage_fault=lambda: "",
        stopping=stopping.is_set,
        is_service=False,
    )
    return create_api(context, lifespan, on_demand=True)
