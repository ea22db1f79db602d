"""The worker process of a slot: start, work, inspection, replacement."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from pathlib import Path

from drivora_service.execution.executor import Limits
from drivora_service.execution.kept_worker import KeeperLostError, KeptWorker, WorkerDiedError
from drivora_service.execution.sent_report import SentReport
from drivora_service.execution.worker_log import WorkerLog
from drivora_service.runs.candidate import Candidate
from drivora_service.runs.run_report import RunSpec
from drivora_service.simulation.run_phase import RunPhase
from drivora_service.worker.channel import LONGEST_BODY, Kind, ProtocolError
from drivora_service.worker.loop import WorkerTask
from drivora_service.worker.process_readings import (
    ProcessReading,
    proportional_memory,
    read_process,
)
from drivora_service.worker.progress_board import NO_PROGRESS, Progress
from drivora_service.worker.worker_messages import NotReady, candidate_of, message_of

_DESCENDANTS_EVERY_S = 0.7
"""Seconds between two measurements of the memory of processes started in the worker."""

_READY_AGAIN_S = 5.0
"""Seconds within which a process must be ready after a report; a worker takes microseconds."""


class NotReadyError(Exception):
    """The worker process reported that it cannot work; the message is its reason."""


class Child:
    """A worker process and its successors.

    A process is replaced after a number of runs, after every run that did not finish, and after
    every death. The state of one process is kept in one object, so that no state of a dead process
    is used.

    Attributes:
        log: Output of the processes.
        ready: Whether the process has been set up.
        candidate: What a process that died made of the genes of its run, ``None`` before.
        restarts: Number of processes after the first.
    """

    def __init__(self, task: WorkerTask, *, log: Path, limits: Limits) -> None:
        """Creates the record, without a process; :meth:`replace` starts the first one."""
        self._task, self._limits = task, limits
        self._worker: KeptWorker | None = None
        self._runs = 0
        self._retired = False
        self._descendant_memory = 0
        self._next_descendants_look = 0.0
        self.log = WorkerLog(log, longest=limits.log_bytes)
        self.ready = False
        self._says_ready = False
        self.restarts = -1
        self.candidate: Candidate | None = None
        self._spec: RunSpec | None = None

    @property
    def pid(self) -> int | None:
        """The process's id, ``None`` while there is no process."""
        worker = self._worker
        return None if worker is None else worker.pid

    @property
    def is_idle(self) -> bool:
        """Whether the process is alive and waits for a run."""
        return self.ready and self._worker is not None and self._worker.is_idle

    @property
    def needs_replacement(self) -> bool:
        """Whether the process must be replaced before the next run."""
        return self._retired or self._runs >= self._limits.runs_per_worker

    @property
    def worker(self) -> object:
        """The identity of the process; another one after a replacement."""
        return self._worker

    def retire(self, worker: object = None) -> None:
        """Marks the process for replacement before the next run.

        Args:
            worker: The process that is meant, if it may have been replaced already.
        """
        # Without a lock: if the process is replaced at this moment, its successor is replaced once
        # too often, and the one that is meant never goes on.
        if worker is None or worker is self._worker:
            self._retired = True

    def wait_until_ready(self, timeout: float) -> bool:
        """Waits until the process is ready; ``False`` after ``timeout`` seconds.

        Raises:
            NotReadyError: It cannot work.
            WorkerDiedError: It has ended without a reason.
            KeeperLostError: Its keeper has ended.
            ProtocolError: It has sent something else.
        """
        worker = self._current()
        if not self._says_ready:
            frame = worker.receive(timeout)
            if frame is None:
                return False
            if frame.kind is not Kind.READY:
                message = message_of(frame)
                if isinstance(message, NotReady):
                    raise NotReadyError(message.reason)
                raise ProtocolError(f"the message {frame.kind.name} was not expected")
            self._says_ready = True
        # Nothing reads the keeper's messages while the worker is idle, so its id is read now.
        self.ready = worker.wait_until_known(timeout)
        return self.ready

    def begin(self, spec: RunSpec) -> None:
        """Hands a run to the process, which is idle."""
        self._spec, self.candidate = spec, None
        self.log.begin_run()
        self._runs += 1
        self._descendant_memory, self._next_descendants_look = 0, 0.0
        self._current().begin(spec)

    def wait(self, timeout: float) -> SentReport | None:
        """Waits for the report of the run; ``None`` after ``timeout`` seconds.

        Raises:
            WorkerDiedError: The process has ended and left no report.
            KeeperLostError: Its keeper has ended.
        """
        spec = self._spec
        if spec is None:
            raise ValueError("the process has no run")
        worker = self._current()
        frame = worker.receive(timeout)
        if frame is None:
            return None
        note = b"" if spec.candidate is None else worker.board.note(LONGEST_BODY)
        return SentReport(frame=frame, note=note, spec=spec)

    def is_ready_again(self) -> bool:
        """Waits until the process, which has sent a report, is ready for the next run.

        A report that code under test has sent is followed by that of the worker, which may come
        late and must not be taken for the report of the next run.

        Returns:
            False if something else came, or nothing within a few seconds.
        """
        until = time.monotonic() + _READY_AGAIN_S
        try:
            while time.monotonic() < until:
                frame = self._current().receive(_READY_AGAIN_S)
                if frame is not None:
                    return frame.kind is Kind.READY
        except (WorkerDiedError, KeeperLostError, ProtocolError):
            pass
        return False

    def _current(self) -> KeptWorker:
        if self._worker is None:
            raise WorkerDiedError(1)
        return self._worker

    def progress(self) -> Progress:
        """Returns the progress that the process shows."""
        worker = self._worker
        return NO_PROGRESS if worker is None else worker.board.read()

    @property
    def is_in_agent(self) -> bool:
        """Whether the process shows that it is within a call of an agent."""
        worker = self._worker
        return worker is not None and worker.board.phase() is RunPhase.IN_AGENT

    def reading(self) -> ProcessReading | None:
        """Returns the system's data on the process, ``None`` while there is no process."""
        pid = self.pid
        return None if pid is None else read_process(pid)

    def descendant_memory(self) -> int:
        """Returns the bytes of memory of the processes started in the process; 0 if there are none.

        It is measured at intervals and kept between them.
        """
        now = time.monotonic()
        if self._worker is None or now < self._next_descendants_look:
            return self._descendant_memory
        self._next_descendants_look = now + _DESCENDANTS_EVERY_S
        descendants = self._worker.descendants()
        if not descendants:
            self._descendant_memory = 0
            return 0
        readings = [reading for pid in descendants if (reading := read_process(pid)) is not None]
        memory = sum(reading.memory_bytes for reading in readings)
        own = self.reading()
        resident = 0 if own is None else own.memory_bytes
        if memory and resident + memory > self._limits.memory_bytes:
            # Forked processes share memory with their parent, which counts once.
            pid = self._worker.pid
            together = proportional_memory(descendants if pid is None else [pid, *descendants])
            memory = max(0, together - resident)
        self._descendant_memory = memory
        return memory

    def leftovers(self) -> Sequence[str]:
        """Returns the names of the processes that a run has left behind.

        Raises:
            KeeperLostError: The keeper has ended or does not answer.
        """
        return self._current().leftovers()

    def replace(self) -> None:
        """Ends the process, if there is one, and all that it started; starts another.

        Does not wait until the new process is ready.

        Raises:
            Exception: The system starts no process; the type depends on the missing resource.
        """
        self.end()
        log = self.log.open()
        self.log.mark()
        self._runs, self._retired = 0, False
        self._worker = KeptWorker(self._task, log)
        self.restarts += 1

    def end(self) -> None:
        """Ends the process and all that was started in it, and waits until they are gone."""
        worker, self._worker = self._worker, None
        self.ready = self._says_ready = False
        if worker is not None:
            if self._spec is not None and self.candidate is None:
                # The scenario in which the process has died is known in most cases.
                with contextlib.suppress(ProtocolError):
                    self.candidate = _candidate_of(self._spec, worker)
            worker.end()

    def close(self) -> None:
        """Ends the process and closes the log."""
        try:
            self.end()
        finally:
            self.log.close()


def _candidate_of(spec: RunSpec, worker: KeptWorker) -> Candidate | None:
    if spec.candidate is None:
        return None
    return candidate_of(worker.board.note(LONGEST_BODY), spec.candidate, spec.run_id)
