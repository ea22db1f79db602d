"""The loop between the store and the executor: it claims runs and stores their reports."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import structlog

from drivora_service.errors import StoreDamaged, StoreError, StoreUnavailable
from drivora_service.execution.executor import Executor
from drivora_service.execution.infrastructure import Infrastructure
from drivora_service.execution.interval import Interval
from drivora_service.execution.loss_pause import LossPause
from drivora_service.execution.ownership import Ownership
from drivora_service.execution.pace import Pace
from drivora_service.execution.storage_failures import (
    may_be_storage,
    unpreparable_trace,
    write_in_parts,
)
from drivora_service.execution.supervised import Backoff, SupervisedThread
from drivora_service.fault_log import FaultLog
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.run_report import RunSpec
from drivora_service.runs.slot_state import SlotState
from drivora_service.store.database import Database
from drivora_service.store.traces.trace_folders import RunTraces

_POLL_S = 0.5
"""Seconds between two looks for requests to cancel, and the longest wait for an end."""
_HEARTBEAT_S = 2.0
"""A third of ``ownership.LOCK_TIMEOUT_S``: one late heartbeat does not make this process dead."""

_WRITE_S = 0.4
"""Seconds between two transactions while the slots have work; one costs as much as ten runs in it,
so that ends of short runs are written together."""

_log = structlog.get_logger(__name__)


class Dispatcher:
    """A thread that keeps the executor's slots busy with the queued runs of the store.

    No other thread writes ends of runs. The next runs of the slots wait in the executor, so that no
    slot waits for the database. While the infrastructure has a fault, no run is claimed, and runs
    that end because of the fault go back to the queue unchanged. No run is claimed either in a
    pause after lost attempts, and those that wait for a slot then go back.
    """

    def __init__(
        self,
        database: Database,
        executor: Executor,
        traces: RunTraces,
        infrastructure: Infrastructure,
        ownership: Ownership,
        *,
        policy: RetryPolicy = RetryPolicy(),  # noqa: B008 # frozen
        on_fatal: Callable[[str], None] = lambda _message: None,
    ) -> None:
        """Creates the dispatcher; :meth:`start` starts its thread.

        Args:
            database: Holds the queue and the ends of runs.
            executor: Performs the runs. The caller closes it, after :meth:`stop`.
            traces: Folder into which workers write traces.
            infrastructure: Tells faults of the infrastructure from those of runs.
            ownership: This process as an owner of leases.
            policy: How often a run may fail for reasons that are not its own.
            on_fatal: Called from the thread with the reason for which it has given up.
        """
        self._database, self._executor, self._traces = database, executor, traces
        self._infrastructure = infrastructure
        self._policy = policy
        self._ownership = ownership
        # All down to _to_cancel belongs to the dispatcher's thread and needs no lock; wake() only
        # ends the interval of looks. None of it is stored: after a kill, the open leases in the
        # database say what was in flight, and runs whose ends were not written are simulated again.

        # The number of the attempt, by the id of its run.
        self._in_flight: dict[str, int] = {}
        self._claimed: deque[RunSpec] = deque()
        # Attempts that wait for the end of an earlier one at the same run, which no longer counts.
        self._next: dict[str, RunSpec] = {}
        self._unwritten: list[AttemptEnd] = []
        self._withdrawn: set[str] = set()
        self._faults = FaultLog(_log)
        self._pace = Pace()
        self._losses = LossPause()
        self._pause_begins = False
        self._next_write = 0.0
        self._beats, self._looks = Interval(_HEARTBEAT_S), Interval(_POLL_S)
        self._to_cancel: set[str] = set()
        # Reentrant, as a signal may interrupt the thread that holds it.
        self._ending = threading.RLock()
        self._stopping = threading.Event()
        self._stop_at = 0.0
        self._thread = SupervisedThread(
            "dispatcher",
            self._turn_or_end,
            at_end=self._release_all,
            explained=lambda: bool(self._infrastructure.confirm_now()),
            on_fatal=on_fatal,
            # Less than `ownership.LOCK_TIMEOUT_S`: a dispatcher that tries again is not dead.
            backoff=Backoff(longest_s=5.0),
        )

    def start(self) -> None:
        """Takes over the runs of dead servers and starts the loop.

        Raises:
            StoreError: The database cannot be used.
        """
        self._ownership.register()
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """Whether runs are being handed out."""
        return self._thread.is_alive and not self._stopping.is_set()

    @property
    def fault(self) -> str:
        """The reason that no run can be started and what to do, "" while they can."""
        if not self.is_alive:
            return "no runs are handed out: the thread that does it has ended; start anew"
        fault = self._executor.fault
        return f"no worker can be started: {fault}" if fault else ""

    def wake(self) -> None:
        """Signals that a run was queued or cancelled; without it, the loop sees it within 1 s."""
        self._looks.end()
        self._executor.wake()

    def stop(self, *, drain_s: float = 0.0) -> None:
        """Hands out no more runs and ends the loop; of several calls the first one counts.

        Args:
            drain_s: Seconds for which running runs may end; the others go back to the queue
                unchanged.
        """
        with self._ending:
            if not self._stopping.is_set():
                # Before the event: the thread reads the time once it has seen the event.
                self._stop_at = time.monotonic() + drain_s
                self._stopping.set()
        self._executor.wake()
        self._thread.join()

    def stop_draining(self) -> None:
        """Ends the wait of the current or next :meth:`stop` for runs."""
        with self._ending:
            self._stop_at = 0.0
            self._stopping.set()
        self._executor.wake()

    def _turn_or_end(self) -> None:
        # In a damaged database no end can be written, so that none is waited for.
        is_over = time.monotonic() >= self._stop_at or bool(self._database.damage.found)
        if self._stopping.is_set() and (not self._in_flight or is_over):
            self._thread.stop()
            return
        self._turn()

    def _turn(self) -> None:
        # In this order: what a fault has ended or keeps from starting is withdrawn and released
        # before the claim, which therefore counts only runs that the executor has. Requests to
        # cancel follow the submission: the executor cannot cancel a run that it does not have. An
        # exception anywhere makes the whole turn repeat; each step forgets only what it has done.
        self._collect()
        self._withdraw_on_fault()
        self._release_withdrawn()
        if self._unwritten or self._has_room_and_work():
            self._write_and_claim()
            self._next_write = time.monotonic() + _WRITE_S
        self._submit_claimed()
        self._cancel()
        self._beat()

    def _collect(self) -> None:
        """Collects ended attempts; waits for more as long as no slot can run out of work."""
        # What a turn that failed has left behind does not wait for another end.
        timeout = 0.0 if self._unwritten or self._claimed else _POLL_S
        count = 1
        while True:
            ended = self._executor.wait(timeout, count=count)
            self._take_ends(ended)
            if len(ended) < count:
                # The time is over, or it was woken.
                return
            timeout = self._next_write - time.monotonic()
            # Woken once for all ends up to the next transaction, and not for each. After so many
            # more, the executor has one run for each slot and none to spare, so that the next end
            # would leave a slot idle: then it is time to claim.
            count = len(self._in_flight) - len(self._unwritten) - self._executor.capacity
            if timeout <= 0 or count <= 0 or self._stopping.is_set():
                return

    def _take_ends(self, ends: Sequence[AttemptEnd]) -> None:
        """Keeps ends to be written; runs that a storage fault ended go back to the queue."""
        for end in ends:
            self._pace.note((end.ended - end.started).total_seconds())
        # With the number of its attempt, an end cannot close a later attempt at the same run, which
        # there is if this process was taken for dead meanwhile. This process has no open lease of
        # a run that is not in flight: the store leaves such an end out, whatever its number.
        ends = [
            replace(end, attempt=self._in_flight.get(end.report.run_id, 0))
            for end in ends
            if not self._claim_next(end.report.run_id)
        ]
        self._unwritten += ends
        # Probed now, as a fault may be younger than the last regular probe. If none is found, the
        # end counts: a run that fills the disk itself must not be repeated for ever.
        suspects = [end for end in ends if may_be_storage(end.report)]
        if not suspects or not self._infrastructure.confirm_now():
            self._note_losses(ends)
            return
        self._withdrawn.update(end.report.run_id for end in suspects)
        self._unwritten = [end for end in self._unwritten if end not in suspects]

    def _note_losses(self, ends: Sequence[AttemptEnd]) -> None:
        for end in ends:
            pause = self._losses.note(end)
            if pause:
                self._pause_begins = True
                failure = end.report.failure
                cause = "" if failure is None else failure.cause
                _log.warning("attempts_lost_in_a_row", last_cause=cause, pause_s=pause)

    def _claim_next(self, run_id: str) -> bool:
        """Returns whether a run's next attempt waited for the end of this one; it is begun then."""
        spec = self._next.pop(run_id, None)
        if spec is not None:
            self._in_flight[run_id] = spec.attempt
            self._claimed.append(spec)
        return spec is not None

    def _room(self, *, ended: int = 0) -> int:
        """Returns how many runs may be claimed now if ``ended`` of those in flight have ended."""
        if self._stopping.is_set() or self._executor.fault or self._infrastructure.fault:
            return 0
        if self._losses.is_on:
            return 0
        return self._pace.target_in_flight(self._executor.capacity) - len(self._in_flight) + ended

    def _has_room_and_work(self) -> bool:
        if self._room() <= 0:
            return False
        # By a reader: a claim that finds nothing would hold up the writers of other processes.
        with self._database.read() as transaction:
            return transaction.queue.has_work(self._ownership.reserved_to)

    def _write_and_claim(self) -> None:
        """Writes the collected ends and claims runs, in one transaction."""
        try:
            self._commit(self._unwritten, room=self._room(ended=len(self._unwritten)))
        except Exception as error:
            # What was to be done beside it is due still.
            self._beats.end()
            self._looks.end()
            if not self._unwritten or isinstance(error, StoreUnavailable):
                raise
            # One of the reports cannot be written; it must not hold up the others. These
            # transactions claim nothing, which the next turn does.
            self._faults.error("unwritable_report", error=repr(error))
            write_in_parts(self._unwritten, self._commit)

    def _commit(self, ends: Sequence[AttemptEnd], *, room: int = 0) -> None:
        done = {end.report.run_id for end in ends}
        # What is due costs least in a transaction that is made anyway. Both intervals begin before
        # it: wake() during the transaction ends the new one, so that there is another look.
        looks, beats = self._looks.is_over(), self._beats.is_over()
        slots = self._slots() if beats else ()
        with self._database.write() as transaction:
            specs = transaction.queue.finish_and_claim(
                self._ownership.owner_id,
                ends,
                self._policy,
                room,
                trace_path=self._traces.address,
                reserved_to=self._ownership.reserved_to,
            )
            cancelled = transaction.queue.to_cancel() if looks else ()
            if beats:
                transaction.workers.beat(self._ownership.owner_id, slots)
        # Memory follows the commit. If the connection broke during the commit, the ends are tried
        # again, and those that were written after all find no open lease.
        self._unwritten = [end for end in self._unwritten if end.report.run_id not in done]
        self._forget(done)
        for spec in specs:
            if spec.run_id in self._in_flight:
                # This process was taken for dead: its earlier attempt no longer counts. The
                # executor knows runs by their ids, so the new attempt waits for the earlier one.
                self._next[spec.run_id] = spec
            else:
                self._in_flight[spec.run_id] = spec.attempt
                self._claimed.append(spec)
        self._to_cancel.update(cancelled)
        if beats:
            # After the transaction, as it makes one for each dead owner.
            self._ownership.take_over()

    def _submit_claimed(self) -> None:
        """Submits the claimed runs to the executor; those that it refuses are tried again."""
        while self._claimed:
            spec = self._claimed[0]
            if spec.trace_path:
                try:
                    self._traces.prepare(spec.run_id, spec.attempt)
                except OSError as error:
                    self._claimed.popleft()
                    self._take_ends([unpreparable_trace(spec, error)])
                    continue
            # Forgotten only once the executor has it: an exception leaves it to the next turn.
            self._executor.submit(spec)
            self._claimed.popleft()

    def _withdraw_on_fault(self) -> None:
        """Withdraws runs that cannot be started."""
        fault = self._executor.fault
        if fault:
            self._faults.error("workers_cannot_start", reason=fault)
        else:
            self._faults.over("workers_cannot_start", "workers_start_again")
        if fault or self._infrastructure.fault or self._stopping.is_set() or self._pause_begins:
            # In each turn: a slot may have put back a run whose worker was not ready. In a pause
            # once: it holds for all slots, of which some may be well, and nodes of a cluster may
            # take seconds to answer.
            self._withdrawn.update(self._executor.withdraw())
            self._withdrawn.update(spec.run_id for spec in self._claimed)
            self._claimed.clear()
            self._pause_begins = False

    def _release_withdrawn(self) -> None:
        """Puts withdrawn runs back into the queue, unchanged."""
        if not self._withdrawn:
            return
        with self._database.write() as transaction:
            transaction.queue.release(self._ownership.owner_id, sorted(self._withdrawn))
        # After the commit: until then, the next turn releases them again.
        self._forget(self._withdrawn)
        self._withdrawn.clear()

    def _forget(self, run_ids: Iterable[str]) -> None:
        # A lease is that of the latest attempt: with it, the one that waits is closed as well.
        for run_id in run_ids:
            self._in_flight.pop(run_id, None)
            self._next.pop(run_id, None)

    def _cancel(self) -> None:
        """Cancels runs, repeatedly, since a run may be on its way from one queue to another."""
        if self._in_flight and self._looks.is_over():
            with self._database.read() as transaction:
                self._to_cancel.update(transaction.queue.to_cancel())
        # Attempts that no longer count are cancelled as well: their successors wait for their ends.
        wanted = self._in_flight.keys() & (self._to_cancel | self._next.keys())
        self._to_cancel.clear()
        for run_id in wanted.difference(end.report.run_id for end in self._unwritten):
            self._executor.cancel(run_id)

    def _beat(self) -> None:
        if self._beats.is_over():
            self._ownership.beat(self._slots())

    def _slots(self) -> tuple[SlotState, ...]:
        try:
            return self._executor.slots()
        except Exception as error:
            # The heartbeat matters more than the state of the slots in it.
            self._faults.error("slots_unknown", exc_info=error)
            return ()

    def _release_all(self) -> None:
        # Also if the thread has given up: nothing may be claimed below.
        self._stopping.set()
        try:
            # Ends first: leaving releases what is still in flight, to be simulated again.
            if self._unwritten:
                self._write_and_claim()
            # The executor, which is closed later, may still perform some. They do no harm: their
            # ends are not written, and each attempt has a trace of its own.
            self._ownership.leave(sorted(self._in_flight))
        except StoreDamaged:
            # Nothing is stored any more; with the restored database, the runs are queued again.
            return
        except StoreError as error:
            # The next server takes the runs over.
            _log.error("lease_release_failed", error=str(error))
