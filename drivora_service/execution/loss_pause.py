"""The pause after attempts that were lost one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable

from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import NOT_BEGUN
from drivora_service.runs.run_report import RunStatus

_PAUSES_S = (2.0, 8.0, 30.0)
"""Seconds of the first pause, the second and all others of a row."""

_SAY_NOTHING = (RunStatus.CANCELLED, RunStatus.INVALID)
"""Ends of attempts that show neither that workers are well nor that they are not."""

_OTHER_CAUSES = (
    NOT_BEGUN,
    "agent_killed",
    "network_replaced",
    "worker_protocol",
    # Found after the wall time of a run; what lasts some seconds cannot take all attempts so.
    "worker_stopped",
)
"""Causes of lost attempts that come from a node, an ADS, a network, or last longer than a pause."""


class LossPause:
    """Keeps a fault of some seconds from taking all attempts of the runs that it meets.

    Some faults end every attempt, and no probe finds them: files of the workers may not grow, or
    something kills processes while memory is short. A run has few attempts, and is repeated at
    once: short runs would have lost all of theirs within three seconds. So no run is started for a
    while after two lost attempts in a row, and longer if an attempt that began after the pause is
    lost, too. A run that was lost twice in a row has one attempt left: the longer pause comes at
    once. An attempt that ends well ends the pause.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._last_lost = ""
        self._until = 0.0
        self._pauses = 0

    def note(self, end: AttemptEnd) -> float:
        """Counts the end of an attempt; returns the seconds of the pause that it begins, or 0."""
        report = end.report
        if report.status in _SAY_NOTHING:
            return 0.0
        if report.status is not RunStatus.INFRASTRUCTURE_FAILED:
            self._last_lost, self._until, self._pauses = "", 0.0, 0
            return 0.0
        if report.failure is not None and report.failure.cause in _OTHER_CAUSES:
            return 0.0
        now = self._clock()
        # What was running when a pause began says nothing about the time after it.
        if now - (end.ended - end.started).total_seconds() < self._until:
            return 0.0
        before, self._last_lost = self._last_lost, report.run_id
        if not before:
            # One alone is common: a worker was killed.
            return 0.0
        if before == report.run_id:
            self._pauses = max(self._pauses, 1)
        pause = _PAUSES_S[min(self._pauses, len(_PAUSES_S) - 1)]
        self._until, self._pauses = now + pause, self._pauses + 1
        return pause

    @property
    def is_on(self) -> bool:
        """Whether no run may be started now."""
        return self._clock() < self._until
