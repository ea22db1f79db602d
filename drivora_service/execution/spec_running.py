"""Running specs to their final reports without a database."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice

import structlog

from drivora_service.errors import WorkersCannotStart
from drivora_service.execution.executor import Executor
from drivora_service.execution.loss_pause import LossPause
from drivora_service.runs import lifecycle
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import RetryPolicy, RunState
from drivora_service.runs.run_report import RunReport, RunSpec

_LOOK_S = 0.2
"""Seconds between two looks whether a pause is over."""

_log = structlog.get_logger(__name__)


class Runs:
    """Runs in flight on an executor, each until its final report.

    Crashes are confirmed and lost attempts repeated, as in the service, with a pause between
    attempts that are lost in a row.
    """

    def __init__(
        self,
        executor: Executor,
        policy: RetryPolicy = RetryPolicy(),  # noqa: B008 # frozen
    ) -> None:
        """Creates the record, with no run in flight.

        Args:
            executor: Must have no other user meanwhile.
            policy: How often a run may fail for reasons that are not its own.
        """
        self._executor, self._policy = executor, policy
        self._running: dict[str, tuple[RunSpec, RunState]] = {}
        self._losses = LossPause()
        # Attempts that the executor does not have yet: they wait for the end of a pause.
        self._delayed: deque[RunSpec] = deque()

    def __len__(self) -> int:
        """Returns the number of runs in flight."""
        return len(self._running)

    def submit(self, spec: RunSpec) -> None:
        """Queues a run; its id must be unique."""
        self._attempt(spec, RunState())

    def wait(self, timeout: float | None = None, *, count: int = 1) -> tuple[AttemptEnd, ...]:
        """Waits for the ends of attempts; returns the last attempts of runs that ended with them.

        Their reports are those of the runs.

        Args:
            timeout: Seconds after which it returns in any case.
            count: Number of ends to wait for.

        Raises:
            WorkersCannotStart: No worker can be started; the runs in flight have not failed.
        """
        over: list[AttemptEnd] = []
        self._begin_delayed()
        if self._delayed:
            timeout = _LOOK_S if timeout is None else min(timeout, _LOOK_S)
        # Attempts that ended before the fault are returned first.
        ends = self._executor.wait(0.0 if self._executor.fault else timeout, count=count)
        if not ends and self._running and self._executor.fault:
            raise WorkersCannotStart(f"no worker can be started: {self._executor.fault}")
        for end in ends:
            spec, state = self._running.pop(end.report.run_id)
            self._note_loss(end)
            transition = lifecycle.end(state, end.report, self._policy)
            if transition.report is not None:
                over.append(replace(end, report=transition.report))
            else:
                self._attempt(spec, transition.state)
        return tuple(over)

    def discard(self, run_ids: Iterable[str]) -> tuple[str, ...]:
        """Forgets runs that wait for the end of a pause; returns their ids.

        The executor does not have them, so that it cannot cancel them.
        """
        wanted = frozenset(run_ids)
        found = tuple(spec.run_id for spec in self._delayed if spec.run_id in wanted)
        if found:
            self._delayed = deque(spec for spec in self._delayed if spec.run_id not in wanted)
            for run_id in found:
                del self._running[run_id]
        return found

    def _note_loss(self, end: AttemptEnd) -> None:
        pause = self._losses.note(end)
        if pause:
            cause = "" if end.report.failure is None else end.report.failure.cause
            _log.warning("attempts_lost_in_a_row", last_cause=cause, pause_s=pause)

    def _attempt(self, spec: RunSpec, state: RunState) -> None:
        self._running[spec.run_id] = (spec, lifecycle.start(state))
        self._delayed.append(spec)
        self._begin_delayed()

    def _begin_delayed(self) -> None:
        while self._delayed and not self._losses.is_on:
            self._executor.submit(self._delayed.popleft())


def run_all(
    executor: Executor,
    specs: Iterable[RunSpec],
    policy: RetryPolicy = RetryPolicy(),  # noqa: B008 # frozen
) -> Iterator[RunReport]:
    """Runs every spec; yields the reports in the order in which the runs end.

    ``specs`` is read as slots become free, so it may be long.

    Args:
        executor: Must have no other user meanwhile.
        specs: Runs with unique ids.
        policy: How often a run may fail for reasons that are not its own.

    Raises:
        WorkersCannotStart: No worker can be started.
    """
    coming = iter(specs)
    runs = Runs(executor, policy)
    while True:
        for spec in islice(coming, 2 * executor.capacity - len(runs)):
            runs.submit(spec)
        if not len(runs):
            return
        yield from (end.report for end in runs.wait())
