"""The composition root: builds every part from the settings and joins them."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial

import structlog
from fastapi import FastAPI

from drivora_service.api.answers.change_feed import feed_of
from drivora_service.api.answers.network_imports import NetworkImports
from drivora_service.api.application import create_api
from drivora_service.api.context import ApiContext, Limits
from drivora_service.api.guards.api_tokens import TokenFile
from drivora_service.api.guards.page_sessions import SessionFile
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.stored_gene_spaces import GeneSpaces
from drivora_service.campaigns.hosts.campaign_supervisor import CampaignSupervisor
from drivora_service.campaigns.hosts.engine_limits import EngineLimits
from drivora_service.campaigns.hosts.engine_process import EngineSetup
from drivora_service.dashboard.page import page_routes
from drivora_service.errors import ConfigurationError
from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.housekeeping import Housekeeping
from drivora_service.execution.infrastructure import Infrastructure, folder_probe
from drivora_service.execution.ownership import Ownership
from drivora_service.execution.start_check import StartCheck
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.oracles.laws.sources import read_law_sources
from drivora_service.retention_settings import retention
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.settings import Settings
from drivora_service.store.database import (
    Database,
    database_file,
    make_data_folder,
    open_database,
)
from drivora_service.store.locks.command_locks import CommandLocks
from drivora_service.store.locks.server_folder import ServerFolder
from drivora_service.store.locks.work_locks import WorkKind
from drivora_service.store.traces.stored_traces import find_trace_path
from drivora_service.store.traces.trace_folders import RunTraces
from drivora_service.store.upkeep.lost_runs import refuse_lost_runs
from drivora_service.studies.service_studies import ServiceStudies
from drivora_service.suites.minimization.minimization_runner import MinimizationRunner
from drivora_service.trace_settings import trace_places
from drivora_service.worker_settings import start_executor, with_shared_paths

_LOCK_TIMEOUT_S = 5.0
"""Seconds for which a request waits for other writers of the database."""

_MANY = 1 << 20
"""More workers than any campaign may want: a cluster has a number that changes."""

_log = structlog.stdlib.get_logger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """A service and its control.

    Attributes:
        api: The application; the service works during its life.
        drain: Takes no more work, waits for the given seconds for running runs, and puts the others
            back into the queue.
        stop_draining: Ends the wait of a drain.
        end_requests: Ends the streams of events and the import of a network, which would else last;
            called in the event loop.
    """

    api: FastAPI
    drain: Callable[[float], None]
    stop_draining: Callable[[], None]
    end_requests: Callable[[], None]


def create_app(settings: Settings) -> FastAPI:
    """Builds the application of a service, as :func:`create_service` says."""
    return create_service(settings).api


def create_service(
    settings: Settings, *, on_fatal: Callable[[str], None] = lambda _message: None
) -> Service:
    """Builds the service; it begins to work with the first event of the application's life.

    Args:
        settings: Settings of the installation.
        on_fatal: Called with the reason that the process must be restarted.

    Raises:
        ConfigurationError: The settings would open the service to others without tokens.
        Conflict: Another process serves this data folder.
        StoreDamaged: The database is damaged, or has lost its runs.
        StoreError: The database cannot be used.
    """
    settings = with_shared_paths(settings)
    tokens = _tokens(settings)
    make_data_folder(settings.data_dir)
    exclusive = settings.resolved_database_url.startswith("sqlite")
    folder = ServerFolder(settings.data_dir, is_shared=not exclusive)
    places = trace_places(settings)
    traces = places.of_runs()
    # Before a migration, and anything else, writes to the file.
    start_check = StartCheck(database_file(settings.resolved_database_url))
    database = _open_database(settings, traces)
    workers_folder = folder.logs
    infrastructure = Infrastructure(
        {
            "database": database.probe,
            "traces": places.storage_probe() or folder_probe(settings.traces_dir),
            "data": folder_probe(workers_folder),
        },
        on_fatal=on_fatal,
    )
    database.damage.listen(partial(infrastructure.note_damage, "database"))
    executor = start_executor(
        settings, slots=settings.workers, folder=workers_folder, shared_folder=workers_folder
    )
    ownership = Ownership(
        database, RetryPolicy(), CommandLocks(settings.data_dir), exclusive=exclusive
    )
    dispatcher = Dispatcher(
        database, executor, traces, infrastructure, ownership, on_fatal=on_fatal
    )
    engine_setup = _engine_setup(settings)
    campaigns = CampaignSupervisor(
        database,
        engine_setup,
        at_once=settings.campaigns_at_once,
        on_queued=dispatcher.wake,
        explained=lambda: bool(infrastructure.confirm_now()),
        on_fatal=on_fatal,
    )

    catalogues = Catalogues(
        NetworkCatalogue(shipped_networks(), settings.imported_networks_dir),
        settings.agents_folder,
        read_law_sources(settings.laws_folder),
    )
    trace_path = partial(find_trace_path, lambda: database, traces)
    minimizations = MinimizationRunner(
        lambda: database,
        catalogues,
        trace_path,
        at_once=settings.workers,
        on_queued=dispatcher.wake,
        explained=lambda: bool(infrastructure.confirm_now()),
        on_fatal=on_fatal,
    )
    stopping = threading.Event()

    housekeeping = Housekeeping(
        database,
        traces,
        places.of_failures(),
        retention(settings),
        explained=lambda: bool(infrastructure.confirm_now()),
    )

    def faults() -> Mapping[str, str]:
        return {
            **{condition.name: condition.fault for condition in infrastructure.conditions()},
            "workers": "" if stopping.is_set() else dispatcher.fault,
            "campaigns": "" if stopping.is_set() else campaigns.fault or minimizations.fault,
            "accepting": "the service is being stopped" if stopping.is_set() else "",
            "tokens": tokens.fault,
        }

    def drain(seconds: float) -> None:
        stopping.set()
        campaigns.stop()
        minimizations.stop()
        dispatcher.stop(drain_s=seconds)

    imports = NetworkImports(settings.imported_networks_dir)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        if not database.locks.is_any_held(WorkKind.SERVER):
            imports.remove_left()
        infrastructure.start(on_change=dispatcher.wake)
        dispatcher.start()
        try:
            # Else the first document would wait for the kernels that check it.
            await asyncio.to_thread(_warm_up)
            campaigns.start()
            minimizations.wake()
            housekeeping.start()
            start_check.start(database.damage)
            _log.info("ready", workers=executor.capacity, data_dir=str(settings.data_dir))
            yield
        finally:
            start_check.stop()
            housekeeping.stop()
            drain(0.0)
            executor.close()
            infrastructure.stop()
            database.close()
            folder.release()

    context = ApiContext(
        opened=lambda: database,
        revision=database.changes.value,
        catalogues=catalogues,
        tokens=tokens,
        sessions=SessionFile(settings.sessions_path, tokens),
        limits=Limits(
            body_bytes=int(settings.max_body_mb * (1 << 20)),
            network_bytes=int(settings.max_network_mb * (1 << 20)),
            batch_items=settings.max_batch_items,
            queued_runs=settings.queue_limit,
            body_s=settings.body_deadline_s,
            client_bodies=settings.max_client_bodies,
        ),
        trace_path=trace_path,
        gene_spaces=GeneSpaces(catalogues),
        campaign_folder=engine_setup.folder,
        wake=dispatcher.wake,
        campaigns=campaigns,
        studies=ServiceStudies(database, campaigns),
        minimizations=minimizations,
        imports=imports,
        reserve=lambda _runs: "",
        faults=faults,
        storage_fault=lambda: infrastructure.fault,
        stopping=stopping.is_set,
        owner_id=ownership.owner_id,
        own_slots=executor.slots,
        root_path=settings.resolved_root_path,
        is_public_https=settings.public_url.startswith("https:"),
    )
    api = create_api(context, lifespan, page=page_routes(root_path=settings.resolved_root_path))

    def end_requests() -> None:
        feed_of(api).close()
        imports.stop()

    return Service(
        api=api,
        drain=drain,
        stop_draining=dispatcher.stop_draining,
        end_requests=end_requests,
    )


def _open_database(settings: Settings, traces: RunTraces) -> Database:
    database = open_database(settings.resolved_database_url, patience_s=_LOCK_TIMEOUT_S)
    try:
        refuse_lost_runs(database, traces, settings.campaigns_dir)
    except BaseException:
        database.close()
        raise
    database.checkpoint()
    return database


def _engine_setup(settings: Settings) -> EngineSetup:
    return EngineSetup(
        database_url=settings.resolved_database_url,
        campaigns=settings.campaigns_dir,
        traces=trace_places(settings),
        shipped_networks=shipped_networks(),
        imported_networks=settings.imported_networks_dir,
        workers=settings.workers if settings.executor == "local" else _MANY,
        limits=EngineLimits(
            memory_bytes=settings.campaign_memory_mb << 20, call_s=settings.tester_deadline_s
        ),
        agents=settings.agents_folder,
        laws=read_law_sources(settings.laws_folder),
    )


def _tokens(settings: Settings) -> TokenFile:
    """Returns the tokens of a service; one that needs tokens and has none is refused."""
    tokens = TokenFile(settings.tokens_path, always_needed=settings.always_needs_tokens)
    make = f"`drivora tokens create NAME --data-dir {settings.data_dir}`"
    if not tokens.are_needed:
        _log.warning(
            "no_api_tokens",
            advice="all users and programs of this machine may do everything; "
            f"{make} makes a token, and every request needs one from then on",
        )
    elif not tokens.all():
        if not settings.listens_on_loopback:
            reason, other = f"listening on {settings.host}", "listen on 127.0.0.1"
        elif settings.require_tokens:
            reason, other = "DRIVORA_REQUIRE_TOKENS", "unset it"
        else:
            reason = f"{settings.tokens_path}, whose tokens were all revoked,"
            other = "remove that file to let all users of this machine in"
        raise ConfigurationError(
            f"{reason} needs API tokens, and there are none: make one with {make}, or {other}"
        )
    return tokens


def _warm_up() -> None:
    from drivora_service.scenario.check_warm_up import warm_up_checks

    warm_up_checks(NetworkCatalogue(shipped_networks()))
