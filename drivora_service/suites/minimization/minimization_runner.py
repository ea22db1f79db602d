"""The thread that runs minimisations: it queues what they want, and tells them what has ended."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import structlog

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.errors import Conflict, DrivoraError, StoreError, UnknownName
from drivora_service.execution.supervised import SupervisedThread
from drivora_service.store.campaigns.evaluation_runs import evaluation_of_run
from drivora_service.store.database import Database, Transaction
from drivora_service.store.locks.work_locks import HeldWork, LongWork
from drivora_service.store.minimizations.minimization_records import (
    MinimizationProgress,
    MinimizationState,
)
from drivora_service.store.minimizations.minimization_repository import ActiveMinimization
from drivora_service.suites.minimization.abandonment import Abandoned, AbandonmentCheck

if TYPE_CHECKING:
    from drivora_service.store.runs.run_records import RunRecord
    from drivora_service.suites.minimization.minimization_work import Work

_IDLE_S = 1.0
"""Seconds between two looks for a minimisation that was not signalled."""
_BUSY_S = 0.02
"""Seconds between two looks whether a run has ended, each at a counter of the database."""
_BLIND_S = 0.25
"""The same where there is no counter: each look is a query."""

_log = structlog.get_logger(__name__)


class MinimizationRunner:
    """A thread that runs the minimisations of one process.

    Each is locked in the database: of several services on one database, one works on it. Nothing
    is kept but in the database: after a kill, a new thread goes on from the runs that have ended,
    and each of them counts once.
    """

    def __init__(
        self,
        database: Callable[[], Database],
        catalogues: Catalogues,
        trace_path: Callable[[str], Path],
        *,
        owner_id: Callable[[], str] = lambda: "",
        at_once: int,
        on_queued: Callable[[], None] = lambda: None,
        explained: Callable[[], bool] = lambda: False,
        on_fatal: Callable[[str], None] = lambda _message: None,
    ) -> None:
        """Creates the runner; :meth:`wake` starts its thread.

        Args:
            database: Returns the database.
            catalogues: Catalogues for the names in scenarios.
            trace_path: Returns the path of a run's trace, by the run's id.
            owner_id: Returns the command whose minimisations it runs; "": those of any service.
            at_once: Number of runs of a minimisation that are needed at once: the workers.
            on_queued: Called when runs were queued.
            explained: Whether a failure is due to a known fault of the infrastructure.
            on_fatal: Called with the reason for which the thread has given up.
        """
        self._database, self._catalogues, self._owner_id = database, catalogues, owner_id
        self._trace_path = trace_path
        self._at_once, self._on_queued = at_once, on_queued
        self._works: dict[str, Work] = {}
        self._locks: dict[str, HeldWork] = {}
        self._changes: int | None = None
        self._woken = threading.Event()
        self._starting = threading.Lock()
        self._has_started = False
        self._is_stopping = False
        self._thread = SupervisedThread(
            "minimizations", self._turn, explained=explained, on_fatal=on_fatal
        )

    @property
    def fault(self) -> str:
        """The reason that no minimisation goes on, "" while they do."""
        if not self._has_started or self._thread.is_alive:
            return ""
        return "no minimisation goes on: its thread has ended"

    def wake(self) -> None:
        """Signals a new or cancelled minimisation, and starts the thread if it has not begun."""
        with self._starting:
            if not self._has_started:
                self._has_started = True
                self._thread.start()
        self._woken.set()

    def stop(self) -> None:
        """Ends the thread; the minimisations of a service go on when it is started again."""
        self._is_stopping = True
        self._thread.stop()
        self._woken.set()
        self._thread.join()

    def _turn(self) -> None:
        database = self._database()
        has_counter = database.changes.value() is not None
        is_busy = bool(self._works)
        is_woken = self._woken.wait((_BUSY_S if has_counter else _BLIND_S) if is_busy else _IDLE_S)
        self._woken.clear()
        changes = database.changes.value()
        if not is_woken and changes is not None and changes == self._changes:
            return
        with database.read() as transaction:
            active = transaction.minimizations.active(self._owner_id())
        for gone in self._works.keys() - {one.id for one in active}:
            self._leave(gone)
        for one in active:
            self._step(database, one)
        # Read before the rows, so that a change meanwhile is not overlooked.
        self._changes = changes

    def _step(self, database: Database, active: ActiveMinimization) -> None:
        try:
            if active.id not in self._locks:
                self._locks[active.id] = database.locks.hold(LongWork.minimization(active.id))
        except Conflict:
            # Another service works on it.
            return
        try:
            work, is_new = self._work(database, active)
            ended = self._take_reports(database, work)
            if ended or is_new:
                self._advance(database, work)
        except (Abandoned, Conflict):
            # It was cancelled meanwhile, or the process ends.
            self._leave(active.id)
        except StoreError:
            # It passes; what is not stored is asked for again.
            self._leave(active.id)
            raise
        except (DrivoraError, ValueError) as error:
            _log.warning("minimization_failed", minimization=active.id, error=str(error))
            with database.write() as transaction:
                transaction.minimizations.advance(
                    active.id,
                    MinimizationProgress(),
                    MinimizationState.FAILED,
                    message=str(error),
                )
            self._leave(active.id)

    def _leave(self, minimization_id: str) -> None:
        """Works no more on a minimisation; another service may."""
        self._works.pop(minimization_id, None)
        lock = self._locks.pop(minimization_id, None)
        if lock is not None:
            lock.release()

    def _work(self, database: Database, active: ActiveMinimization) -> tuple[Work, bool]:
        """Returns a minimisation at work, and whether it has just begun or begun again."""
        known = self._works.get(active.id)
        if known is not None:
            return known, False
        # Imported here: they need the compiler of kernels, which few commands do.
        from drivora_service.suites.minimization.minimization_work import Work
        from drivora_service.suites.minimization.proposal_checking import Checker

        agents = self._catalogues.agents
        go_on = AbandonmentCheck(
            lambda: self._is_stopping, partial(self._is_active, database, active.id)
        )
        checker = Checker(self._catalogues.networks, agents.availability(), go_on)
        with database.read() as transaction:
            original = _read_original(transaction, active.run_id)
            work = Work(active, checker, agents, self._trace_path, original=original)
            work.resume(
                transaction.minimizations.reports(active.id),
                transaction.minimizations.unfinished_runs(active.id),
            )
        self._works[active.id] = work
        return work, True

    def _is_active(self, database: Database, minimization_id: str) -> bool:
        with database.read() as transaction:
            active = transaction.minimizations.active(self._owner_id())
        return any(one.id == minimization_id for one in active)

    def _take_reports(self, database: Database, work: Work) -> bool:
        """Tells a minimisation what has ended; returns whether anything has."""
        with database.read() as transaction:
            ended = transaction.campaign_runs.read_reports(tuple(work.waiting))
        for report, _ in ended:
            work.take(report)
        return bool(ended)

    def _advance(self, database: Database, work: Work) -> None:
        wanted = work.choose_runs(self._at_once)
        end, progress = work.end, work.progress
        with database.write() as transaction:
            if end is None:
                transaction.minimizations.advance(work.id, progress)
                transaction.campaign_runs.put(work.batch_id, *wanted)
            else:
                transaction.minimizations.advance(work.id, progress, end.state, message=end.message)
        if end is not None:
            _log.info("minimization_ended", minimization=work.id, state=end.state)
            self._leave(work.id)
        elif wanted:
            work.waiting.update(run.run_id for run in wanted)
            self._on_queued()


def _read_original(transaction: Transaction, run_id: str) -> RunRecord | None:
    """Returns the run that is minimised; ``None`` if it was removed."""
    try:
        return transaction.jobs.detail(run_id)
    except UnknownName:
        evaluation = evaluation_of_run(run_id)
    try:
        return None if evaluation is None else transaction.campaign_views.run(evaluation)
    except UnknownName:
        return None
