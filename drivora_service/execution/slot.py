"""A slot: the supervisor, in a thread, of one worker process."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
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
from drivora_service.execution.sent_report import SentReport
from drivora_service.execution.watch import Sample, Watch
from drivora_service.execution.worker_log import WorkerLog
from drivora_service.execution.worker_starts import WorkerStarts
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import cancelled_report
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.runs.slot_state import SlotState
from drivora_service.worker.channel import ProtocolError
from drivora_service.worker.loop import WorkerTask
from drivora_service.worker.progress_board import NO_PROGRESS

_POLL_S = 0.2
"""Seconds between two checks of a run: the resolution of its limits. A check wakes the process that
owns the slots, which costs it 0.1 ms or more."""

_LOG_AGAIN_S = 60.0
"""Seconds between two log lines about faults of one slot."""

_log = structlog.get_logger(__name__)


Sink = Callable[[str, Callable[[], AttemptEnd]], None]
"""Takes the id of a run of which an attempt has ended, and a function that returns that end. It
never raises, and may be called from another thread."""


class Source(Protocol):
    """The source of a slot's runs."""

    def take(self) -> RunSpec | None:
        """Waits for the next run; ``None`` ends the slot."""
        ...

    def put_back(self, spec: RunSpec) -> None:
        """Puts a run that was not started back to the front of the queue."""
        ...

    def is_cancelled(self, run_id: str) -> bool:
        """Returns whether a run that was taken was cancelled."""
        ...


class Slot:
    """Takes runs from a source, one after another, and reports the end of each attempt.

    It takes a run only while its worker is ready, so that no run is lost to failed starts.
    """

    def __init__(
        self,
        name: str,
        *,
        task: WorkerTask,
        log: Path,
        limits: Limits,
        starts: WorkerStarts,
        source: Source,
        sink: Sink,
    ) -> None:
        """Starts the thread of the slot, which starts its worker.

        Args:
            name: Name of the slot, in reports and logs.
            task: Task of its workers.
            log: Path of its workers' log.
            limits: Limits of a worker.
            starts: Counts failed starts, those of all slots together.
            source: Has the runs.
            sink: Receives the ends of attempts.
        """
        self.name = name
        self._limits, self._starts = limits, starts
        self._source, self._sink = source, sink
        self._child = Child(task, log=log, limits=limits)
        # For state(), which any thread calls, without a lock: each value is whole, though two of
        # them may be of different moments. The slot's thread writes them; the last crash is also
        # written by the thread that reads a report.
        self._run_id = ""
        self._runs = 0
        self._last_crash = ""
        self._last_crash_at: datetime | None = None
        self._since = datetime.now(UTC)
        # The end of an attempt until the sink has it, so that a fault in between does not lose it.
        self._unsent: tuple[str, Callable[[], AttemptEnd]] | None = None
        self._logged_at = -_LOG_AGAIN_S
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, name=name, daemon=True)
        self._thread.start()

    def state(self) -> SlotState:
        """Returns what the slot does; never raises."""
        child = self._child
        # While a worker starts or ends, only one of the two may be set. What is read after them
        # belongs to a worker that is known.
        ready, pid = child.ready, child.pid
        progress, process = child.progress(), child.reading()
        return SlotState(
            name=self.name,
            pid=pid,
            run_id=self._run_id,
            phase=progress.phase.name.lower() if ready and pid is not None else "starting",
            step=progress.step,
            memory_bytes=0 if process is None else process.memory_bytes,
            runs=self._runs,
            restarts=max(child.restarts, 0),
            last_crash=self._last_crash,
            updated_at=datetime.now(UTC),
            since=self._since,
            last_crash_at=self._last_crash_at,
        )

    @property
    def log(self) -> WorkerLog:
        """Output of its workers."""
        return self._child.log

    def stop(self) -> None:
        """Ends the slot and its run, if it has one; does not wait for the end."""
        self._closing.set()

    def join(self) -> None:
        """Waits for the end of the slot and of its worker; its source has ended."""
        self._thread.join()

    def _serve(self) -> None:
        """Serves until the source ends, through faults of the worker and of the supervision."""
        child = self._child
        while True:
            try:
                self._serve_runs(child)
                break
            except Exception as error:
                self._log_fault("slot_fault", error)
                with contextlib.suppress(Exception):
                    child.end()
                # Counts as a failed start: the pauses grow, and if all slots have such a fault, the
                # executor reports it and runs go back to the queue.
                if self._closing.wait(
                    self._starts.note_failure(self.name, repr(error), certain=False)
                ):
                    break
        try:
            child.close()
        except Exception as error:
            self._log_fault("worker_not_ended", error)

    def _note_crash(self, message: str) -> None:
        self._last_crash, self._last_crash_at = message, datetime.now(UTC)

    def _log_fault(self, event: str, error: Exception) -> None:
        """Writes a log line, unless the last one is more recent than ``_LOG_AGAIN_S``."""
        now = time.monotonic()
        if now - self._logged_at >= _LOG_AGAIN_S:
            self._logged_at = now
            _log.error(event, slot=self.name, exc_info=error)

    def _serve_runs(self, child: Child) -> None:
        if self._unsent is not None:
            self._sink(*self._unsent)
            self._unsent = None
        while not self._closing.is_set():
            # The worker before the run: a start that fails has no run to blame (decision 20).
            if child.needs_replacement or not child.ready:
                self._start(child)
            # May wait for hours, hence the second look at the worker below.
            spec = self._source.take()
            if spec is None:
                return
            if child.needs_replacement or not child.is_idle:
                # It died while it was idle, which is not attributed to a run, or what it sent
                # before turned out to be no report.
                self._source.put_back(spec)
                child.end()
                continue
            self._unsent = (spec.run_id, self._attempt(child, spec))
            self._sink(*self._unsent)
            self._unsent = None
            # After the end was handed over, which need not wait for an answer of the keeper.
            if child.ready and not child.needs_replacement:
                self._check_leftovers(child, spec.run_id)

    def _check_leftovers(self, child: Child, run_id: str) -> None:
        """Retires a worker in which a run has left processes; they end with the worker."""
        try:
            leftovers = child.leftovers()
        except KeeperLostError as error:
            self._note_crash(str(error))
            child.retire()
            return
        if leftovers:
            child.log.note(f"run {run_id} left processes behind: {', '.join(leftovers)}")
            child.retire()

    def _attempt(self, child: Child, spec: RunSpec) -> Callable[[], AttemptEnd]:
        """Performs an attempt; returns its end in every case, so that no run is lost."""
        self._run_id = spec.run_id
        self._since = started = datetime.now(UTC)
        outcome: RunReport | SentReport
        exit_code = 0
        try:
            outcome, exit_code = self._perform(child, spec)
        except Exception as error:
            # The worker reports all that a run raises; this is a fault of the system.
            outcome = self._handle_loss(spec.run_id, error)
            with contextlib.suppress(Exception):
                child.end()
        if isinstance(outcome, RunReport) and _may_affect_next_run(outcome, child):
            child.retire()
        self._run_id = ""
        self._since = ended = datetime.now(UTC)
        self._runs += 1
        end = partial(
            AttemptEnd,
            worker=self.name,
            started=started,
            ended=ended,
            signal=signal_name(exit_code),
        )
        # An end that is known already, or one whose report the caller of this function reads: many
        # reports in a row cost less, and the slot begins its next run meanwhile (decision 51).
        if isinstance(outcome, RunReport):
            known = end(report=outcome, candidate=child.candidate)
            return lambda: known
        return partial(self._read, outcome, child.worker, child, end)

    def _read(
        self, sent: SentReport, worker: object, child: Child, end: Callable[..., AttemptEnd]
    ) -> AttemptEnd:
        """Reads a report that was sent as one of a finished run, in the thread that wants it.

        Returns:
            The end of the attempt, also if what was sent is no report: that is a breach.
        """
        try:
            report, candidate = sent.read()
            return end(report=report, candidate=candidate)
        except ProtocolError as error:
            report = report_breach(sent.spec.run_id, str(error), NO_PROGRESS, "")
        except Exception as error:
            report = report_loss(sent.spec.run_id, f"the report cannot be read: {error!r}", "")
        # The slot's thread may have replaced the worker since; its successor is not to blame.
        child.retire(worker)
        self._note_crash("" if report.failure is None else report.failure.message)
        return end(report=report, candidate=None)

    def _handle_loss(self, run_id: str, error: Exception) -> RunReport:
        """Returns the report of a run that was lost to a fault of this package or the system."""
        self._log_fault("slot_fault", error)
        message = f"the worker process was lost: {error!r}"
        self._note_crash(message)
        return report_loss(run_id, message, "")

    def _perform(self, child: Child, spec: RunSpec) -> tuple[RunReport | SentReport, int]:
        """Hands a run to the worker; returns its report and exit code, 0 while the worker lives."""
        exit_code = 0
        try:
            child.begin(spec)
            outcome = self._supervise(child, spec.run_id)
            # Any other status than finished decides whether the worker may go on: it is read now.
            if isinstance(outcome, RunReport) or outcome.says_finished:
                return outcome, 0
            report, child.candidate = outcome.read()
            return report, 0
        except WorkerDiedError as death:
            # Here and below, progress is read before end(), which closes the board.
            exit_code = death.exit_code
            report = report_death(spec.run_id, exit_code, child.progress(), child.log.tail())
        except KeeperLostError as error:
            report = report_loss(spec.run_id, str(error), child.log.tail())
        except ProtocolError as error:
            report = report_breach(spec.run_id, str(error), child.progress(), child.log.tail())
        self._note_crash("" if report.failure is None else report.failure.message)
        child.end()
        return report, exit_code

    def _supervise(self, child: Child, run_id: str) -> RunReport | SentReport:
        begun = time.monotonic()
        watch = Watch(self._limits, now=begun)
        while True:
            # The report first: a run that has ended is neither cancelled nor beyond a limit.
            sent = child.wait(_POLL_S)
            if sent is not None:
                if child.is_in_agent:
                    # A worker shows that it is idle before it sends its report (worker/loop.py), so
                    # code under test has sent this one.
                    # Names what is wrong with the message, if there is more.
                    sent.read()
                    raise ProtocolError("a report that came while an agent was called")
                # A second report would be taken for that of the next run.
                if not child.is_ready_again():
                    child.retire()
                return sent
            # Before the limits, so that a cancelled run ends as cancelled.
            if self._closing.is_set() or self._source.is_cancelled(run_id):
                child.end()
                return cancelled_report(run_id)
            now = time.monotonic()
            breach = watch.check(
                Sample(
                    progress=child.progress(),
                    process=child.reading(),
                    descendant_memory=child.descendant_memory(),
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

    def _start(self, child: Child) -> None:
        """Starts workers until one is ready or the slot ends."""
        self._since = datetime.now(UTC)
        while not self._closing.is_set():
            certain = False
            try:
                child.replace()
                if self._got_ready(child):
                    self._starts.note_success(self.name)
                    self._since = datetime.now(UTC)
                    return
                if self._closing.is_set():
                    return
                reason = f"no worker process was ready within {self._limits.start_s:g} s"
            except NotReadyError as error:
                # The worker's own reason counts at once. The other failures often pass, and count
                # after several in a row (worker_starts.py).
                reason, certain = str(error), True
            except WorkerDiedError as death:
                last = child.log.tail().rpartition("\n")[2]
                reason = f"{death} before it was ready: {last or 'its log is empty'}"
            except Exception as error:
                # The system is short of processes or memory, which passes; the slot must survive.
                reason = f"the system starts no worker process: {type(error).__name__}: {error}"
            child.end()
            self._note_crash(reason)
            self._closing.wait(self._starts.note_failure(self.name, reason, certain=certain))

    def _got_ready(self, child: Child) -> bool:
        until = time.monotonic() + self._limits.start_s
        # In short waits, so that a slot can be stopped while its worker starts.
        while time.monotonic() < until and not self._closing.is_set():
            if child.wait_until_ready(_POLL_S):
                return True
        return False


def _may_affect_next_run(report: RunReport, child: Child) -> bool:
    """Returns whether a run may have changed the worker's state for later runs."""
    match report.status:
        case RunStatus.FINISHED:
            # What its agents changed in the process was looked for before it finished
            # (worker/integrity.py).
            return False
        case RunStatus.INVALID | RunStatus.AGENT_FAILED:
            # No agent was made in the worker process otherwise.
            return child.progress().in_process
        case _:
            return True
