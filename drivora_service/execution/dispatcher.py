"""The loop between the store and the executor: hands out runs, writes down what became of them."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from datetime import timedelta

import structlog

from drivora_service.errors import StoreError
from drivora_service.execution.executor import Executor
from drivora_service.execution.pace import Pace
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.store.database import Database
from drivora_service.store.traces import TraceFolder

_POLL_S = 0.5
_HEARTBEAT_S = 2.0
_SILENCE_S = 30.0
"""Seconds without a heartbeat after which another server's runs are taken over."""

_WRITE_S = 0.25
"""Seconds between two writings while the slots have work; a transaction costs as much as ten
steps of a simulation, so that ends of short runs are written together."""

_log = structlog.get_logger(__name__)


class Dispatcher:
    """A thread that keeps the executor's slots busy with what the store has queued.

    It is the only one that writes ends of runs. The next runs of the slots wait in the executor, so
    that no slot waits for the database.
    """

    def __init__(
        self,
        database: Database,
        executor: Executor,
        traces: TraceFolder,
        *,
        exclusive: bool,
        policy: RetryPolicy = RetryPolicy(),  # noqa: B008 # frozen
    ) -> None:
        """Prepares the loop.

        Args:
            database: What is queued, and where ends are written.
            executor: What runs it. Closing it is for the caller, after :meth:`stop`.
            traces: Where workers write traces.
            exclusive: Whether no other process can be dispatching from this database (the caller
                holds the ``ServerLock``), so that the leases of all others are taken over at once.
            policy: How often a run may fail for reasons that are not its own.
        """
        self._database, self._executor, self._traces = database, executor, traces
        self._exclusive, self._policy = exclusive, policy
        self._owner_id = ""
        self._in_flight: set[str] = set()
        self._unwritten: list[AttemptEnd] = []
        self._withdrawn: set[str] = set()
        self._fault = ""
        self._cancelling: set[str] = set()
        self._pace = Pace(executor.capacity)
        self._next_beat = 0.0
        self._next_write = 0.0
        self._stop_at: float | None = None
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)

    def start(self) -> None:
        """Takes over what dead servers left behind and starts the loop.

        Raises:
            StoreError: The database cannot be used.
        """
        with self._database.write() as transaction:
            self._owner_id = transaction.workers.register()
            transaction.idempotency.clean(unfinished=self._exclusive)
        self._take_over(silent_for=timedelta(0) if self._exclusive else timedelta(0, _SILENCE_S))
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """Whether runs are being handed out."""
        return self._thread.is_alive() and self._stop_at is None

    @property
    def fault(self) -> str:
        """Why no run can be handed out and what to do, "" while they are."""
        if not self.is_alive:
            return "no runs are handed out: the thread that does it has ended; restart the service"
        fault = self._executor.fault
        return f"no worker can be started: {fault}" if fault else ""

    def wake(self) -> None:
        """Tells that something was queued or cancelled; otherwise it is seen within a second."""
        self._executor.wake()

    def stop(self, *, drain_s: float = 0.0) -> None:
        """Hands out no more runs and ends the loop.

        Args:
            drain_s: Seconds for which runs that are going on may end; the others go back to the
                queue unharmed.
        """
        self._stop_at = time.monotonic() + drain_s
        self._executor.wake()
        self._thread.join()

    def _run(self) -> None:
        while not self._is_over():
            try:
                self._turn()
            except StoreError as error:
                # What has ended is still in hand and is written when the database is back.
                _log.error("database_unusable", error=str(error))
                time.sleep(_POLL_S)
        try:
            with self._database.write() as transaction:
                transaction.queue.release(self._owner_id, sorted(self._in_flight))
                transaction.workers.leave(self._owner_id)
        except StoreError as error:
            # The next server takes the runs over.
            _log.error("leaving_without_goodbye", error=str(error))

    def _is_over(self) -> bool:
        if self._stop_at is None:
            return False
        return not self._in_flight or time.monotonic() >= self._stop_at

    def _turn(self) -> None:
        self._collect()
        self._look_for_a_fault()
        if self._unwritten or self._has_room_and_work():
            for spec in self._write_and_claim():
                self._executor.submit(spec)
            self._next_write = time.monotonic() + _WRITE_S
        self._cancel()
        now = time.monotonic()
        if now >= self._next_beat:
            self._next_beat = now + _HEARTBEAT_S
            with self._database.write() as transaction:
                transaction.workers.beat(self._owner_id, self._executor.slots())
            if not self._exclusive:
                self._take_over(silent_for=timedelta(seconds=_SILENCE_S))

    def _collect(self) -> None:
        """Takes what has ended; lingers for more as long as no slot can run out of work."""
        timeout = 0.0 if self._unwritten else _POLL_S
        while True:
            ended = self._executor.wait(timeout)
            self._unwritten += ended
            for end in ended:
                self._pace.note((end.ended - end.started).total_seconds())
            timeout = self._next_write - time.monotonic()
            slots_have_work = len(self._in_flight) - len(self._unwritten) > self._executor.capacity
            if not ended or timeout <= 0 or not slots_have_work or self._stop_at is not None:
                return

    def _room(self) -> int:
        """Runs that may be claimed now."""
        if self._stop_at is not None or self._executor.fault:
            return 0
        return self._pace.wanted_in_flight() - len(self._in_flight)

    def _has_room_and_work(self) -> bool:
        if self._room() <= 0:
            return False
        with self._database.read() as transaction:
            return transaction.queue.has_work()

    def _write_and_claim(self) -> tuple[RunSpec, ...]:
        """Writes the ends in hand and claims what there is room for, in one transaction."""
        try:
            return self._commit(self._unwritten)
        except StoreError:
            raise
        except Exception as error:
            # One of the reports cannot be written as it is; the runs behind it shall not suffer.
            _log.error("unwritable_report", error=repr(error))
            for end in self._unwritten[:]:
                self._commit_alone(end)
            return ()

    def _commit(self, ends: Sequence[AttemptEnd]) -> tuple[RunSpec, ...]:
        done = {end.report.run_id for end in ends}
        with self._database.write() as transaction:
            transaction.queue.finish(self._owner_id, ends, self._policy)
            specs = transaction.queue.claim(
                self._owner_id, self._room() + len(done), trace_path=self._traces.prepare
            )
        self._unwritten = [end for end in self._unwritten if end.report.run_id not in done]
        self._in_flight -= done
        self._cancelling -= done
        self._in_flight |= {spec.run_id for spec in specs}
        return specs

    def _commit_alone(self, end: AttemptEnd) -> None:
        try:
            specs = self._commit([end])
        except StoreError:
            raise
        except Exception as error:
            specs = self._commit([replace(end, report=_unwritable(end.report, error))])
        for spec in specs:
            self._executor.submit(spec)

    def _look_for_a_fault(self) -> None:
        """Puts runs that cannot be begun back into the queue, unharmed; the log is told once."""
        before, self._fault = self._fault, self._executor.fault
        if self._fault:
            self._withdrawn.update(self._executor.withdraw())
            if not before:
                _log.error("workers_cannot_start", reason=self._fault)
        elif before:
            _log.info("workers_start_again")
        if not self._withdrawn:
            return
        with self._database.write() as transaction:
            transaction.queue.release(self._owner_id, sorted(self._withdrawn))
        self._in_flight -= self._withdrawn
        self._cancelling -= self._withdrawn
        self._withdrawn.clear()

    def _cancel(self) -> None:
        if not self._in_flight:
            return
        with self._database.read() as transaction:
            wanted = self._in_flight.intersection(transaction.queue.to_cancel())
        for run_id in wanted - self._cancelling:
            self._cancelling.add(run_id)
            self._executor.cancel(run_id)

    def _take_over(self, *, silent_for: timedelta) -> None:
        with self._database.read() as transaction:
            dead = transaction.workers.dead_owners(me=self._owner_id, silent_for=silent_for)
        for owner_id in dead:
            with self._database.write() as transaction:
                runs = transaction.queue.reclaim(owner_id, self._policy)
                transaction.workers.leave(owner_id)
            _log.warning("took_over_from_dead_server", owner=owner_id, runs=runs)


def _unwritable(report: RunReport, error: Exception) -> RunReport:
    return RunReport(
        run_id=report.run_id,
        status=RunStatus.INFRASTRUCTURE_FAILED,
        failure=RunFailure(
            cause="unwritable_report",
            message=f"the report of the {report.status} run cannot be stored: {error!r}"[:500],
        ),
    )
