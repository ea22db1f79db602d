"""The executor of one machine: K slots that share a queue."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType

from drivora_service.execution.executor import Limits
from drivora_service.execution.fork_server import prepare_processes
from drivora_service.execution.log_keeper import LogKeeper
from drivora_service.execution.slot import Slot
from drivora_service.execution.worker_starts import WorkerStarts
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import cancelled_report
from drivora_service.runs.run_report import RunSpec
from drivora_service.runs.slot_state import SlotState
from drivora_service.worker.loop import PERFORM, PREPARE, WARM_UP, WorkerTask


class LocalExecutor:
    """Runs attempts on worker processes of this machine. Safe to use from several threads."""

    def __init__(
        self,
        *,
        slots: int,
        setup: object,
        folder: Path,
        limits: Limits = Limits(),  # noqa: B008 # frozen
        perform: str = PERFORM,
        warm_up: str = WARM_UP,
        prepare: str = PREPARE,
    ) -> None:
        """Starts the slots; does not wait until their workers are ready.

        Args:
            slots: Worker processes.
            setup: Configuration of every worker; must be picklable.
            folder: For the workers' logs; made if it does not exist.
            limits: Limits of a worker.
            perform: Function that performs a run, as ``module:function``; see
                ``worker.loop.Perform``.
            warm_up: Function that prepares a worker, as ``module:function``, or "" for none.
            prepare: Function that decodes genes, as ``module:function``; see
                ``worker.loop.Prepare``.
        """
        # Workers without a warm-up need no preloaded imports.
        prepare_processes(preloaded=bool(warm_up))
        folder.mkdir(parents=True, exist_ok=True)
        lock = threading.RLock()
        # Two conditions of one lock: a run that is queued wakes one slot, and a run that has ended
        # wakes the caller of wait() only.
        self._work = threading.Condition(lock)
        self._over = threading.Condition(lock)
        self._wanted = 1
        self._growing = threading.Lock()
        self._waiting: deque[RunSpec] = deque()
        self._taken: set[str] = set()
        self._cancelled: set[str] = set()
        self._ended: deque[Callable[[], AttemptEnd]] = deque()
        self._woken = False
        self._closed = False
        task = WorkerTask(perform=perform, warm_up=warm_up, prepare=prepare, setup=setup)
        self._starts = WorkerStarts(on_fault=self.wake)
        self._slots: tuple[Slot, ...] = ()

        def start(name: str) -> Slot:
            self._starts.add(name)
            return Slot(
                name,
                task=task,
                log=folder / f"{name}.log",
                limits=limits,
                starts=self._starts,
                source=self,
                sink=self._put_end,
            )

        self._start_slot = start
        self.grow(slots)
        self._logs = LogKeeper(lambda: [slot.log for slot in self._slots])

    def grow(self, slots: int) -> None:
        """Starts more slots, until there are so many; does not wait until their workers are ready.

        Args:
            slots: Number of slots in all; fewer than there are change nothing.
        """
        with self._growing:
            for number in range(len(self._slots), slots):
                self._slots = (*self._slots, self._start_slot(f"slot-{number}"))

    @property
    def capacity(self) -> int:
        """Number of slots: attempts that can run at once."""
        return len(self._slots)

    @property
    def fault(self) -> str:
        """The reason that no worker can be started and what to do, "" without a fault."""
        return self._starts.fault

    def submit(self, spec: RunSpec) -> None:
        """Queues an attempt, which starts when a slot is free; first in, first out."""
        with self._work:
            if self._closed:
                raise RuntimeError("the executor is closed")
            self._waiting.append(spec)
            self._work.notify()

    def cancel(self, run_id: str) -> None:
        """Ends an attempt; its status is ``cancelled``, or that of its end just before."""
        with self._work:
            if run_id in self._taken:
                # Its slot checks this set from taking the run to the run's end.
                self._cancelled.add(run_id)
                return
            for spec in self._waiting:
                if spec.run_id == run_id:
                    self._waiting.remove(spec)
                    self._end_cancelled(run_id)
                    return

    def is_cancelled(self, run_id: str) -> bool:
        """Returns whether a run that a slot has taken was cancelled."""
        return run_id in self._cancelled

    def _end_cancelled(self, run_id: str) -> None:
        """Ends a run that no slot has started."""
        now = datetime.now(UTC)
        report = cancelled_report(run_id)
        end = AttemptEnd(report=report, worker="", started=now, ended=now)
        self._add_end(lambda: end)

    def withdraw(self) -> tuple[str, ...]:
        """Removes every spec that no slot has started; returns the ids of their runs."""
        with self._work:
            run_ids = tuple(spec.run_id for spec in self._waiting)
            self._waiting.clear()
        return run_ids

    def wait(self, timeout: float | None = None, *, count: int = 1) -> tuple[AttemptEnd, ...]:
        """Returns the attempts that have ended since the last call.

        Waits for ``count`` of them, until :meth:`wake` or for ``timeout`` seconds.
        """
        with self._over:
            self._wanted = count
            self._over.wait_for(
                lambda: len(self._ended) >= count or self._woken or self._closed, timeout
            )
            self._wanted = 1
            self._woken = False
            ended = tuple(self._ended)
            self._ended.clear()
        # Here, together and by the caller: the slots' threads go on with their next runs.
        return tuple(read() for read in ended)

    def wake(self) -> None:
        """Makes the current or next :meth:`wait` return at once."""
        with self._work:
            self._woken = True
            self._over.notify_all()

    def slots(self) -> tuple[SlotState, ...]:
        """Returns the state of each slot."""
        return tuple(slot.state() for slot in self._slots)

    def close(self) -> None:
        """Ends every attempt and every worker process; nothing is left behind."""
        with self._work:
            self._closed = True
            self._waiting.clear()
            self._work.notify_all()
            self._over.notify_all()
        for slot in self._slots:
            slot.stop()
        for slot in self._slots:
            slot.join()
        self._logs.close()

    def take(self) -> RunSpec | None:
        """Waits for the next run of a slot; ``None`` once the executor is closed."""
        with self._work:
            self._work.wait_for(lambda: self._waiting or self._closed)
            if self._closed:
                return None
            spec = self._waiting.popleft()
            self._taken.add(spec.run_id)
            return spec

    def put_back(self, spec: RunSpec) -> None:
        """Puts a run that a slot has not started back to the front of the queue."""
        with self._work:
            cancelled = spec.run_id in self._cancelled
            self._let_go(spec.run_id)
            if self._closed:
                return
            if cancelled:
                self._end_cancelled(spec.run_id)
                return
            self._waiting.appendleft(spec)
            self._work.notify()

    def _put_end(self, run_id: str, read: Callable[[], AttemptEnd]) -> None:
        with self._work:
            self._let_go(run_id)
            self._add_end(read)

    def _add_end(self, read: Callable[[], AttemptEnd]) -> None:
        self._ended.append(read)
        if len(self._ended) >= self._wanted:
            self._over.notify_all()

    def _let_go(self, run_id: str) -> None:
        self._taken.discard(run_id)
        self._cancelled.discard(run_id)

    def __enter__(self) -> LocalExecutor:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
