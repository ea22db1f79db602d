"""The service's own processor time a run, with the dispatcher, the queue, the store, the slots."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from benchmarks.slots.spent import Spent, measure_spent
from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.executor import Executor
from drivora_service.execution.infrastructure import Infrastructure, folder_probe
from drivora_service.execution.ownership import Ownership
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.run_report import RunReport, RunSpec, RunStatus
from drivora_service.runs.slot_state import SlotState
from drivora_service.serving import settle_garbage_collector
from drivora_service.store.database import Database, open_database
from drivora_service.store.locks.command_locks import CommandLocks
from drivora_service.store.runs.run_records import NewRun, Priority
from drivora_service.store.traces.trace_folders import TraceFolder

_AT_ONCE = 500
_SHORTEST_REAL_RUN_S = 0.015
"""For which enough runs are queued: what a run takes depends on the machine."""
_PATIENCE_S = 120.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """One measurement.

    Attributes:
        slots: K.
        kind: ``real``, ``sleeping`` or ``simulated`` workers; ``cluster``: sleeping ones of the
            nodes of a Ray cluster.
        runs: Runs that ended in the measured time.
        seconds: The measured time.
        run_s: Mean seconds of a run, in the worker.
        own_ms: Processor time of the process that owns the slots a run, milliseconds.
        efficiency: Share of the slots' time in which a worker decoded genes or performed a run.
        driver_ms: Like ``own_ms``, of the process that is connected with a Ray cluster.
        nodes_ms: Of the actors of its nodes together.
        ray_ms: Of the other processes of Ray.
    """

    slots: int
    kind: str
    runs: int
    seconds: float
    run_s: float
    own_ms: float
    efficiency: float
    driver_ms: float = 0.0
    nodes_ms: float = 0.0
    ray_ms: float = 0.0

    @property
    def rate(self) -> float:
        """Runs a second."""
        return self.runs / self.seconds

    @property
    def own_share(self) -> float:
        """Share of one core that the process that owns the slots used."""
        return self.rate * self.own_ms / 1000.0

    @property
    def driver_share(self) -> float:
        """Share of one core that the process that is connected with a Ray cluster used."""
        return self.rate * self.driver_ms / 1000.0


class Seen(NamedTuple):
    """What is measured of the end of an attempt; the report is not kept, as a service keeps none.

    Attributes:
        worker: Name of the slot.
        ended: When it ended, UTC.
        took_s: Seconds from its start to its end.
        worked_s: Seconds of the run and, if it has genes, of making its scenario.
        bad: The report of a run that did not finish.
    """

    worker: str
    ended: datetime
    took_s: float
    worked_s: float
    bad: RunReport | None


class Recording:
    """An executor that notes the ends of another; see ``execution.executor.Executor``."""

    def __init__(self, executor: Executor) -> None:
        """Begins with none."""
        self._executor = executor
        self.ends: list[Seen] = []

    @property
    def capacity(self) -> int:
        """Number of slots."""
        return self._executor.capacity

    @property
    def fault(self) -> str:
        """The reason that no worker can be started, or ""."""
        return self._executor.fault

    @property
    def is_warm(self) -> bool:
        """Whether every slot has ended a run."""
        return len({end.worker for end in self.ends}) >= self.capacity

    def submit(self, spec: RunSpec) -> None:
        """Queues an attempt."""
        self._executor.submit(spec)

    def cancel(self, run_id: str) -> None:
        """Ends an attempt."""
        self._executor.cancel(run_id)

    def withdraw(self) -> tuple[str, ...]:
        """Removes every spec that was not started."""
        return self._executor.withdraw()

    def wait(self, timeout: float | None = None, *, count: int = 1) -> tuple[AttemptEnd, ...]:
        """Returns the attempts that have ended since the last call."""
        ends = self._executor.wait(timeout, count=count)
        self.ends += map(_make_seen, ends)
        return ends

    def wake(self) -> None:
        """Makes the current or next :meth:`wait` return at once."""
        self._executor.wake()

    def slots(self) -> tuple[SlotState, ...]:
        """Returns the state of each slot."""
        return self._executor.slots()

    def close(self) -> None:
        """Ends every attempt."""
        self._executor.close()


def measure(
    executor: Executor,
    documents: Sequence[str],
    folder: Path,
    *,
    kind: str,
    run_s: float,
    seconds: float,
    warm_s: float,
) -> Point:
    """Performs queued runs for some time, and measures after they have begun.

    Args:
        executor: Performs the runs; the caller closes it.
        documents: Scenarios of the runs, in turn.
        folder: For the database and the traces.
        kind: See :class:`Point`.
        run_s: Expected seconds of a run.
        seconds: Time to measure.
        warm_s: Time before, from when every slot has ended a run.
    """
    recording = Recording(executor)
    database = open_database(f"sqlite:///{folder / 'drivora.sqlite3'}")
    least_s = min(run_s, _SHORTEST_REAL_RUN_S) if kind == "real" else run_s
    count = round(1.5 * (seconds + warm_s + 1.0) * executor.capacity / least_s)
    _queue(database, documents, count, keeps_trace=kind == "real")
    settle_garbage_collector()
    with _run_dispatcher(database, recording, folder):
        _wait_until(lambda: recording.is_warm)
        time.sleep(warm_s)
        first, before = datetime.now(UTC), measure_spent(executor)
        time.sleep(seconds)
        # A busy machine takes longer for a run.
        _wait_until(lambda: any(end.ended >= first for end in recording.ends))
        used, last = measure_spent(executor).since(before), datetime.now(UTC)
        assert len(recording.ends) < count, f"all {count} queued runs ended too early"
        # Ends are handed over some times a second.
        time.sleep(1.0)
    database.close()
    return point_of(recording.ends, executor, kind=kind, between=(first, last), used=used)


def point_of(
    ends: Sequence[Seen],
    executor: Executor,
    *,
    kind: str,
    between: tuple[datetime, datetime],
    used: Spent,
) -> Point:
    """Returns the measurement.

    Args:
        ends: The ends of all attempts.
        executor: Performed them.
        kind: See :class:`Point`.
        between: The measured time.
        used: Processor time in it.
    """
    first, last = between
    passed = (last - first).total_seconds()
    ends = [end for end in ends if first <= end.ended < last]
    bad = [end.bad for end in ends if end.bad is not None]
    assert not bad, bad[0]
    # A simulated run has the duration of its attempt: nothing else is done in it.
    durations = [end.took_s if kind == "simulated" else end.worked_s for end in ends]
    return Point(
        slots=executor.capacity,
        kind=kind,
        runs=len(ends),
        seconds=passed,
        run_s=sum(durations) / len(durations),
        own_ms=1000.0 * used.own_s / len(ends),
        efficiency=sum(durations) / (executor.capacity * passed),
        driver_ms=1000.0 * used.driver_s / len(ends),
        nodes_ms=1000.0 * used.nodes_s / len(ends),
        ray_ms=1000.0 * used.ray_s / len(ends),
    )


def _wait_until(holds: Callable[[], bool]) -> None:
    until = time.monotonic() + _PATIENCE_S
    while not holds():
        assert time.monotonic() < until, f"too few runs ended within {_PATIENCE_S:g} s"
        time.sleep(0.1)


def _make_seen(end: AttemptEnd) -> Seen:
    report = end.report
    return Seen(
        worker=end.worker,
        ended=end.ended,
        took_s=(end.ended - end.started).total_seconds(),
        worked_s=report.wall_time_s + (0.0 if end.candidate is None else end.candidate.prepare_s),
        bad=None if report.status is RunStatus.FINISHED else report,
    )


def _queue(database: Database, documents: Sequence[str], count: int, *, keeps_trace: bool) -> None:
    with database.write() as transaction:
        batch_id = transaction.batches.create(name="slots", priority=Priority.CAMPAIGN).id
    hashes = [hashlib.sha256(document.encode()).hexdigest() for document in documents]
    for start in range(0, count, _AT_ONCE):
        runs = [
            NewRun(
                document=documents[number % len(documents)],
                scenario_sha256=hashes[number % len(documents)],
                town="tee-town",
                agent="idm",
                label=str(number),
                keeps_trace=keeps_trace,
            )
            for number in range(start, min(start + _AT_ONCE, count))
        ]
        with database.write() as transaction:
            transaction.jobs.submit(runs, batch_id=batch_id)


@contextmanager
def _run_dispatcher(database: Database, executor: Executor, folder: Path) -> Iterator[None]:
    traces = TraceFolder(folder / "traces")
    infrastructure = Infrastructure(
        {"database": database.probe, "traces": folder_probe(traces.root)}
    )
    owner = Ownership(database, RetryPolicy(), CommandLocks(folder), exclusive=True)
    dispatcher = Dispatcher(database, executor, traces, infrastructure, owner)
    infrastructure.start(on_change=dispatcher.wake)
    dispatcher.start()
    try:
        yield
    finally:
        dispatcher.stop()
        infrastructure.stop()
