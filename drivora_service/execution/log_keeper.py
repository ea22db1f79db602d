"""Keeps the logs of workers short while code under test may write to them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable

import structlog

from drivora_service.execution.worker_log import WorkerLog
from drivora_service.fault_log import FaultLog

_LOOK_S = 0.01
"""Seconds between two looks at logs that grow: a process can write some 600 MB/s."""
_QUIET_LOOK_S = 0.05
"""Seconds between two looks while no log has grown by ``_GROWN_BYTES`` since the last one.

What all workers write within it before the first look at a flood is what the disk must hold.
"""
_GROWN_BYTES = 1 << 20


class LogKeeper:
    """A thread that cuts logs that are too long; one for all slots, which look less often."""

    def __init__(self, logs: Callable[[], Iterable[WorkerLog]]) -> None:
        """Creates the log keeper and starts its thread.

        Args:
            logs: Returns the logs there are at present.
        """
        self._logs = logs
        self._faults = FaultLog(structlog.get_logger(__name__))
        self._sizes: dict[WorkerLog, int] = {}
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._keep, name="log-keeper", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the thread and waits until it has ended."""
        self._closing.set()
        self._thread.join()

    def look(self) -> float:
        """Cuts the logs that are too long; returns the seconds until the next look."""
        before, self._sizes = self._sizes, {}
        wait = _QUIET_LOOK_S
        for log in self._logs():
            try:
                # Compared before it is cut: one that is written fast has the same size after it.
                if log.size() - before.get(log, 0) > _GROWN_BYTES:
                    wait = _LOOK_S
                self._sizes[log] = log.cut()
            except OSError as error:
                # Such as a full disk, which the log itself may have filled.
                self._faults.error("log_not_cut", error=str(error))
        return wait

    def _keep(self) -> None:
        wait = _LOOK_S
        while not self._closing.wait(wait):
            wait = self.look()
