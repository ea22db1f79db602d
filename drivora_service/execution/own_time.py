"""The time that a process had itself, measured from outside.

A process may be slow for reasons outside its code: stopped by a signal, waiting for swapped-out
memory, displaced by other processes, or sampled late by a slow server. So its own time is what
counts: the seconds in which it slept, which is up to its code, and the processor time that it used
otherwise.
"""

from __future__ import annotations

from drivora_service.worker.process_readings import ProcessReading

_LONGEST_GAP_S = 1.0
"""Seconds between two looks that count; more means that the server itself was delayed."""

_SLEEPING = frozenset("SIKWPXx")
"""States in ``proc(5)`` in which a process waits because of its code; R, D, T and t are not."""


class OwnTime:
    """The own time of one process, from one sample to the next."""

    def __init__(self, *, now: float) -> None:
        """Starts to count at ``now``, in seconds of a monotonic clock."""
        self._last = now
        self._cpu_s: float | None = None

    def add(self, process: ProcessReading | None, now: float) -> tuple[float, float]:
        """Accounts for a sample.

        Args:
            process: The system's data on the process, ``None`` if unknown.
            now: Seconds of the same clock.

        Returns:
            Seconds that have passed since the last sample, as far as they count, and the own ones.
        """
        elapsed = max(0.0, now - self._last)
        passed = min(elapsed, _LONGEST_GAP_S)
        if process is None or process.state in _SLEEPING:
            own = passed
        else:
            # Several threads may have used more than the wall time.
            own = 0.0 if self._cpu_s is None else min(process.cpu_s - self._cpu_s, elapsed)
        self._last = now
        self._cpu_s = self._cpu_s if process is None else process.cpu_s
        return passed, own
