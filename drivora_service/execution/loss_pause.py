"""The pause after attempts that were lost one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable

from drivora_service.runs.lifecycle import NOT_BEGUN
from drivora_service.runs.run_report import RunReport, RunStatus

_IN_A_ROW = 2
"""Lost attempts that begin a pause. One alone is common: a worker was killed."""

_FIRST_S, _FACTOR, _LONGEST_S = 2.0, 5.0, 30.0


class LossPause:
    """Keeps a fault of some seconds from taking all attempts of the runs that it meets.

    Some faults end every attempt, and no probe finds them: files of the workers may not grow, or
    something kills processes while memory is short. A run has few attempts, and is repeated at
    once: short runs would have lost all of theirs within three seconds, and be blamed for it. So
    nothing is started for a while after two lost attempts in a row, and longer if the first attempt
    after the pause is lost, too. An attempt that ends in any other way ends the pause.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._in_a_row = 0
        self._until = 0.0
        self._next_s = _FIRST_S

    def note(self, report: RunReport) -> float:
        """Counts the end of an attempt; returns the seconds of the pause that it begins, or 0."""
        if report.status is not RunStatus.INFRASTRUCTURE_FAILED:
            self._in_a_row, self._until, self._next_s = 0, 0.0, _FIRST_S
            return 0.0
        if report.failure is not None and report.failure.cause == NOT_BEGUN:
            # It costs its run no attempt, and other nodes may be well.
            return 0.0
        self._in_a_row += 1
        # What was running when the pause began says nothing about the time after it.
        if self._in_a_row < _IN_A_ROW or self.is_on:
            return 0.0
        pause, self._next_s = self._next_s, min(_FACTOR * self._next_s, _LONGEST_S)
        self._until = self._clock() + pause
        return pause

    @property
    def is_on(self) -> bool:
        """Whether no run may be started now."""
        return self._clock() < self._until
