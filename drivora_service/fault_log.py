"""Log lines about lasting faults: at most one a minute for each."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import structlog

EVERY_S = 60.0
"""Seconds between two lines about the same fault."""


@dataclass(slots=True)
class _FaultState:
    """The state of a fault in the log.

    Attributes:
        at: When its last line was written, by the clock of the log.
        left_out: Occurrences since then.
        lasts: Whether its end has not been written.
    """

    at: float
    left_out: int = 0
    lasts: bool = True


class FaultLog:
    """Writes faults to a log, each at most once a minute. Thread-safe.

    A line counts the occurrences left out since the last one about the same fault.
    """

    def __init__(
        self,
        log: structlog.typing.FilteringBoundLogger,
        *,
        every_s: float = EVERY_S,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Begins with no fault.

        Args:
            log: Log to write to.
            every_s: Seconds between two lines about the same fault.
            clock: Returns seconds that never go backwards.
        """
        self._log, self._every_s, self._clock = log, every_s, clock
        self._said: dict[str, _FaultState] = {}
        self._lock = threading.Lock()

    def error(self, fault: str, **values: object) -> None:
        """Writes a fault, unless it was written within the last minute.

        Args:
            fault: Name of the event, which identifies the fault.
            values: Further values of the line.
        """
        with self._lock:
            now, said = self._clock(), self._said.get(fault)
            if said is not None and now - said.at < self._every_s:
                said.left_out += 1
                return
            self._said[fault] = _FaultState(at=now)
        if said is not None and said.left_out:
            values["left_out"] = said.left_out
        self._log.error(fault, **values)

    def over(self, fault: str, event: str, **values: object) -> None:
        """Writes ``event``, once, if the fault was written and has ended."""
        with self._lock:
            said = self._said.get(fault)
            if said is None or not said.lasts:
                return
            said.lasts = False
        self._log.info(event, **values)
