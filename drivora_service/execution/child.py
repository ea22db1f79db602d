"""The one worker process of a slot: starting it, giving it work, ending it, burying it."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal

import psutil
from pebble import ProcessFuture, ProcessPool

from drivora_service.execution.worker import WorkerFiles, be_ready, set_up, work
from drivora_service.runs.progress import ProgressBoard
from drivora_service.runs.report import RunReport, RunSpec

_TAIL_BYTES = 16_384
_TAIL_LINES = 40
_LOG_BYTES = 4 << 20


class Child:
    """A worker process and its successors.

    A pool of one process: it replaces the process after a number of runs by itself. After a death
    the whole pool is replaced, so that nothing which the dead process held can matter.

    Attributes:
        board: What the process shows of its progress.
        pid: Its process id, ``None`` until it is known.
        restarts: Processes there have been, beyond the first.
    """

    def __init__(
        self, *, perform: str, warm_up: str, setup: object, files: WorkerFiles, runs_per_worker: int
    ) -> None:
        """Prepares; :meth:`replace` starts the first process."""
        self._initial = (perform, warm_up, setup, files)
        self._files = files
        self._runs_per_worker = runs_per_worker
        self._process: psutil.Process | None = None
        self.pid: int | None = None
        self.restarts = 0
        files.log.write_bytes(b"")
        self.board = ProgressBoard(files.board)
        self._pool: ProcessPool | None = None

    def begin(self, spec: RunSpec) -> ProcessFuture[RunReport]:
        """Gives the process a run; the last one has ended.

        Raises:
            RuntimeError: There is no process, or it died.
        """
        if self._pool is None:
            raise RuntimeError("no worker process could be started")
        if self.log_size() > _LOG_BYTES:
            os.truncate(self._files.log, 0)
        return self._pool.schedule(work, args=(spec,))

    def identify(self) -> None:
        """Looks up which process has taken the run; called once it has."""
        try:
            pid = int(self._files.pid.read_text())
        except (FileNotFoundError, ValueError):
            return
        if self.pid == pid:
            return
        if self.pid is not None:
            self.restarts += 1
        self.pid = pid
        self._process = None
        with contextlib.suppress(psutil.NoSuchProcess):
            self._process = psutil.Process(pid)

    def memory_bytes(self) -> int:
        """Resident memory of the process, 0 if there is none."""
        try:
            return 0 if self._process is None else int(self._process.memory_info().rss)
        except psutil.NoSuchProcess:
            return 0

    def log_size(self) -> int:
        """Bytes in the log; where the log of the next run will begin."""
        return self._files.log.stat().st_size if self._files.log.exists() else 0

    def log_tail(self, begin: int) -> str:
        """Gives the last lines that were printed after ``begin``."""
        if not self._files.log.exists():
            return ""
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
        if self._pool is not None:
            self.restarts += 1
        self.end()
        self._files.board.parent.mkdir(parents=True, exist_ok=True)
        # Mapped anew, so that both sides see the same file even if somebody has removed the old.
        self.board = ProgressBoard(self._files.board)
        self.board.cells[:] = 0
        self._pool = self._start()

    def end(self) -> None:
        """Ends the process with all that it started."""
        self.identify()
        if self.pid is not None:
            # The group may outlive the process that leads it.
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self.pid, signal.SIGKILL)
        if self._pool is not None:
            self._pool.stop()  # type: ignore[no-untyped-call] # pebble leaves it untyped
            self._pool.join()
            self._pool = None
        self._process = self.pid = None
        self._files.pid.unlink(missing_ok=True)

    def _start(self) -> ProcessPool:
        pool = ProcessPool(
            max_workers=1,
            max_tasks=self._runs_per_worker,
            initializer=set_up,
            initargs=self._initial,
            context=multiprocessing.get_context("spawn"),
        )
        # The pool starts its process with its first task.
        pool.schedule(be_ready)
        return pool
