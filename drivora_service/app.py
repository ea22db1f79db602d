"""The composition root: builds every part from the settings and joins them."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import socket
import sys
import threading
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

import structlog
import uvicorn
from fastapi import FastAPI

from drivora_service.api.application import create_api
from drivora_service.api.connections import BoundedConnection, raise_descriptor_limit
from drivora_service.api.context import ApiContext, Limits
from drivora_service.api.tokens import TokenFile
from drivora_service.campaigns.engine_process import EngineSetup
from drivora_service.campaigns.gene_spaces import GeneSpaces
from drivora_service.campaigns.reading import installed_catalogues
from drivora_service.campaigns.supervisor import CampaignSupervisor
from drivora_service.errors import ConfigurationError, ServiceBroken
from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.infrastructure import Infrastructure, folder_probe
from drivora_service.execution.local import LocalExecutor
from drivora_service.logs import configure_logs
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.warm_up import warm_up_checks
from drivora_service.settings import Settings
from drivora_service.store.database import open_database
from drivora_service.store.server_lock import ServerLock
from drivora_service.store.traces import TraceFolder
from drivora_service.worker_settings import run_limits, worker_setup

ANNOUNCEMENT = "service.json"
"""File in the data folder that says where a running service listens."""

_GRACE_S = 5

_BREAKDOWN_S = 30.0
"""Seconds in which a server with a broken part must have shut down; then the process just ends."""

_BROKEN = 3
"""Exit code of such an end, as of everything that could not be done."""

_PATIENCE_S = 5.0
"""Seconds for which a request waits for other writers of the database."""

_log = structlog.stdlib.get_logger(__name__)


def create_app(
    settings: Settings, *, on_fatal: Callable[[str], None] = lambda _message: None
) -> FastAPI:
    """Builds the service; it begins to work with the first event of the application's life.

    Args:
        settings: Of the installation.
        on_fatal: Told why the process is of no use any more and must be started anew.

    Raises:
        ConfigurationError: The settings would open the service to others without tokens.
        Conflict: Another process serves this data folder.
        StoreError: The database cannot be used.
    """
    tokens = _tokens(settings)
    settings.data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
    exclusive = settings.resolved_database_url.startswith("sqlite")
    lock = ServerLock(settings.data_dir)
    database = open_database(settings.resolved_database_url, patience_s=_PATIENCE_S)
    traces = TraceFolder(settings.traces_dir)
    workers_folder = settings.data_dir / "workers"
    infrastructure = Infrastructure(
        {
            "database": database.probe,
            "traces": folder_probe(traces.root),
            "data": folder_probe(workers_folder),
        },
        on_fatal=on_fatal,
    )
    executor = LocalExecutor(
        slots=settings.workers,
        setup=worker_setup(settings),
        folder=workers_folder,
        limits=run_limits(settings),
    )
    dispatcher = Dispatcher(
        database, executor, traces, infrastructure, exclusive=exclusive, on_fatal=on_fatal
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

    def faults() -> Mapping[str, str]:
        return {
            **{condition.name: condition.fault for condition in infrastructure.conditions()},
            "workers": dispatcher.fault,
            "campaigns": campaigns.fault,
        }

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        infrastructure.start(on_change=dispatcher.wake)
        dispatcher.start()
        try:
            # Else the first document would wait for the kernels that check it.
            await asyncio.to_thread(warm_up_checks, NetworkCatalogue(shipped_networks()))
            campaigns.start()
            _log.info("ready", workers=settings.workers, data_dir=str(settings.data_dir))
            yield
        finally:
            campaigns.stop()
            dispatcher.stop()
            executor.close()
            infrastructure.stop()
            database.close()
            lock.release()

    catalogues = installed_catalogues(
        NetworkCatalogue(shipped_networks(), settings.imported_networks_dir),
        settings.agents_folder,
    )
    context = ApiContext(
        database=database,
        catalogues=catalogues,
        tokens=tokens,
        limits=Limits(
            body_bytes=int(settings.max_body_mb * (1 << 20)),
            batch_items=settings.max_batch_items,
            queued_runs=settings.queue_limit,
        ),
        trace_path=traces.path,
        gene_spaces=GeneSpaces(catalogues),
        campaign_folder=engine_setup.folder,
        wake=dispatcher.wake,
        wake_campaigns=campaigns.wake,
        faults=faults,
        storage_fault=lambda: infrastructure.fault,
        stopping=lambda: False,
    )
    return create_api(context, lifespan)


def serve_until_stopped(settings: Settings) -> None:
    """Serves HTTP until SIGINT or SIGTERM; ``service.json`` says where.

    Raises:
        ConfigurationError: The settings cannot be used.
        Conflict: Another process serves this data folder.
        ServiceBroken: A part of it failed too often; whatever started the process shall do it anew.
        StoreError: The database cannot be used.
    """
    configure_logs(form=settings.log_format, level=settings.log_level)
    breakdown = _Breakdown()
    BoundedConnection.most = raise_descriptor_limit()
    config = uvicorn.Config(
        create_app(settings, on_fatal=breakdown.report),
        http=BoundedConnection,
        ws="none",
        host=settings.host,
        port=settings.port,
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=_GRACE_S,
    )
    listener = config.bind_socket()
    # asyncio does this for sockets that name their protocol, which uvicorn's do not: head and body
    # of an answer are written one after the other, and the body would wait 40 ms for the client's
    # acknowledgement of the head. Connections inherit it.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    port = listener.getsockname()[1]
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    announcement = settings.data_dir / ANNOUNCEMENT
    _announce(announcement, settings.public_url or f"http://{host}:{port}")
    # uvicorn passes a signal on once it has shut down; this makes that a normal end.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        server = uvicorn.Server(config)
        breakdown.stop = partial(setattr, server, "should_exit", True)
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        _log.info("stopped")
    finally:
        announcement.unlink(missing_ok=True)
    if breakdown.message:
        raise ServiceBroken(breakdown.message)


class _Breakdown:
    """Ends the server when a part of it has given up.

    Attributes:
        message: Why it ended; "" while everything works.
        stop: Has the server shut down in good order.
    """

    def __init__(self) -> None:
        self.message = ""
        self.stop: Callable[[], None] = lambda: None

    def report(self, message: str) -> None:
        """Takes why a part has given up; the first reason counts."""
        if self.message:
            return
        self.message = message
        # What is broken may also keep the server from shutting down.
        deadline = threading.Timer(_BREAKDOWN_S, self._end_now)
        deadline.daemon = True
        deadline.start()
        self.stop()

    def _end_now(self) -> None:
        print(f"error: {self.message}", file=sys.stderr, flush=True)
        os._exit(_BROKEN)


def _announce(path: Path, url: str) -> None:
    partial = path.with_suffix(".new")
    partial.write_text(json.dumps({"url": url, "pid": os.getpid()}))
    partial.replace(path)
    _log.info("listening", url=url)


def _engine_setup(settings: Settings) -> EngineSetup:
    return EngineSetup(
        database_url=settings.resolved_database_url,
        campaigns=settings.campaigns_dir,
        traces=settings.traces_dir,
        shipped_networks=shipped_networks(),
        imported_networks=settings.imported_networks_dir,
        workers=settings.workers,
        agents=settings.agents_folder,
    )


def _tokens(settings: Settings) -> TokenFile | None:
    if settings.listens_on_loopback and not settings.require_tokens:
        return None
    tokens = TokenFile(settings.tokens_path)
    if not tokens.all():
        raise ConfigurationError(
            f"listening on {settings.host} needs API tokens, and there are none: make one with "
            f"`drivora tokens create NAME --data-dir {settings.data_dir}`, or listen on 127.0.0.1"
        )
    return tokens
