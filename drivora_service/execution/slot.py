"""A slot: a thin supervisor, in a thread, of one worker process."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from typing import Protocol

from drivora_service.execution.child import Child, NotReadyError, WorkerDiedError
from drivora_service.execution.deaths import report_death, report_loss, signal_name
from drivora_service.execution.executor import Limits
from drivora_service.execution.starts import WorkerStarts
from drivora_service.execution.watch import Watch
from drivora_service.execution.worker import WorkerFiles
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import cancelled_report
from drivora_service.runs.report import RunReport, RunSpec
from drivora_service.runs.slot_state import SlotState

_POLL_S = 0.05
"""Seconds between two looks at a run: limits are kept to this, and a look costs some 50 us."""


class Source(Protocol):
    """Where a slot gets its runs."""

    def take(self) -> RunSpec | None:
        """Waits for the next run; ``None`` says that the slot shall end."""
        ...

    def put_back(self, spec: RunSpec) -> None:
        """Takes back a run that was not begun; it is the next one again."""
        ...


class Slot:
    """Takes runs from a source, one after another, and says how each attempt ended.

    It takes one only while its worker is ready, so that a worker which cannot start costs no run.
    """

    def __init__(
        self,
        name: str,
        *,
        perform: str,
        warm_up: str,
        setup: object,
        files: WorkerFiles,
        limits: Limits,
        starts: WorkerStarts,
        source: Source,
        sink: Callable[[AttemptEnd], None],
    ) -> None:
        """Starts the slot and its worker."""
        self.name = name
        self._perform, self._warm_up = perform, warm_up
        self._setup, self._files = setup, files
        self._limits, self._starts = limits, starts
        self._source, self._sink = source, sink
        self._child: Child | None = None
        self._run_id = ""
        self._runs = 0
        self._last_crash = ""
        self._closing = threading.Event()
        self._stop_run = threading.Event()
        self._thread = threading.Thread(target=self._serve, name=name, daemon=True)
        self._thread.start()

    def cancel(self, run_id: str) -> None:
        """Ends the run if it is this slot's."""
        if self._run_id == run_id:
            self._stop_run.set()

    def state(self) -> SlotState:
        """Tells what the slot does."""
        child = self._child
        progress = None if child is None else child.board.read()
        return SlotState(
            name=self.name,
            pid=None if child is None else child.pid,
            run_id=self._run_id,
            phase="starting" if progress is None else progress.phase.name.lower(),
            step=0 if progress is None else progress.step,
            memory_bytes=0 if child is None else child.memory_bytes(),
            runs=self._runs,
            restarts=0 if child is None else child.restarts,
            last_crash=self._last_crash,
            updated_at=datetime.now(UTC),
        )

    def stop(self) -> None:
        """Ends the slot with the run that it may have; does not wait for that."""
        self._closing.set()
        self._stop_run.set()

    def join(self) -> None:
        """Waits for the end of the slot and of its worker; its source has ended."""
        self._thread.join()

    def _serve(self) -> None:
        self._child = child = Child(
            perform=self._perform,
            warm_up=self._warm_up,
            setup=self._setup,
            files=self._files,
            runs_per_worker=self._limits.runs_per_worker,
        )
        try:
            self._start(child)
            while (spec := self._source.take()) is not None:
                if child.lives:
                    self._sink(self._attempt(child, spec))
                else:
                    # It died while it had nothing to do, which is no run's fault.
                    self._source.put_back(spec)
                    child.end()
                if child.worn or not child.ready:
                    self._start(child)
        finally:
            child.end()

    def _attempt(self, child: Child, spec: RunSpec) -> AttemptEnd:
        self._run_id = spec.run_id
        started = datetime.now(UTC)
        log_begin = child.log_size()
        exit_code = 0
        try:
            child.begin(spec)
            report = self._supervise(child, spec.run_id, log_begin)
        except WorkerDiedError as death:
            exit_code = death.exit_code
            log = child.log_tail(log_begin)
            report = report_death(spec.run_id, exit_code, child.board.read(), log)
            self._bury(child, report)
        except Exception as error:
            # The worker turns whatever a run raises into a report: this is the system.
            report = report_loss(spec.run_id, f"the worker process was lost: {error!r}", "")
            self._bury(child, report)
        self._run_id = ""
        self._stop_run.clear()
        self._runs += 1
        return AttemptEnd(
            report=report,
            worker=self.name,
            started=started,
            ended=datetime.now(UTC),
            signal=signal_name(exit_code),
        )

    def _supervise(self, child: Child, run_id: str, log_begin: int) -> RunReport:
        begun = time.monotonic()
        watch = Watch(self._limits, now=begun)
        while True:
            report = child.wait(_POLL_S)
            if report is not None:
                return report
            now = time.monotonic()
            if self._stop_run.is_set():
                child.end()
                return cancelled_report(run_id)
            breach = watch.check(child.board.read(), child.memory_bytes(), now=now)
            if breach is not None:
                failure = replace(breach.failure, log=child.log_tail(log_begin))
                child.end()
                return RunReport(
                    run_id=run_id,
                    status=breach.status,
                    wall_time_s=now - begun,
                    failure=failure,
                )

    def _bury(self, child: Child, report: RunReport) -> None:
        if report.failure is not None:
            self._last_crash = report.failure.message
        child.end()

    def _start(self, child: Child) -> None:
        """Starts a worker, as often as it takes until one is ready or the slot ends."""
        while not self._closing.is_set():
            certain = False
            try:
                child.replace()
                if self._got_ready(child):
                    self._starts.succeeded(self.name)
                    return
                if self._closing.is_set():
                    return
                reason = f"no worker process was ready within {self._limits.start_s:g} s"
            except NotReadyError as error:
                reason, certain = str(error), True
            except WorkerDiedError as death:
                last = child.log_tail(0).rpartition("\n")[2]
                reason = f"{death} before it was ready: {last or 'its log is empty'}"
            except Exception as error:
                # The system is short of processes or memory, which passes; the slot must not.
                reason = f"the system starts no worker process: {error!r}"
            child.end()
            self._last_crash = reason
            self._closing.wait(self._starts.failed(self.name, reason, certain=certain))

    def _got_ready(self, child: Child) -> bool:
        until = time.monotonic() + self._limits.start_s
        while time.monotonic() < until and not self._closing.is_set():
            if child.wait_until_ready(_POLL_S):
                return True
        return False
