"""The composition root: builds every part from the settings and joins them."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import structlog
import uvicorn
from fastapi import FastAPI

from drivora_service.api.application import create_api
from drivora_service.api.context import ApiContext, Limits
from drivora_service.api.tokens import TokenFile
from drivora_service.campaigns.engine_process import EngineSetup
from drivora_service.campaigns.gene_spaces import GeneSpaces
from drivora_service.campaigns.reading import installed_catalogues
from drivora_service.campaigns.supervisor import CampaignSupervisor
from drivora_service.errors import ConfigurationError
from drivora_service.execution.dispatcher import Dispatcher
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

_log = structlog.stdlib.get_logger(__name__)


def create_app(settings: Settings) -> FastAPI:
    """Builds the service; it begins to work with the first event of the application's life.

    Raises:
        ConfigurationError: The settings would open the service to others without tokens.
        Conflict: Another process serves this data folder.
        StoreError: The database cannot be used.
    """
    tokens = _tokens(settings)
    settings.data_dir.mkdir(parents=True, exist_ok=True)
    exclusive = settings.resolved_database_url.startswith("sqlite")
    lock = ServerLock(settings.data_dir)
    database = open_database(settings.resolved_database_url)
    traces = TraceFolder(settings.traces_dir)
    executor = LocalExecutor(
        slots=settings.workers,
        setup=worker_setup(settings),
        folder=settings.data_dir / "workers",
        limits=run_limits(settings),
    )
    dispatcher = Dispatcher(database, executor, traces, exclusive=exclusive)
    engine_setup = _engine_setup(settings)
    campaigns = CampaignSupervisor(
        database,
        engine_setup,
        at_once=settings.campaigns_at_once,
        on_queued=dispatcher.wake,
    )

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
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
        worker_fault=lambda: dispatcher.fault,
        campaigns_alive=lambda: campaigns.is_alive,
    )
    return create_api(context, lifespan)


def serve_until_stopped(settings: Settings) -> None:
    """Serves HTTP until SIGINT or SIGTERM; ``service.json`` says where.

    Raises:
        ConfigurationError: The settings cannot be used.
        Conflict: Another process serves this data folder.
        StoreError: The database cannot be used.
    """
    configure_logs(form=settings.log_format, level=settings.log_level)
    config = uvicorn.Config(
        create_app(settings),
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
        uvicorn.Server(config).run(sockets=[listener])
    except KeyboardInterrupt:
        _log.info("stopped")
    finally:
        announcement.unlink(missing_ok=True)


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
