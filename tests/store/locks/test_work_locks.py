"""Locks on long work, on both databases: one holder, and none after its death."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from sqlalchemy import text

from drivora_service.errors import Conflict
from drivora_service.store.database import Database, open_database
from drivora_service.store.locks.work_locks import LongWork, WorkKind

CAMPAIGN = LongWork(WorkKind.CAMPAIGN, "01a2")
OTHER = LongWork(WorkKind.CAMPAIGN, "01a3")
STUDY = LongWork(WorkKind.STUDY, "01a2")
COMMAND = LongWork.command("01a2")
_LONGEST_S = 10.0

_HOLDING = """
import sys, time
from sqlalchemy import create_engine
from drivora_service.store.database import Database
from drivora_service.store.locks.work_locks import LongWork, WorkKind
held = Database(create_engine(sys.argv[1])).locks.hold(LongWork(WorkKind(sys.argv[2]), sys.argv[3]))
print("held", flush=True)
time.sleep(3600)
"""


@contextmanager
def holding_process(url: str, work: LongWork) -> Iterator[subprocess.Popen[bytes]]:
    """Lets another process hold a lock; kills it in the end."""
    with subprocess.Popen(
        [sys.executable, "-c", _HOLDING, url, work.kind, work.id], stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"held\n"
        try:
            yield process
        finally:
            process.kill()


def wait_until(is_so: Callable[[], bool]) -> None:
    """Waits for what must come soon."""
    until = time.monotonic() + _LONGEST_S
    while not is_so():
        assert time.monotonic() < until
        time.sleep(0.02)


@pytest.fixture
def other(database_url: str) -> Iterator[Database]:
    """The same database, as another process has it."""
    opened = open_database(database_url)
    yield opened
    opened.close()


@pytest.fixture
def _of_connections(database: Database) -> None:
    if database.engine.dialect.name == "sqlite":
        pytest.skip("a file's lock is lost with its process only")


of_connections = pytest.mark.usefixtures("_of_connections")


def test_work_has_one_holder(database: Database, other: Database) -> None:
    assert not other.locks.is_held(CAMPAIGN)
    held = database.locks.hold(CAMPAIGN)
    assert other.locks.is_held(CAMPAIGN)
    assert database.locks.is_held(CAMPAIGN)
    for locks in (database.locks, other.locks):
        with pytest.raises(Conflict, match=rf"process {os.getpid()}.* is running campaign 01a2"):
            locks.hold(CAMPAIGN)
    held.release()
    assert not other.locks.is_held(CAMPAIGN)
    other.locks.hold(CAMPAIGN).release()


def test_other_work_is_not_held(database: Database, other: Database) -> None:
    held = database.locks.hold(CAMPAIGN)
    for work in (OTHER, STUDY):
        assert not other.locks.is_held(work)
        other.locks.hold(work).release()
    assert other.locks.is_any_held(WorkKind.CAMPAIGN)
    assert not other.locks.is_any_held(WorkKind.STUDY)
    assert not other.locks.is_any_held(WorkKind.SERVER)
    held.release()
    assert not other.locks.is_any_held(WorkKind.CAMPAIGN)


def test_the_lock_of_a_killed_process_is_free_at_once(
    database: Database, database_url: str
) -> None:
    with holding_process(database_url, CAMPAIGN) as process:
        with pytest.raises(Conflict, match=rf"process {process.pid}"):
            database.locks.hold(CAMPAIGN)
        os.kill(process.pid, signal.SIGKILL)
        wait_until(lambda: not database.locks.is_held(CAMPAIGN))
    database.locks.hold(CAMPAIGN).release()


def test_a_closed_database_holds_nothing(database: Database, database_url: str) -> None:
    closed = open_database(database_url)
    held = closed.locks.hold(CAMPAIGN)
    if database.engine.dialect.name == "sqlite":
        held.release()
    closed.close()
    wait_until(lambda: not database.locks.is_held(CAMPAIGN))


def test_locks_that_were_lost_with_their_connection_are_taken_again(
    database: Database, other: Database
) -> None:
    held = database.locks.hold(CAMPAIGN)
    also = database.locks.hold(STUDY)
    lose_connections(other)
    database.locks.keep()
    assert other.locks.is_held(CAMPAIGN)
    assert other.locks.is_held(STUDY)
    held.release()
    assert not other.locks.is_held(CAMPAIGN)
    also.release()


@of_connections
def test_a_lost_lock_that_another_has_taken_stays_with_it(
    database: Database, other: Database
) -> None:
    lost = database.locks.hold(CAMPAIGN)
    lose_connections(other)
    taken = other.locks.hold(CAMPAIGN)
    database.locks.keep()
    lost.release()
    assert database.locks.is_held(CAMPAIGN)
    taken.release()
    assert not database.locks.is_held(CAMPAIGN)


@of_connections
def test_a_lost_lock_is_tried_again_until_it_is_free(database: Database, other: Database) -> None:
    """As when the server still has the session of a connection that has ended on this side."""
    held, also = database.locks.hold(CAMPAIGN), database.locks.hold(STUDY)
    lose_connections(other)
    taken = other.locks.hold(CAMPAIGN)
    for _ in range(2):
        database.locks.keep()
    assert other.locks.is_held(STUDY)
    taken.release()
    assert not other.locks.is_held(CAMPAIGN)
    database.locks.keep()
    assert other.locks.is_held(CAMPAIGN)
    # Held once, however often it was tried.
    database.locks.keep()
    held.release()
    assert not other.locks.is_held(CAMPAIGN)
    also.release()


@of_connections
def test_a_lost_lock_that_is_released_is_not_taken_again(
    database: Database, other: Database
) -> None:
    lost, also = database.locks.hold(CAMPAIGN), database.locks.hold(STUDY)
    lose_connections(other)
    taken = other.locks.hold(CAMPAIGN)
    database.locks.keep()
    lost.release()
    taken.release()
    database.locks.keep()
    assert not other.locks.is_held(CAMPAIGN)
    also.release()


def test_holders_are_named_by_kind(database: Database, other: Database) -> None:
    held, also = database.locks.hold(CAMPAIGN), other.locks.hold(OTHER)
    (holder,) = other.locks.holders(WorkKind.CAMPAIGN)
    assert holder.startswith(f"process {os.getpid()}")
    assert other.locks.holders(WorkKind.STUDY) == ()
    held.release()
    also.release()


def test_a_command_leaves_no_file(sqlite_database: Database, tmp_path: Path) -> None:
    locks = sqlite_database.locks
    held = locks.hold(COMMAND)
    assert locks.is_held(COMMAND)
    assert len(lock_files(tmp_path)) == 1
    held.release()
    assert not locks.is_held(COMMAND)
    assert lock_files(tmp_path) == []
    with holding_process(str(sqlite_database.engine.url), COMMAND) as process:
        process.kill()
        process.wait()
    assert len(lock_files(tmp_path)) == 1
    assert locks.holders(WorkKind.COMMAND) == ()
    locks.forget(COMMAND)
    assert lock_files(tmp_path) == []


def lock_files(folder: Path) -> list[Path]:
    """The lock files of commands."""
    return list(folder.rglob("command-*.lock"))


def lose_connections(database: Database) -> None:
    """Has PostgreSQL end all other connections, as its restart does."""
    if database.engine.dialect.name == "sqlite":
        return
    with database.engine.connect() as connection:
        connection.execute(
            text(
                "SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity "
                "WHERE pid != pg_backend_pid() AND datname = current_database()"
            )
        )
