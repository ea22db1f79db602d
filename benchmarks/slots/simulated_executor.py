"""An executor whose slots only wait as long as a run takes, and answer with a real report.

It shows what the rest of the service costs with more slots than the machine has cores. A slot
starts its next run at the exact time at which the last one ended, however late the service asks.
"""

from __future__ import annotations

import heapq
import random
import threading
import time
from collections import deque
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

from benchmarks.slots.sleeping_worker import make_seed_candidate
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import cancelled_report
from drivora_service.runs.report_encoding import report_to_message
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.runs.slot_state import SlotState
from drivora_service.worker.channel import Frame, Kind
from drivora_service.worker.worker_messages import report_of

_SPREAD = 0.2
"""Largest relative difference of a run's duration from the mean."""


@dataclass(frozen=True, slots=True, order=True)
class _Running:
    """A run on a slot, from ``begun`` to ``until`` in seconds of a monotonic clock."""

    until: float
    slot: int
    begun: float
    spec: RunSpec = field(compare=False)


class SimulatedExecutor:
    """K slots that wait; see ``execution.executor.Executor``. Thread-safe.

    Attributes:
        own_s: Processor time of the simulation itself, which is not the service's. The reading of
            reports is not part of it, as the supervisor of a real slot reads them, too.
    """

    def __init__(self, *, slots: int, run_s: float, report: RunReport, seed: int = 0) -> None:
        """Begins with idle slots.

        Args:
            slots: Number of slots.
            run_s: Mean seconds of a run.
            report: Answer of each slot, apart from the run's id.
            seed: Of the durations.
        """
        self._changed = threading.Condition()
        self._run_s, self._random = run_s, random.Random(seed)
        self._report, self._placeholder = report_to_message(report), report.run_id.encode()
        self._waiting: deque[RunSpec] = deque()
        self._idle = list(range(slots))
        self._running: list[_Running] = []
        self._ended: list[_Running] = []
        self._cancelled: list[str] = []
        self._runs = [0] * slots
        self._woken = False
        self._began = datetime.now(UTC) - timedelta(seconds=time.monotonic())
        self.own_s = 0.0

    @property
    def capacity(self) -> int:
        """Number of slots."""
        return len(self._runs)

    @property
    def fault(self) -> str:
        """The reason that no run can be started; there is none."""
        return ""

    def submit(self, spec: RunSpec) -> None:
        """Queues an attempt, which starts when a slot is free; first in, first out."""
        begun = time.thread_time()
        with self._changed:
            self._advance()
            self._waiting.append(spec)
            self._advance()
        self.own_s += time.thread_time() - begun

    def cancel(self, run_id: str) -> None:
        """Ends an attempt."""
        with self._changed:
            self._advance()
            found = [one for one in self._running if one.spec.run_id == run_id]
            if found:
                self._running.remove(found[0])
                heapq.heapify(self._running)
                self._idle.append(found[0].slot)
            elif waiting := [spec for spec in self._waiting if spec.run_id == run_id]:
                self._waiting.remove(waiting[0])
            else:
                return
            self._cancelled.append(run_id)
            self._changed.notify_all()

    def withdraw(self) -> tuple[str, ...]:
        """Removes every spec that was not started; returns the ids of their runs."""
        with self._changed:
            self._advance()
            run_ids = tuple(spec.run_id for spec in self._waiting)
            self._waiting.clear()
        return run_ids

    def wait(self, timeout: float | None = None, *, count: int = 1) -> tuple[AttemptEnd, ...]:
        """Returns the attempts that have ended since the last call; waits for ``count`` of them."""
        until = None if timeout is None else time.monotonic() + timeout
        begun, waited = time.thread_time(), 0.0
        with self._changed:
            while True:
                self._advance()
                enough = len(self._ended) + len(self._cancelled) >= count
                left = None if until is None else until - time.monotonic()
                if enough or self._woken or (left is not None and left <= 0.0):
                    break
                next_end = self._end_of(count - len(self._ended) - len(self._cancelled))
                pauses = [one for one in (left, next_end) if one is not None]
                self._changed.wait(max(0.0, min(pauses)) if pauses else None)
            self._woken = False
            ended, self._ended = self._ended, []
            cancelled, self._cancelled = self._cancelled, []
        now = datetime.now(UTC)
        waited = time.thread_time()
        ends = [self._end(one) for one in ended]
        self.own_s += waited - begun
        return (
            *ends,
            *(
                AttemptEnd(report=cancelled_report(one), worker="", started=now, ended=now)
                for one in cancelled
            ),
        )

    def wake(self) -> None:
        """Makes the current or next :meth:`wait` return at once."""
        with self._changed:
            self._woken = True
            self._changed.notify_all()

    def slots(self) -> tuple[SlotState, ...]:
        """Returns the state of each slot."""
        now = datetime.now(UTC)
        with self._changed:
            self._advance()
            run_ids = {one.slot: one.spec.run_id for one in self._running}
        return tuple(
            SlotState(
                name=f"slot-{slot}",
                pid=None,
                run_id=run_ids.get(slot, ""),
                phase="simulating" if slot in run_ids else "idle",
                step=0,
                memory_bytes=0,
                runs=runs,
                restarts=0,
                last_crash="",
                updated_at=now,
            )
            for slot, runs in enumerate(self._runs)
        )

    def close(self) -> None:
        """Ends every attempt."""
        with self._changed:
            self._waiting.clear()
            self._running.clear()

    def _advance(self) -> None:
        """Ends and starts runs as the slots would have done up to now."""
        now = time.monotonic()
        while self._running and self._running[0].until <= now:
            over = heapq.heappop(self._running)
            self._ended.append(over)
            self._runs[over.slot] += 1
            if self._waiting:
                self._start(over.slot, over.until)
            else:
                self._idle.append(over.slot)
        while self._waiting and self._idle:
            self._start(self._idle.pop(), now)

    def _start(self, slot: int, begun: float) -> None:
        duration = self._run_s * (1.0 + _SPREAD * (2.0 * self._random.random() - 1.0))
        spec = self._waiting.popleft()
        heapq.heappush(
            self._running, _Running(until=begun + duration, slot=slot, begun=begun, spec=spec)
        )

    def _end_of(self, number: int) -> float | None:
        """Returns the seconds until ``number`` running runs have ended; ``None`` if none runs."""
        if not self._running:
            return None
        last = heapq.nsmallest(number, self._running)[-1] if number > 1 else self._running[0]
        return last.until - time.monotonic()

    def _end(self, one: _Running) -> AttemptEnd:
        run_id = one.spec.run_id
        body = self._report.replace(self._placeholder, run_id.encode())
        source = one.spec.candidate
        return AttemptEnd(
            report=report_of(Frame(Kind.REPORT, body), run_id),
            candidate=None if source is None else make_seed_candidate(source),
            worker=f"slot-{one.slot}",
            started=self._began + timedelta(seconds=one.begun),
            ended=self._began + timedelta(seconds=one.until),
        )
