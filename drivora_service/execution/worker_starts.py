"""Failed starts of workers, which are faults of the service and not of runs."""

from __future__ import annotations

import threading
from collections.abc import Callable

_MAX_LOST_STARTS = 3
"""Consecutive starts lost to a signal or a lack of memory before they count as a fault."""

_FIRST_PAUSE_S = 1.0
_LONGEST_PAUSE_S = 30.0


def pause_s(failures: int) -> float:
    """Returns the seconds to wait before the next start.

    Args:
        failures: Consecutive failed starts, at least one.
    """
    # An exponent beyond some 1,000 overflows a float.
    return float(min(_FIRST_PAUSE_S * 2.0 ** min(failures - 1, 30), _LONGEST_PAUSE_S))


class WorkerStarts:
    """The starts of the workers of all slots of an executor. Thread-safe.

    Workers cannot start if the last starts of every slot have failed.
    """

    def __init__(self, *, on_fault: Callable[[], None]) -> None:
        """Creates the record of an executor without slots and without a fault.

        Args:
            on_fault: Called, from the thread of a slot, when workers cannot start.
        """
        self._reasons: dict[str, str] = {}
        self._failures: dict[str, int] = {}
        self._on_fault = on_fault
        self._fault = ""
        self._lock = threading.Lock()

    def add(self, slot: str) -> None:
        """Adds a slot by its name."""
        with self._lock:
            self._reasons[slot], self._failures[slot] = "", 0

    @property
    def fault(self) -> str:
        """The reason that no worker can be started and what to do, "" without a fault."""
        return self._fault

    def note_success(self, slot: str) -> None:
        """Records that a worker of the slot is ready."""
        with self._lock:
            self._reasons[slot], self._failures[slot] = "", 0
            self._fault = ""

    def note_failure(self, slot: str, reason: str, *, certain: bool) -> float:
        """Records that a worker of the slot did not become ready.

        Args:
            slot: Its name.
            reason: What was found and what to do.
            certain: Whether the worker itself reported it, so that one failure is a fault.

        Returns:
            The seconds to wait before the next start.
        """
        with self._lock:
            self._failures[slot] += 1
            failures = self._failures[slot]
            if certain or failures >= _MAX_LOST_STARTS:
                self._reasons[slot] = reason
            new = not self._fault and all(self._reasons.values())
            if new:
                self._fault = reason
        if new:
            self._on_fault()
        return pause_s(failures)
