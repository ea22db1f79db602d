from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from drivora_service.execution.ownership import HEARTBEAT_TIMEOUT_S, LOCK_TIMEOUT_S, Ownership
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.locks.command_locks import CommandLocks
from drivora_service.store.runs.run_records import NewRun, Priority
from drivora_service.store.runs.run_tables import OwnerRow
from tests.execution.owners import command, server
from tests.postgresql_server import PostgresqlServer
from tests.store.samples import new_run, no_trace

LOOK_S = 2.0
"""Seconds between two heartbeats."""


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    opened = open_database(f"sqlite:///{tmp_path / 'shared.sqlite3'}")
    yield opened
    opened.close()


def running(database: Database, owner_id: str) -> str:
    with database.write() as transaction:
        run = NewRun(document="{}", scenario_sha256="s", town="town", agent="idm", label="")
        (run_id,) = transaction.jobs.submit([run])
        transaction.queue.claim(owner_id, 1, trace_path=no_trace)
    return run_id


def status(database: Database, run_id: str) -> RunStatus:
    with database.read() as transaction:
        return transaction.jobs.get(run_id).status


def jump(database: Database, owner_id: str, by: timedelta) -> None:
    """Sets a heartbeat as the clock of its owner had it before that jumped."""
    with database.write() as transaction:
        owner = transaction.session.get_one(OwnerRow, owner_id)
        owner.heartbeat_at = datetime.now(UTC) - by


def test_a_clock_that_jumps_takes_no_lease_from_a_server_that_lives(
    database: Database, tmp_path: Path
) -> None:
    clock = [0.0]
    policy = RetryPolicy()
    other = Ownership(database, policy, CommandLocks(tmp_path))
    mine = Ownership(database, policy, CommandLocks(tmp_path), clock=lambda: clock[0])
    other.register()
    run_id = running(database, other.owner_id)
    jump(database, other.owner_id, timedelta(hours=1))
    mine.register()
    for _ in range(60):
        clock[0] += LOOK_S
        jump(database, other.owner_id, timedelta(hours=1))
        mine.beat(())
    assert status(database, run_id) is RunStatus.RUNNING

    # It holds its lock, so that it gets the longer time.
    assert silence(mine, clock, until=lambda: status(database, run_id) is RunStatus.QUEUED) == (
        pytest.approx(HEARTBEAT_TIMEOUT_S, abs=2 * LOOK_S)
    )
    # It was only slow: from its next heartbeat on it owns the runs that it claims.
    other.beat(())
    with database.read() as transaction:
        assert other.owner_id in transaction.workers.heartbeats(me=mine.owner_id)


def test_a_server_without_its_lock_is_dead_sooner(database: Database, tmp_path: Path) -> None:
    clock = [0.0]
    mine = Ownership(database, RetryPolicy(), CommandLocks(tmp_path), clock=lambda: clock[0])
    mine.register()
    with database.write() as transaction:
        gone = transaction.workers.register()
    run_id = running(database, gone)
    mine.beat(())
    assert silence(mine, clock, until=lambda: status(database, run_id) is RunStatus.QUEUED) == (
        pytest.approx(LOCK_TIMEOUT_S, abs=2 * LOOK_S)
    )


def test_nobody_is_dead_because_the_database_was_away(database: Database, tmp_path: Path) -> None:
    clock = [0.0]
    mine = Ownership(database, RetryPolicy(), CommandLocks(tmp_path), clock=lambda: clock[0])
    mine.register()
    with database.write() as transaction:
        other = transaction.workers.register()
    run_id = running(database, other)
    mine.beat(())
    # Neither has written a heartbeat meanwhile, and this one is the first that can again.
    clock[0] += 10 * HEARTBEAT_TIMEOUT_S
    mine.beat(())
    assert status(database, run_id) is RunStatus.RUNNING
    clock[0] += LOOK_S
    mine.beat(())
    assert status(database, run_id) is RunStatus.RUNNING


@pytest.mark.parametrize(
    ("is_locked", "limit_s"), [(True, HEARTBEAT_TIMEOUT_S), (False, LOCK_TIMEOUT_S)]
)
def test_a_command_with_another_data_folder_is_judged_by_its_lock_in_the_database(
    postgresql: PostgresqlServer, tmp_path: Path, *, is_locked: bool, limit_s: float
) -> None:
    url = postgresql.create()
    database, other = open_database(url), open_database(url)
    clock = [0.0]
    mine = Ownership(
        database, RetryPolicy(), CommandLocks(tmp_path / "mine"), clock=lambda: clock[0]
    )
    theirs = command(other, tmp_path / "theirs")
    mine.register()
    theirs.register()
    run_id = queued(database, theirs.owner_id)
    assert claimed(database, theirs) == (run_id,)
    if not is_locked:
        # As its death does.
        other.locks.close()
    mine.beat(())
    assert silence(
        mine, clock, until=lambda: status(database, run_id) is RunStatus.CANCELLED
    ) == pytest.approx(limit_s, abs=2 * LOOK_S)
    for opened in (database, other):
        opened.close()
    postgresql.drop(url)


def test_a_stopped_command_with_the_same_data_folder_is_alive(
    postgresql: PostgresqlServer, tmp_path: Path
) -> None:
    url = postgresql.create()
    database, other = open_database(url), open_database(url)
    clock = [0.0]
    mine = Ownership(database, RetryPolicy(), CommandLocks(tmp_path), clock=lambda: clock[0])
    theirs = command(other, tmp_path)
    mine.register()
    theirs.register()
    run_id = queued(database, theirs.owner_id)
    for _ in range(60):
        clock[0] += LOOK_S
        mine.beat(())
    assert status(database, run_id) is RunStatus.QUEUED
    theirs.leave(())
    for opened in (database, other):
        opened.close()
    postgresql.drop(url)


def test_the_only_server_of_a_file_leaves_a_command_with_another_folder(
    database: Database, tmp_path: Path
) -> None:
    theirs = command(database, tmp_path / "theirs")
    theirs.register()
    run_id = queued(database, theirs.owner_id)
    mine = server(database, tmp_path / "mine")
    mine.register()
    mine.beat(())
    assert status(database, run_id) is RunStatus.QUEUED
    theirs.leave(())
    assert not list(tmp_path.rglob("command-*.lock"))


def silence(mine: Ownership, clock: list[float], until: Callable[[], bool]) -> float:
    """Looks as a server does, until something is so; returns the seconds."""
    begun = clock[0]
    while not until():
        assert clock[0] - begun < 100 * LOOK_S
        clock[0] += LOOK_S
        mine.beat(())
    return clock[0] - begun


def queued(database: Database, owner_id: str) -> str:
    """Queues a run that is reserved for one process."""
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CI, owner_id=owner_id)
        return transaction.jobs.submit([new_run("{0}")], batch_id=batch.id)[0]


def claimed(database: Database, by: Ownership) -> tuple[str, ...]:
    with database.write() as transaction:
        specs = transaction.queue.claim(
            by.owner_id, 10, trace_path=no_trace, reserved_to=by.reserved_to
        )
    return tuple(spec.run_id for spec in specs)


def test_runs_of_a_command_are_for_the_command_alone(tmp_path: Path) -> None:
    database = open_database(f"sqlite:///{tmp_path / 'shared.sqlite3'}")
    mine, other = command(database, tmp_path), server(database, tmp_path)
    mine.register()
    other.register()
    own, any_server = queued(database, mine.owner_id), queued(database, "")
    assert claimed(database, other) == (any_server,)
    assert claimed(database, mine) == (own,)
    other.beat(())
    assert status(database, own) is RunStatus.RUNNING
    # It stops cleanly: its runs have no owner any more.
    mine.leave([own])
    assert status(database, own) is RunStatus.CANCELLED
    database.close()


def test_a_server_cancels_what_a_dead_command_left(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'shared.sqlite3'}"
    database = open_database(url)
    code = f"""
import os, pathlib
from drivora_service.store.database import open_database
from tests.execution.owners import command
from tests.execution.test_ownership import claimed, queued
database = open_database({url!r})
mine = command(database, pathlib.Path({str(tmp_path)!r}))
mine.register()
print(queued(database, mine.owner_id), *claimed(database, mine), flush=True)
print(queued(database, mine.owner_id), flush=True)
input()
"""
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    running_one = process.stdout.readline().split()
    waiting = process.stdout.readline().strip()
    assert running_one[0] == running_one[1]
    other = server(database, tmp_path)
    other.register()
    other.beat(())
    assert status(database, waiting) is RunStatus.QUEUED
    assert status(database, running_one[0]) is RunStatus.RUNNING
    process.kill()
    process.communicate()
    other.beat(())
    assert {status(database, run) for run in (waiting, running_one[0])} == {RunStatus.CANCELLED}
    assert not list((tmp_path / "commands").iterdir())
    assert not list((tmp_path / "locks").iterdir())
    database.close()
