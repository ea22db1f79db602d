"""The executor's side of the process that is connected with the cluster."""

from __future__ import annotations

import contextlib
import multiprocessing
import threading
import time
from types import TracebackType
from typing import cast

from drivora_service.execution.fork_server import kill_process, spawn_process
from drivora_service.execution.ray.ray_driver import drive
from drivora_service.execution.ray.ray_messages import (
    ClusterSetup,
    FromCluster,
    Members,
    NotConnected,
    ToCluster,
)

_POLL_S = 0.5

_CONNECT_S = 120.0
"""Seconds within which the connection is made; Ray itself waits a minute for an address."""

_SILENCE_S = 30.0
"""Seconds without a list of nodes after which the cluster counts as lost; it comes once a second.
Ray itself needs as long to notice that a node does not answer."""


class ConnectionLostError(Exception):
    """The cluster cannot be used; the message says why and what to do."""


class Connected:
    """A process that is connected with the cluster; a context manager, which ends it.

    If this process dies, it dies, too, and Ray ends what it has started on the nodes.
    """

    def __init__(self, setup: ClusterSetup) -> None:
        """Starts the process that connects with the cluster; does not wait until it is connected.

        Raises:
            OSError: The system gives no process.
        """
        self._setup = setup
        self._pipe, theirs = multiprocessing.Pipe()
        try:
            self._process = spawn_process(drive, (setup, theirs))
        except BaseException:
            self._pipe.close()
            raise
        finally:
            theirs.close()
        self._heard = time.monotonic() + _CONNECT_S - _SILENCE_S
        self._sending = threading.Lock()

    def send(self, orders: ToCluster) -> None:
        """Sends orders; what a process that has ended does not get is lost with it."""
        with self._sending, contextlib.suppress(OSError):
            self._pipe.send(orders)

    def receive(self) -> FromCluster | None:
        """Waits for a message; ``None`` after half a second.

        Raises:
            ConnectionLostError: The process has ended, or the cluster does not answer.
        """
        try:
            if self._pipe.poll(_POLL_S):
                message = cast("FromCluster", self._pipe.recv())
                if isinstance(message, Members | NotConnected):
                    self._heard = time.monotonic()
                return message
        except (EOFError, OSError):
            raise ConnectionLostError(
                f"the connection with the Ray cluster at {self._setup.address} was lost; look at "
                f"the cluster (`ray status`) and at the end of {self._setup.log}"
            ) from None
        if time.monotonic() - self._heard > _SILENCE_S:
            raise ConnectionLostError(
                f"the Ray cluster at {self._setup.address} does not answer; look at its head node"
            )
        return None

    def close(self, timeout_s: float) -> None:
        """Ends what was started on the nodes, and waits for it ``timeout_s`` seconds at most."""
        until = time.monotonic() + timeout_s
        # In a thread, for a process that hangs takes no message.
        sender = threading.Thread(target=self.send, args=(None,), daemon=True)
        sender.start()
        sender.join(timeout_s)
        # Its last messages must not keep it from ending.
        with contextlib.suppress(EOFError, OSError):
            while time.monotonic() < until:
                if self._pipe.poll(_POLL_S):
                    self._pipe.recv()

    def __enter__(self) -> Connected:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        kill_process(self._process)
        self._pipe.close()
