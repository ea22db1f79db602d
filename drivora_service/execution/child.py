"""The one worker of a slot: starting it, giving it work, looking at it, replacing it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from drivora_service.execution.executor import Limits
from drivora_service.execution.kept_worker import KeeperLostError, KeptWorker, WorkerDiedError
from drivora_service.execution.worker_log import WorkerLog
from drivora_service.runs.report import RunReport, RunSpec
from drivora_service.worker.channel import Kind, ProtocolError
from drivora_service.worker.loop import WorkerTask
from drivora_service.worker.messages import NotReady, message_of, report_of
from drivora_service.worker.processes import (
    ProcessReading,
    proportional_memory,
    read_process,
)
from drivora_service.worker.progress import NO_PROGRESS, Progress

_FAMILY_EVERY_S = 0.7
"""Seconds between two looks at the memory of what was started in the worker."""

_READY_AGAIN_S = 5.0
"""Seconds in which a process is ready again after a report; it takes a worker microseconds."""


class NotReadyError(Exception):
    """The worker process has found that it cannot work; its message says why."""


class Child:
    """A worker process and its successors.

    A process is replaced after a number of runs, after every run that did not end properly, and
    after every death. All that belongs to one process is kept in one object, so that nothing which
    a dead process held can matter.

    Attributes:
        log: What the processes print.
        ready: Whether the process has been set up.
        restarts: Processes there have been, beyond the first.
    """

    def __init__(self, task: WorkerTask, *, log: Path, limits: Limits) -> None:
        """Prepares; :meth:`replace` starts the first process."""
        self._task, self._limits = task, limits
        self._worker: KeptWorker | None = None
        self._runs = 0
        self._retired = False
        self._family_memory = 0
        self._next_family_look = 0.0
        self.log = WorkerLog(log, longest=limits.log_bytes)
        self.ready = False
        self.restarts = -1

    @property
    def pid(self) -> int | None:
        """The process's id, ``None`` while there is no process."""
        worker = self._worker
        return None if worker is None else worker.pid

    @property
    def is_idle(self) -> bool:
        """Whether there is a process that lives and waits for a run."""
        return self.ready and self._worker is not None and self._worker.is_idle

    @property
    def worn(self) -> bool:
        """Whether the process is to be replaced before the next run."""
        return self._retired or self._runs >= self._limits.runs_per_worker

    def retire(self) -> None:
        """Lets the process have no more runs."""
        self._retired = True

    def wait_until_ready(self, timeout: float) -> bool:
        """Waits until the process is ready; ``False`` after ``timeout`` seconds.

        Raises:
            NotReadyError: It cannot work.
            WorkerDiedError: It has ended and did not say why.
            KeeperLostError: Its keeper has ended.
            ProtocolError: It has sent something else.
        """
        frame = self._current().receive(timeout)
        if frame is None:
            return False
        if frame.kind is not Kind.READY:
            message = message_of(frame)
            if isinstance(message, NotReady):
                raise NotReadyError(message.reason)
            raise ProtocolError(f"the message {frame.kind.name} was not expected")
        self.ready = True
        return True

    def begin(self, spec: RunSpec) -> None:
        """Hands a run to the process, which is idle."""
        self.log.cut()
        self.log.mark()
        self._runs += 1
        self._family_memory, self._next_family_look = 0, 0.0
        self._current().begin(spec)

    def wait(self, run_id: str, timeout: float) -> RunReport | None:
        """Waits for the report of a run; ``None`` after ``timeout`` seconds.

        Raises:
            WorkerDiedError: The process has ended and left no report.
            KeeperLostError: Its keeper has ended.
            ProtocolError: It has sent something else.
        """
        frame = self._current().receive(timeout)
        return None if frame is None else report_of(frame, run_id)

    def is_ready_again(self) -> bool:
        """Waits until the process, which has sent a report, is ready for the next run.

        A report that code under test has sent is followed by that of the worker, which may come
        late: it is not to be taken for the report of the next run.

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
        """Returns what the process shows of its progress."""
        worker = self._worker
        return NO_PROGRESS if worker is None else worker.board.read()

    def reading(self) -> ProcessReading | None:
        """Returns what the system tells of the process, ``None`` while there is no process."""
        pid = self.pid
        return None if pid is None else read_process(pid)

    def family_memory(self) -> int:
        """Returns the bytes of memory of what was started in the process; 0 if that is nothing.

        It is measured now and then only.
        """
        now = time.monotonic()
        if self._worker is None or now < self._next_family_look:
            return self._family_memory
        self._next_family_look = now + _FAMILY_EVERY_S
        family = self._worker.family()
        readings = [reading for pid in family if (reading := read_process(pid)) is not None]
        memory = sum(reading.memory_bytes for reading in readings)
        own = self.reading()
        resident = 0 if own is None else own.memory_bytes
        if memory and resident + memory > self._limits.memory_bytes:
            # What a process forks shares its memory, which counts once.
            pid = self._worker.pid
            together = proportional_memory(family if pid is None else [pid, *family])
            memory = max(0, together - resident)
        self._family_memory = memory
        return memory

    def strangers(self) -> Sequence[str]:
        """Returns the names of the processes that a run has left behind.

        Raises:
            KeeperLostError: The keeper has ended or does not answer.
        """
        return self._current().strangers()

    def replace(self) -> None:
        """Ends the process, if there is one, with all that it started, and starts another.

        It gets ready while the caller goes on.

        Raises:
            Exception: The system gives no process; what kind depends on what is short.
        """
        self.end()
        log = self.log.open()
        self.log.mark()
        self._runs, self._retired = 0, False
        self._worker = KeptWorker(self._task, log)
        self.restarts += 1

    def end(self) -> None:
        """Ends the process with all that was started in it, and waits until they are gone."""
        worker, self._worker = self._worker, None
        self.ready = False
        if worker is not None:
            worker.end()

    def close(self) -> None:
        """Ends the process and lets go of the log."""
        try:
            self.end()
        finally:
            self.log.close()
