"""The process of a service: its server, its address, and its shutdown."""

from __future__ import annotations

import asyncio
import contextlib
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

from drivora_service.api.guards.client_connections import BoundedConnection, raise_descriptor_limit
from drivora_service.api.guards.request_turns import urgent_requests
from drivora_service.app import Service, create_service
from drivora_service.errors import ServiceBroken
from drivora_service.fault_log import FaultLog
from drivora_service.logs import configure_logs
from drivora_service.server_socket import bind_address, start_listening
from drivora_service.settings import Settings
from drivora_service.visible_text import visible_text

ANNOUNCEMENT = "service.json"
"""File in the data folder with the address of a running service; of several, of the last one."""

_GRACE_S = 5
"""Seconds for which requests may continue when the server shuts down."""

_SWITCH_S = 0.001
"""Switch interval of threads, seconds. The event loop waits for so long for each busy thread; with
Python's own 5 ms, 40 busy threads delayed it by a quarter of a second, with this by 40 ms."""

_THREADS = 12
"""Number of requests processed at once. They take turns with the event loop, so that many of them
delay all others: with 40, health was answered after 180 ms, with 12 after 100 ms."""

_SHUTDOWN_S = 20.0
"""Seconds in which the server must shut down once nothing is running; then it is ended."""

_SECOND_SIGNAL_S = 5.0
"""The same after a second signal."""

_NOT_DONE = 3
"""Exit code of a process that had to be ended, as of all work that could not be done."""

_NO_DESCRIPTORS = (errno.EMFILE, errno.ENFILE)

_log = structlog.get_logger(__name__)


_NEW_OBJECTS = 50_000
"""Objects that are made, fewer those that are gone, before unreachable ones are sought: more than
the reports have that end between two transactions, so that those are gone before."""


def settle_garbage_collector() -> None:
    """Lets the garbage collector traverse neither permanent objects nor reports on their way.

    Nearly nothing in a report or a request refers to itself, so that it is freed without a search.
    Visiting permanent objects holds up every thread for a tenth of a second.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(_NEW_OBJECTS)


_GARBAGE_S = 60.0
"""Seconds between two searches for unreachable objects, however few new ones there are: what the
statements of a long campaign leave would else grow for an hour."""


def collect_garbage(loop: asyncio.AbstractEventLoop, every_s: float = _GARBAGE_S) -> None:
    """Frees unreachable objects now, and again and again while the loop runs.

    Permanent objects are not visited, so that every thread is held up for about 10 ms.

    Args:
        loop: Of the server.
        every_s: Seconds between two searches.
    """
    gc.collect()
    loop.call_later(every_s, collect_garbage, loop, every_s)


def serve_until_stopped(settings: Settings) -> None:
    """Serves HTTP until SIGINT or SIGTERM; ``service.json`` has the address.

    After the first signal, running runs may end for ``DRIVORA_DRAIN_S`` seconds, during which no
    new ones are accepted; a second signal ends the service at once.

    Raises:
        AddressTaken: Another process has the address.
        ConfigurationError: The settings cannot be used.
        Conflict: Another process serves this data folder.
        ServiceBroken: A part of it failed too often; the process must be restarted.
        StoreError: The database cannot be used.
    """
    configure_logs(form=settings.log_format, level=settings.log_level)
    sys.setswitchinterval(_SWITCH_S)
    ending = _Ending()
    # Before the service takes its data folder and starts workers, which it would have to give up.
    listener = bind_address(settings.host, settings.port)
    service = create_service(settings, on_fatal=ending.break_down)
    BoundedConnection.most = raise_descriptor_limit()
    BoundedConnection.urgent = urgent_requests(settings.resolved_root_path)
    BoundedConnection.most_of_a_client = settings.max_client_connections
    BoundedConnection.head_s = settings.head_deadline_s
    BoundedConnection.counts = service.api.state.client_counts
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
    start_listening(listener, settings.host)
    # asyncio sets this for sockets with a protocol number, which uvicorn's do not have: head and
    # body of an answer are written one after the other, and the body would wait 40 ms for the
    # client's acknowledgement of the head. Connections inherit it.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    port = listener.getsockname()[1]
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    announcement = settings.data_dir / ANNOUNCEMENT
    server = _Server(config, service, ending, drain_s=settings.drain_s)
    ending.server = server
    _announce(announcement, settings.public_url or f"http://{host}:{port}{settings.root_path}")
    # uvicorn passes a signal on once it has shut down; this makes that a normal end.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        _log.info("stopped", advice="what is queued or paused is kept; start it again to go on")
    finally:
        _withdraw(announcement)
    if ending.broken:
        raise ServiceBroken(ending.broken)


class _Ending:
    """Ends the process if its parts do not end by themselves.

    Attributes:
        broken: Why a part has given up; "" while all parts work.
        server: Server to shut down then.
    """

    def __init__(self) -> None:
        self.broken = ""
        self.server: uvicorn.Server | None = None

    def break_down(self, message: str) -> None:
        """Takes why a part has given up, and ends the process; the first reason counts."""
        if self.broken:
            return
        self.broken = message
        # A broken part may also keep the server from shutting down.
        self.end_within(_SHUTDOWN_S)
        if self.server is not None:
            self.server.should_exit = True

    def end_within(self, seconds: float) -> None:
        """Ends the process after ``seconds`` if it has not ended by then.

        Its workers and campaigns end with it; the next start takes over runs that were not handed
        back.
        """
        deadline = threading.Timer(seconds, self._end_now)
        deadline.daemon = True
        deadline.start()

    def _end_now(self) -> None:
        reason = (
            self.broken or "the service did not end in time; the next start takes its runs over"
        )
        print(f"error: {visible_text(str(reason), has_lines=True)}", file=sys.stderr, flush=True)
        os._exit(_NOT_DONE)


class _Server(uvicorn.Server):
    """A server that answers requests while running runs end."""

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
        settle_garbage_collector()
        collect_garbage(asyncio.get_running_loop())

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Ends the requests that last, then all connections once their requests are answered."""
        self._service.end_requests()
        await super().shutdown(sockets)

    def _note_fault(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Logs at most once a minute that no file descriptor is left; logs other faults as usual.

        The loop tries once a second to accept all waiting connections, and reports each failure.
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
            # In a thread, because a signal handler interrupts the main thread anywhere.
            threading.Thread(target=self._drain, args=(sig, frame), name="drain").start()
            return
        self._service.stop_draining()
        self._ending.end_within(_SECOND_SIGNAL_S)
        self.config.timeout_graceful_shutdown = 1
        super().handle_exit(sig, frame)

    def _drain(self, sig: int, frame: FrameType | None) -> None:
        _log.info("draining", seconds=self._drain_s)
        self._ending.end_within(self._drain_s + _SHUTDOWN_S)
        try:
            self._service.drain(self._drain_s)
        finally:
            super().handle_exit(sig, frame)


def _withdraw(path: Path) -> None:
    """Removes the announcement, unless it is that of another server on the data folder."""
    with contextlib.suppress(FileNotFoundError, ValueError):
        if json.loads(path.read_text()).get("pid") == os.getpid():
            path.unlink()


def _announce(path: Path, url: str) -> None:
    partial = path.with_suffix(".new")
    partial.write_text(json.dumps({"url": url, "pid": os.getpid()}))
    partial.replace(path)
    _log.info("listening", url=url)
