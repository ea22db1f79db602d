"""The service's own loop, with real workers, and with servers that are really killed."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, datetime
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, cast

import psutil
import pytest

from drivora_service.execution.dispatcher import Dispatcher
from drivora_service.execution.executor import Executor, Limits
from drivora_service.execution.infrastructure import Infrastructure, folder_probe
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.supervised import Backoff
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.runs.run_records import JobFilter, NewRun, Priority
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify
from tests.command_process import fork_server_address
from tests.execution.owners import server
from tests.execution.server import forked

TASKS = "tests.execution.worker_tasks:perform"
RUNS = 120


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    opened = open_database(f"sqlite:///{tmp_path / 'drivora.sqlite3'}")
    yield opened
    opened.close()


@contextlib.contextmanager
def serving(
    database: Database,
    tmp_path: Path,
    *,
    drain_s: float = 0.0,
    slots: int = 2,
    wrap: Callable[[LocalExecutor], Executor] = lambda executor: executor,
    on_fatal: Callable[[str], None] = print,
) -> Iterator[Dispatcher]:
    limits = Limits(agent_deadline_s=1.0, memory_bytes=600 << 20)
    folder = tmp_path / "workers"
    traces = TraceFolder(tmp_path / "traces")
    infrastructure = Infrastructure(
        {"database": database.probe, "traces": folder_probe(traces.root)}
    )
    with LocalExecutor(
        slots=slots, setup=None, folder=folder, limits=limits, perform=TASKS, warm_up=""
    ) as executor:
        dispatcher = Dispatcher(
            database,
            wrap(executor),
            traces,
            infrastructure,
            server(database, folder),
            on_fatal=on_fatal,
        )
        infrastructure.start(on_change=dispatcher.wake)
        dispatcher.start()
        try:
            yield dispatcher
        finally:
            dispatcher.stop(drain_s=drain_s)
            infrastructure.stop()


def submit(database: Database, *documents: str) -> tuple[str, ...]:
    with database.write() as transaction:
        batch = transaction.batches.create(name="batch", priority=Priority.CI)
        runs = [
            NewRun(document=text, scenario_sha256=text, town="town", agent="idm", label=text)
            for text in documents
        ]
        return transaction.jobs.submit(runs, batch_id=batch.id)


def statuses(database: Database) -> Counter[RunStatus]:
    with database.read() as transaction:
        return Counter(job.status for job in transaction.jobs.page(limit=1000).items)


def wait_until_over(database: Database, *, seconds: float = 60.0) -> None:
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        if all(status.is_final for status in statuses(database)):
            return
        time.sleep(0.05)
    raise AssertionError(f"not over after {seconds} s: {statuses(database)}")


def wait_until_running(database: Database, count: int) -> None:
    limit = time.monotonic() + 30
    while statuses(database)[RunStatus.RUNNING] < count:
        assert time.monotonic() < limit
        time.sleep(0.02)


def test_a_batch_with_bad_runs_is_judged_and_the_crash_quarantined(
    database: Database, tmp_path: Path
) -> None:
    documents = [f"sleep 0.0{number % 3}" for number in range(12)]
    documents[3], documents[7] = "segfault", "agent-hangs"
    with serving(database, tmp_path) as dispatcher:
        ids = submit(database, *documents)
        dispatcher.wake()
        wait_until_over(database)
        with database.read() as transaction:
            owners = transaction.workers.living_owners()
            (crash,) = transaction.quarantine.newest()
            attempts = transaction.jobs.attempts(ids[3])
        assert dispatcher.is_alive
    assert statuses(database) == {
        RunStatus.FINISHED: 10,
        RunStatus.SIMULATOR_CRASHED: 1,
        RunStatus.AGENT_FAILED: 1,
    }
    assert [slot.name for owner in owners for slot in owner.slots] == ["slot-0", "slot-1"]
    assert (crash.run_id, crash.signal) == (ids[3], "SIGSEGV")
    assert [attempt.signal for attempt in attempts] == ["SIGSEGV", "SIGSEGV"], attempts
    assert list(verify(database, TraceFolder(tmp_path / "traces"))) == []


def test_a_run_that_was_taken_away_and_comes_back_is_begun_anew(
    database: Database, tmp_path: Path
) -> None:
    with serving(database, tmp_path, slots=1) as dispatcher:
        submit(database, "sleep 0")
        dispatcher.wake()
        wait_until_over(database)
        # The worker is there now, and begins at once.
        (run_id,) = submit(database, "sleep 2")
        dispatcher.wake()
        wait_until_running(database, 1)
        time.sleep(0.5)
        with database.write() as transaction:
            (owner,) = transaction.workers.living_owners()
            # As another server does that takes this one for dead.
            assert transaction.queue.reclaim(owner.id, RetryPolicy()) == 1
        taken_away = datetime.now(UTC)
        dispatcher.wake()
        wait_until_over(database)
    with database.read() as transaction:
        first, second = transaction.jobs.attempts(run_id)
    assert (first.outcome, second.outcome) == ("interrupted", "finished")
    assert second.started_at is not None
    assert second.ended_at is not None
    assert second.started_at > taken_away
    assert (second.ended_at - second.started_at).total_seconds() > 1.9
    assert list(verify(database, TraceFolder(tmp_path / "traces"))) == []


def test_running_runs_are_cancelled(database: Database, tmp_path: Path) -> None:
    with serving(database, tmp_path) as dispatcher:
        (hanging, *_) = submit(database, "hangs", "sleep 0", "sleep 0")
        wait_until_running(database, 1)
        with database.write() as transaction:
            transaction.jobs.cancel(hanging)
        dispatcher.wake()
        wait_until_over(database)
    assert statuses(database) == {RunStatus.CANCELLED: 1, RunStatus.FINISHED: 2}


def test_a_server_that_stops_gives_its_runs_back(database: Database, tmp_path: Path) -> None:
    with serving(database, tmp_path):
        runs = submit(database, "sleep 1.5", "sleep 1.5", "sleep 0", "sleep 0", "sleep 0")
        wait_until_running(database, 4)
    assert statuses(database) == {RunStatus.QUEUED: 5}
    with serving(database, tmp_path):
        wait_until_over(database)
    assert statuses(database) == {RunStatus.FINISHED: 5}
    with database.read() as transaction:
        outcomes = [attempt.outcome for attempt in transaction.jobs.attempts(runs[0])]
    assert outcomes == ["released", "finished"]


def test_draining_lets_runs_end(database: Database, tmp_path: Path) -> None:
    executors: list[LocalExecutor] = []

    def kept(executor: LocalExecutor) -> LocalExecutor:
        executors.append(executor)
        return executor

    def begun() -> int:
        return sum(slot.phase == "simulating" for slot in executors[0].slots())

    with serving(database, tmp_path, drain_s=30.0, wrap=kept):
        submit(database, *["sleep 0.3"] * 6)
        wait_until_running(database, 4)
        # Claimed runs have begun once they have reached a worker, whose start takes a while.
        wait_for(lambda: statuses(database)[RunStatus.FINISHED] + begun() >= 2)
    counts = statuses(database)
    assert counts[RunStatus.FINISHED] >= 2
    assert counts[RunStatus.RUNNING] == 0


def start_server(data_dir: Path) -> subprocess.Popen[str]:
    root = Path(__file__).resolve().parents[2]
    server = subprocess.Popen(
        [sys.executable, "-m", "tests.execution.server", str(data_dir)],
        cwd=root,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert server.stdout is not None
    assert any(line == "serving\n" for line in server.stdout)
    return server


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
def test_no_worker_outlives_its_server(
    database: Database, tmp_path: Path, how: signal.Signals
) -> None:
    submit(database, "agent-hangs-in-c", "hangs")
    server = start_server(tmp_path)
    wait_until_running(database, 2)
    time.sleep(1.0)
    children = psutil.Process(server.pid).children(recursive=True)
    assert len(children) >= 2
    os.kill(server.pid, how)
    server.communicate(timeout=30)
    _, left = psutil.wait_procs(children, timeout=10)
    assert left == []


def forked_server(data_dir: Path) -> BaseProcess:
    """Starts a server from the fork server of the tests, which its workers come from, too."""
    heard, told = multiprocessing.Pipe()
    process = multiprocessing.get_context("forkserver").Process(
        target=forked, args=(data_dir, fork_server_address(), told)
    )
    process.start()
    told.close()
    assert heard.recv() == "serving"
    heard.close()
    return process


@pytest.mark.slow
def test_nothing_is_lost_or_counted_twice_when_the_server_is_killed(
    database: Database, tmp_path: Path
) -> None:
    runs = submit(database, *(f"sleep {0.03 + 0.0001 * number}" for number in range(RUNS)))
    luck = random.Random(7)
    interrupted = 0
    for _ in range(3):
        server = forked_server(tmp_path)
        wait_until_running(database, 1)
        time.sleep(luck.uniform(0.0, 1.5))
        server.kill()
        server.join(10)
        interrupted += statuses(database)[RunStatus.RUNNING]
    server = forked_server(tmp_path)
    server.join(120)
    assert server.exitcode == 0
    assert statuses(database) == {RunStatus.FINISHED: RUNS}
    with database.read() as transaction:
        reports = transaction.jobs.reports(runs)
        outcomes = [[attempt.outcome for attempt in transaction.jobs.attempts(run)] for run in runs]
        done = transaction.jobs.page(JobFilter(statuses=frozenset({RunStatus.FINISHED})), limit=999)
    assert set(reports) == set(runs)
    assert len(done.items) == RUNS
    assert all(outcome[-1] == "finished" for outcome in outcomes)
    assert all(set(outcome[:-1]) <= {"interrupted"} for outcome in outcomes)
    assert sum(len(outcome) - 1 for outcome in outcomes) == interrupted > 0
    assert list(verify(database, TraceFolder(tmp_path / "traces"))) == []


def outcomes(database: Database, runs: Iterable[str]) -> Counter[str]:
    with database.read() as transaction:
        return Counter(a.outcome for run in runs for a in transaction.jobs.attempts(run))


def wait_for(condition: Callable[[], bool], *, seconds: float = 60.0) -> None:
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit
        time.sleep(0.02)


def test_a_file_in_the_way_of_the_traces_pauses_the_queue_and_costs_no_run(
    database: Database, tmp_path: Path
) -> None:
    folder = tmp_path / "traces"
    folder.write_text("in the way")
    with serving(database, tmp_path) as dispatcher:
        runs = submit(database, *["sleep 0"] * 10)
        time.sleep(2.0)
        assert dispatcher.is_alive
        assert statuses(database) == {RunStatus.QUEUED: 10}
        folder.unlink()
        wait_until_over(database)
    assert statuses(database) == {RunStatus.FINISHED: 10}
    assert set(outcomes(database, runs)) <= {"finished", "released"}


def test_a_run_whose_trace_cannot_be_written_goes_back_unharmed_if_the_storage_is_at_fault(
    database: Database, tmp_path: Path
) -> None:
    folder = tmp_path / "traces"
    with serving(database, tmp_path) as dispatcher:
        runs = submit(database, *["writes-trace 0.3"] * 4)
        wait_until_running(database, 4)
        # At once, also while a file is written into it.
        folder.rename(tmp_path / "aside")
        folder.write_text("in the way")
        wait_for(lambda: statuses(database)[RunStatus.QUEUED] == 4)
        assert dispatcher.is_alive
        folder.unlink()
        wait_until_over(database)
    assert statuses(database) == {RunStatus.FINISHED: 4}
    assert outcomes(database, runs)["infrastructure_failed"] == 0
    assert outcomes(database, runs)["released"] >= 2


def test_a_run_whose_trace_cannot_be_written_to_a_storage_that_is_well_fails_after_three(
    database: Database, tmp_path: Path
) -> None:
    (one, *_) = runs = submit(database, "sleep 0", "sleep 0")
    (tmp_path / "traces").mkdir()
    in_the_way = TraceFolder(tmp_path / "traces").path(one).parent
    in_the_way.write_text("in the way")
    with serving(database, tmp_path):
        wait_until_over(database)
    with database.read() as transaction:
        reports = transaction.jobs.reports(runs)
    report = reports[one]
    assert report.status is RunStatus.INFRASTRUCTURE_FAILED
    assert report.failure is not None
    assert report.failure.cause == "trace_not_written"
    assert outcomes(database, [one]) == {"infrastructure_failed": 3}


def test_a_fault_of_a_second_that_no_probe_finds_takes_no_run(
    database: Database, tmp_path: Path
) -> None:
    runs = submit(database, *["writes-trace 0"] * 3)
    (tmp_path / "traces").mkdir()
    # Two runs may share a folder.
    in_the_way = {TraceFolder(tmp_path / "traces").path(run).parent for run in runs}
    for place in in_the_way:
        place.write_text("in the way")
    with serving(database, tmp_path):
        wait_for(lambda: outcomes(database, runs)["infrastructure_failed"] >= 2)
        # Three attempts of each at once would be over by then.
        time.sleep(1.0)
        for place in in_the_way:
            place.unlink()
        wait_until_over(database)
    assert statuses(database) == {RunStatus.FINISHED: 3}


def test_a_locked_database_loses_no_end(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'drivora.sqlite3'}"
    database = open_database(url, patience_s=0.2)
    with serving(database, tmp_path) as dispatcher:
        runs = submit(database, *["sleep 0.3"] * 6)
        wait_until_running(database, 4)
        other = sqlite3.connect(tmp_path / "drivora.sqlite3")
        other.execute("BEGIN IMMEDIATE")
        time.sleep(3.0)
        assert statuses(database)[RunStatus.FINISHED] == 0
        assert dispatcher.is_alive
        other.rollback()
        other.close()
        wait_until_over(database)
    assert statuses(database) == {RunStatus.FINISHED: 6}
    assert set(outcomes(database, runs)) <= {"finished", "released"}
    database.close()


class Faulty:
    """An executor with chosen methods that fail sometimes or always."""

    def __init__(self, inner: LocalExecutor, name: str, *, times: int) -> None:
        self._inner, self._name, self._times = inner, name, times

    def __getattribute__(self, name: str) -> Any:
        if name.startswith("_"):
            return object.__getattribute__(self, name)
        if name == self._name and self._times > 0:
            self._times -= 1
            raise RuntimeError(f"{name} failed")
        return getattr(self._inner, name)


@pytest.mark.parametrize("name", ["submit", "wait", "slots", "cancel", "fault", "withdraw"])
def test_runs_continue_after_any_exception_of_the_executor(
    database: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr(Backoff, "pause_s", lambda *_: 0.1)

    def wrap(executor: LocalExecutor) -> Executor:
        return cast("Executor", Faulty(executor, name, times=3))

    with serving(database, tmp_path, wrap=wrap) as dispatcher:
        hanging, *_ = submit(database, "hangs", *["sleep 0"] * 4)
        wait_for(lambda: statuses(database)[RunStatus.FINISHED] == 4)
        with database.write() as transaction:
            transaction.jobs.cancel(hanging)
        wait_until_over(database)
        assert dispatcher.is_alive
    assert statuses(database) == {RunStatus.FINISHED: 4, RunStatus.CANCELLED: 1}


def test_a_dispatcher_that_always_fails_gives_up_and_hands_its_runs_back(
    database: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Backoff, "pause_s", lambda *_: 0.01)
    told: list[str] = []

    def wrap(executor: LocalExecutor) -> Executor:
        return cast("Executor", Faulty(executor, "submit", times=10_000))

    with serving(database, tmp_path, wrap=wrap, on_fatal=told.append) as dispatcher:
        submit(database, *["sleep 0"] * 3)
        wait_for(lambda: not dispatcher.is_alive)
        assert "thread" in dispatcher.fault
    assert "'dispatcher' failed 10 times in a row" in told[0]
    assert statuses(database) == {RunStatus.QUEUED: 3}
