"""The process of a service: its server, its address, and how it ends."""

from __future__ import annotations

import asyncio
import errno
import gc
import json
import os
import signal
import socket
import sys
import threading
from pathlib import Path
from types import FrameType
from typing import Any

import structlog
import uvicorn
from anyio import to_thread

from drivora_service.api.connections import BoundedConnection, raise_descriptor_limit
from drivora_service.app import Service, create_service
from drivora_service.errors import ServiceBroken
from drivora_service.fault_log import FaultLog
from drivora_service.logs import configure_logs
from drivora_service.settings import Settings

ANNOUNCEMENT = "service.json"
"""File in the data folder that says where a running service listens."""

_GRACE_S = 5
"""Seconds that requests may go on for when the server shuts down."""

_SWITCH_S = 0.001
"""Seconds after which a thread of a request lets another one go on. The event loop waits for so
long for each of them; with Python's own 5 ms, 40 busy threads delayed it by a quarter of a second,
with this by 40 ms."""

_THREADS = 12
"""Requests whose answers are made at once. They take turns with the event loop, so that many of
them keep it from everybody else: with 40, health was told after 180 ms, with 12 after 100 ms."""

_SHUTDOWN_S = 20.0
"""Seconds in which the server must have shut down once nothing runs any more; then it is ended."""

_HURRY_S = 5.0
"""The same after a second signal."""

_NOT_DONE = 3
"""Exit code of a process that had to be ended, as of everything that could not be done."""

_NO_DESCRIPTORS = (errno.EMFILE, errno.ENFILE)

_log = structlog.get_logger(__name__)


def serve_until_stopped(settings: Settings) -> None:
    """Serves HTTP until SIGINT or SIGTERM; ``service.json`` says where.

    The first signal lets the runs that are going on end, for ``DRIVORA_DRAIN_S`` seconds, during
    which nothing new is taken; a second one ends the service at once.

    Raises:
        ConfigurationError: The settings cannot be used.
        Conflict: Another process serves this data folder.
        ServiceBroken: A part of it failed too often; whatever started the process shall do it anew.
        StoreError: The database cannot be used.
    """
    configure_logs(form=settings.log_format, level=settings.log_level)
    sys.setswitchinterval(_SWITCH_S)
    ending = _Ending()
    service = create_service(settings, on_fatal=ending.break_down)
    BoundedConnection.most = raise_descriptor_limit()
    config = uvicorn.Config(
        service.api,
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
    server = _Server(config, service, ending, drain_s=settings.drain_s)
    ending.server = server
    _announce(announcement, settings.public_url or f"http://{host}:{port}")
    # uvicorn passes a signal on once it has shut down; this makes that a normal end.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        _log.info("stopped")
    finally:
        announcement.unlink(missing_ok=True)
    if ending.broken:
        raise ServiceBroken(ending.broken)


class _Ending:
    """How the process ends if its parts do not end by themselves.

    Attributes:
        broken: Why a part has given up; "" while everything works.
        server: Is shut down then.
    """

    def __init__(self) -> None:
        self.broken = ""
        self.server: uvicorn.Server | None = None

    def break_down(self, message: str) -> None:
        """Takes why a part has given up, and ends the process; the first reason counts."""
        if self.broken:
            return
        self.broken = message
        # What is broken may also keep the server from shutting down.
        self.within(_SHUTDOWN_S)
        if self.server is not None:
            self.server.should_exit = True

    def within(self, seconds: float) -> None:
        """Ends the process after so many seconds if it has not ended by then.

        Its workers and campaigns end with it; runs that were not handed back are taken over by the
        next start.
        """
        deadline = threading.Timer(seconds, self._end_now)
        deadline.daemon = True
        deadline.start()

    def _end_now(self) -> None:
        reason = (
            self.broken or "the service did not end in time; the next start takes its runs over"
        )
        print(f"error: {reason}", file=sys.stderr, flush=True)
        os._exit(_NOT_DONE)


class _Server(uvicorn.Server):
    """A server that goes on answering while what runs comes to its end."""

    def __init__(
        self, config: uvicorn.Config, service: Service, ending: _Ending, *, drain_s: float
    ) -> None:
        super().__init__(config)
        self._service, self._ending, self._drain_s = service, ending, drain_s
        self._signals = 0
        self._faults = FaultLog(_log)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begins to take connections."""
        asyncio.get_running_loop().set_exception_handler(self._note_fault)
        await super().startup(sockets)
        to_thread.current_default_thread_limiter().total_tokens = _THREADS
        # What is there for good need not be looked through again and again by the collector, for
        # which every request would wait a tenth of a second.
        gc.collect()
        gc.freeze()

    def _note_fault(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Says once a minute that no descriptor is left for clients, and all else as ever.

        The loop tries once a second to take as many connections as may wait, and tells of each one.
        """
        fault = context.get("exception")
        if isinstance(fault, OSError) and fault.errno in _NO_DESCRIPTORS:
            self._faults.error("no_descriptors_for_clients", error=str(fault))
        else:
            loop.default_exception_handler(context)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begins to drain at the first signal, and ends at once at the second."""
        self._signals += 1
        if self._signals == 1:
            # A thread, because what is done here interrupts whatever the main thread does.
            threading.Thread(target=self._drain, args=(sig, frame), name="drain").start()
            return
        self._service.hurry()
        self._ending.within(_HURRY_S)
        self.config.timeout_graceful_shutdown = 1
        super().handle_exit(sig, frame)

    def _drain(self, sig: int, frame: FrameType | None) -> None:
        _log.info("draining", seconds=self._drain_s)
        self._ending.within(self._drain_s + _SHUTDOWN_S)
        try:
            self._service.drain(self._drain_s)
        finally:
            super().handle_exit(sig, frame)


def _announce(path: Path, url: str) -> None:
    partial = path.with_suffix(".new")
    partial.write_text(json.dumps({"url": url, "pid": os.getpid()}))
    partial.replace(path)
    _log.info("listening", url=url)
