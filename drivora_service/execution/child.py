"""The one worker process of a slot: starting it, giving it work, ending it, burying it."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import time
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

import psutil

from drivora_service.execution.fork_server import exit_code, kill_process, start_process
from drivora_service.execution.worker import NotReady, Ready, WorkerFiles, serve
from drivora_service.runs.progress import Progress, ProgressBoard
from drivora_service.runs.report import RunReport, RunSpec

_TAIL_BYTES = 16_384
_TAIL_LINES = 40
_LOG_BYTES = 4 << 20
_GROUP_S = 1.0
"""Seconds in which a killed group of processes is gone, if somebody asks how its members ended."""


class WorkerDiedError(Exception):
    """The worker process ended unasked.

    Attributes:
        exit_code: Its exit code; the negative number of the signal that ended it, if one did.
    """

    def __init__(self, exit_code: int) -> None:
        """Takes the attribute."""
        super().__init__(f"the worker process ended with {exit_code}")
        self.exit_code = exit_code


class NotReadyError(Exception):
    """The worker process has found that it cannot work; its message says why."""


class Child:
    """A worker process and its successors.

    A process is replaced after a number of runs, and after every death. A connection and a process
    belong to each other, so that nothing which a dead process held can matter.

    Attributes:
        ready: Whether the process has been set up.
        restarts: Processes there have been, beyond the first.
    """

    def __init__(
        self, *, perform: str, warm_up: str, setup: object, files: WorkerFiles, runs_per_worker: int
    ) -> None:
        """Prepares; :meth:`replace` starts the first process."""
        self._initial = (perform, warm_up, setup, files)
        self._files = files
        self._runs_per_worker = runs_per_worker
        self._process: BaseProcess | None = None
        self._pid: int | None = None
        self._seen: psutil.Process | None = None
        self._channel: Connection | None = None
        self._log_begin = 0
        self._runs = 0
        self.ready = False
        self.restarts = -1
        self._board: ProgressBoard | None = None

    @property
    def pid(self) -> int | None:
        """The process's id, ``None`` while there is no process."""
        # Kept apart: a process object that is being closed has none any more.
        return self._pid

    @property
    def lives(self) -> bool:
        """Whether there is a process that has not ended."""
        return self._process is not None and not wait([self._process.sentinel], 0)

    @property
    def worn(self) -> bool:
        """Whether the process has had its runs and is to be replaced."""
        return self._runs >= self._runs_per_worker

    def wait_until_ready(self, timeout: float) -> bool:
        """Waits until the process is ready; ``False`` after ``timeout`` seconds.

        Raises:
            NotReadyError: It cannot work.
            WorkerDiedError: It has ended and did not say why.
        """
        message = self._receive(timeout)
        if isinstance(message, NotReady):
            raise NotReadyError(message.reason)
        self.ready = isinstance(message, Ready)
        return self.ready

    def begin(self, spec: RunSpec) -> None:
        """Hands a run to the process, which is ready; the last one has ended."""
        if self.log_size() > _LOG_BYTES:
            os.truncate(self._files.log, 0)
        self._runs += 1
        # A process that has died since it was looked at is found by whatever waits for the report.
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            if self._channel is not None:
                self._channel.send(spec)

    def wait(self, timeout: float) -> RunReport | None:
        """Waits for the report of the run; ``None`` after ``timeout`` seconds.

        Raises:
            WorkerDiedError: The process has ended and left no report.
        """
        message = self._receive(timeout)
        return message if isinstance(message, RunReport) else None

    def _receive(self, timeout: float) -> RunReport | Ready | NotReady | None:
        process, channel = self._process, self._channel
        if process is None or channel is None:
            raise WorkerDiedError(1)
        if not wait([channel, process.sentinel], timeout):
            return None
        # What it sent before it died counts.
        if channel.poll():
            try:
                message: RunReport | Ready | NotReady = channel.recv()
            except (EOFError, ConnectionResetError):
                # Closed by its end, which the system tells a little later.
                wait([process.sentinel])
            else:
                return message
        raise WorkerDiedError(exit_code(process) or 0)

    def progress(self) -> Progress | None:
        """Returns what the process shows of its progress, ``None`` before the first one."""
        board = self._board
        return None if board is None else board.read()

    def memory_bytes(self) -> int:
        """Resident memory of the process, 0 if there is none."""
        seen = self._seen
        try:
            return 0 if seen is None else int(seen.memory_info().rss)
        except (psutil.Error, OSError):
            return 0

    def log_size(self) -> int:
        """Bytes in the log; where the log of the next run will begin."""
        return self._files.log.stat().st_size if self._files.log.exists() else 0

    def log_tail(self, begin: int) -> str:
        """Returns the last lines printed after ``begin``; of a worker not yet ready, all."""
        if not self._files.log.exists():
            return ""
        if not self.ready:
            begin = self._log_begin
        with self._files.log.open("rb") as log:
            end = log.seek(0, os.SEEK_END)
            log.seek(max(begin if begin <= end else 0, end - _TAIL_BYTES))
            lines = log.read().decode(errors="replace").splitlines()
        return "\n".join(lines[-_TAIL_LINES:])

    def replace(self) -> None:
        """Ends the process, if there is one, with all that it started, and starts another.

        It gets ready while the caller goes on.

        Raises:
            Exception: The system gives no process; what kind depends on what is short.
        """
        self.end()
        self._files.board.parent.mkdir(parents=True, exist_ok=True)
        if self.restarts < 0:
            self._files.log.write_bytes(b"")
        # Mapped anew, so that both sides see the same file even if somebody has removed the old.
        self._board = ProgressBoard(self._files.board)
        self._board.cells[:] = 0
        self._start()
        self.restarts += 1

    def end(self) -> None:
        """Ends the process with all that it started, and waits until they are gone."""
        if self._process is not None:
            group, self._pid = self._pid, None
            # The group may outlive the process that leads it; a young one leads none yet.
            if group is not None:
                _signal_group(group, signal.SIGKILL)
            kill_process(self._process)
            until = time.monotonic() + _GROUP_S
            while group is not None and _signal_group(group, 0) and time.monotonic() < until:
                time.sleep(0.002)
        if self._channel is not None:
            self._channel.close()
        self._process = self._channel = self._seen = None
        self.ready = False

    def _start(self) -> None:
        self._log_begin = self.log_size()
        self._runs = 0
        ours, theirs = multiprocessing.Pipe()
        try:
            self._process = start_process(serve, (theirs, *self._initial))
        except BaseException:
            ours.close()
            raise
        finally:
            # With no end of it left here, the channel ends with the worker.
            theirs.close()
        self._channel = ours
        self._pid = self._process.pid
        with contextlib.suppress(psutil.NoSuchProcess):
            self._seen = psutil.Process(self._process.pid)


def _signal_group(group: int, number: int) -> bool:
    """Sends a signal to a group of processes, or looks for it with 0; tells if there is one."""
    try:
        os.killpg(group, number)
    except (ProcessLookupError, PermissionError):
        return False
    return True
