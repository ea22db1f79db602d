"""A slot: a thin supervisor, in a thread, of one worker process."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Protocol

import structlog

from drivora_service.execution.child import Child, NotReadyError
from drivora_service.execution.deaths import (
    report_breach,
    report_death,
    report_loss,
    signal_name,
)
from drivora_service.execution.executor import Limits
from drivora_service.execution.kept_worker import KeeperLostError, WorkerDiedError
from drivora_service.execution.starts import WorkerStarts
from drivora_service.execution.watch import Look, Watch
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import cancelled_report
from drivora_service.runs.report import RunReport, RunSpec, RunStatus
from drivora_service.runs.slot_state import SlotState
from drivora_service.simulation.phase import RunPhase
from drivora_service.worker.channel import ProtocolError
from drivora_service.worker.loop import WorkerTask

_POLL_S = 0.05
"""Seconds between two looks at a run: limits are kept to this, and a look costs some 50 us."""

_SAID_AGAIN_S = 60.0
"""Seconds between two lines of the log on faults of one slot."""

_log = structlog.get_logger(__name__)


class Source(Protocol):
    """Where a slot gets its runs."""

    def take(self) -> RunSpec | None:
        """Waits for the next run; ``None`` says that the slot shall end."""
        ...

    def put_back(self, spec: RunSpec) -> None:
        """Takes back a run that was not begun; it is the next one again."""
        ...

    def is_cancelled(self, run_id: str) -> bool:
        """Returns whether a run that was taken is to end."""
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
        log: Path,
        limits: Limits,
        starts: WorkerStarts,
        source: Source,
        sink: Callable[[AttemptEnd], None],
    ) -> None:
        """Starts the slot and its worker."""
        self.name = name
        self._limits, self._starts = limits, starts
        self._source, self._sink = source, sink
        task = WorkerTask(perform=perform, warm_up=warm_up, setup=setup)
        self._child = Child(task, log=log, limits=limits)
        self._run_id = ""
        self._runs = 0
        self._last_crash = ""
        self._unsent: AttemptEnd | None = None
        self._said_at = -_SAID_AGAIN_S
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, name=name, daemon=True)
        self._thread.start()

    def state(self) -> SlotState:
        """Returns what the slot does; never raises."""
        child = self._child
        progress, process = child.progress(), child.reading()
        return SlotState(
            name=self.name,
            pid=child.pid,
            run_id=self._run_id,
            phase=progress.phase.name.lower() if child.ready else "starting",
            step=progress.step,
            memory_bytes=0 if process is None else process.memory_bytes,
            runs=self._runs,
            restarts=max(child.restarts, 0),
            last_crash=self._last_crash,
            updated_at=datetime.now(UTC),
        )

    def stop(self) -> None:
        """Ends the slot with the run that it may have; does not wait for that."""
        self._closing.set()

    def join(self) -> None:
        """Waits for the end of the slot and of its worker; its source has ended."""
        self._thread.join()

    def _serve(self) -> None:
        """Serves until the source ends, whatever befalls the worker or the supervision."""
        child = self._child
        while True:
            try:
                self._serve_runs(child)
                break
            except Exception as error:
                self._say("slot_fault", error)
                with contextlib.suppress(Exception):
                    child.end()
                if self._closing.wait(self._starts.failed(self.name, repr(error), certain=False)):
                    break
        try:
            child.close()
        except Exception as error:
            self._say("worker_not_ended", error)

    def _say(self, event: str, error: Exception) -> None:
        """Writes a line of the log, unless the last one was written a short while ago."""
        now = time.monotonic()
        if now - self._said_at >= _SAID_AGAIN_S:
            self._said_at = now
            _log.error(event, slot=self.name, exc_info=error)

    def _serve_runs(self, child: Child) -> None:
        if self._unsent is not None:
            self._sink(self._unsent)
            self._unsent = None
        while not self._closing.is_set():
            if child.worn or not child.ready:
                self._start(child)
            spec = self._source.take()
            if spec is None:
                return
            if not child.is_idle:
                # It died while it had nothing to do, which is no run's fault.
                self._source.put_back(spec)
                child.end()
                continue
            self._unsent = self._attempt(child, spec)
            self._sink(self._unsent)
            self._unsent = None
            if child.ready and not child.worn:
                self._look_for_strangers(child, spec.run_id)

    def _look_for_strangers(self, child: Child, run_id: str) -> None:
        """Retires a worker in which a run has left processes behind: they end with it."""
        try:
            strangers = child.strangers()
        except KeeperLostError as error:
            self._last_crash = str(error)
            child.retire()
            return
        if strangers:
            child.log.note(f"run {run_id} left processes behind: {', '.join(strangers)}")
            child.retire()

    def _attempt(self, child: Child, spec: RunSpec) -> AttemptEnd:
        """Performs an attempt; always returns its end, so that no run is lost here."""
        self._run_id = spec.run_id
        started = datetime.now(UTC)
        exit_code = 0
        try:
            report, exit_code = self._perform(child, spec)
        except Exception as error:
            # The worker turns whatever a run raises into a report: this is the system.
            self._say("slot_fault", error)
            report = report_loss(spec.run_id, f"the worker process was lost: {error!r}", "")
            self._last_crash = f"the worker process was lost: {error!r}"
            with contextlib.suppress(Exception):
                child.end()
        if _leaves_a_mark(report, in_process=child.progress().in_process):
            child.retire()
        self._run_id = ""
        self._runs += 1
        return AttemptEnd(
            report=report,
            worker=self.name,
            started=started,
            ended=datetime.now(UTC),
            signal=signal_name(exit_code),
        )

    def _perform(self, child: Child, spec: RunSpec) -> tuple[RunReport, int]:
        """Has the worker do a run; returns the report and the exit code of a worker that died."""
        exit_code = 0
        try:
            child.begin(spec)
            return self._supervise(child, spec.run_id), 0
        except WorkerDiedError as death:
            exit_code = death.exit_code
            report = report_death(spec.run_id, exit_code, child.progress(), child.log.tail())
        except KeeperLostError as error:
            report = report_loss(spec.run_id, str(error), child.log.tail())
        except ProtocolError as error:
            report = report_breach(spec.run_id, str(error), child.progress(), child.log.tail())
        self._last_crash = "" if report.failure is None else report.failure.message
        child.end()
        return report, exit_code

    def _supervise(self, child: Child, run_id: str) -> RunReport:
        begun = time.monotonic()
        watch = Watch(self._limits, now=begun)
        while True:
            report = child.wait(run_id, _POLL_S)
            if report is not None:
                if child.progress().phase is RunPhase.IN_AGENT:
                    raise ProtocolError("a report that came while an agent was called")
                if not child.is_ready_again():
                    child.retire()
                return report
            if self._closing.is_set() or self._source.is_cancelled(run_id):
                child.end()
                return cancelled_report(run_id)
            now = time.monotonic()
            breach = watch.check(
                Look(
                    progress=child.progress(),
                    process=child.reading(),
                    family_memory=child.family_memory(),
                    now=now,
                )
            )
            if breach is not None:
                failure = replace(breach.failure, log=child.log.tail())
                child.end()
                return RunReport(
                    run_id=run_id,
                    status=breach.status,
                    wall_time_s=now - begun,
                    failure=failure,
                )
            child.log.cut()

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
                last = child.log.tail().rpartition("\n")[2]
                reason = f"{death} before it was ready: {last or 'its log is empty'}"
            except Exception as error:
                # The system is short of processes or memory, which passes; the slot must not.
                reason = f"the system starts no worker process: {type(error).__name__}: {error}"
            child.end()
            self._last_crash = reason
            self._closing.wait(self._starts.failed(self.name, reason, certain=certain))

    def _got_ready(self, child: Child) -> bool:
        until = time.monotonic() + self._limits.start_s
        while time.monotonic() < until and not self._closing.is_set():
            if child.wait_until_ready(_POLL_S):
                return True
        return False


def _leaves_a_mark(report: RunReport, *, in_process: bool) -> bool:
    """Returns whether a run may have left the worker in a state that no other run should find.

    Args:
        report: How the run ended.
        in_process: Whether agents were made in the worker process.
    """
    match report.status:
        case RunStatus.FINISHED:
            return False
        case RunStatus.INVALID | RunStatus.AGENT_FAILED:
            return in_process
        case _:
            return True
