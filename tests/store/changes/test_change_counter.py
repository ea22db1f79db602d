from __future__ import annotations

import sqlite3
from pathlib import Path

from sqlalchemy import create_engine, text

from drivora_service.store.changes.change_counter import ChangeCounter
from drivora_service.store.database import Database, open_database


def write(database: Database) -> None:
    with database.write() as transaction:
        transaction.session.execute(text("UPDATE alembic_version SET version_num = version_num"))


def test_it_changes_with_every_commit_and_only_then(tmp_path: Path) -> None:
    file = tmp_path / "odd name?#%20" / "store.sqlite3"
    database, other = open_database(f"sqlite:///{file}"), open_database(f"sqlite:///{file}")
    try:
        seen = [database.changes.value()]
        for writer in (database, other, database):
            write(writer)
            seen.append(database.changes.value())
            with database.read() as transaction:
                transaction.queue.has_work()
            assert database.changes.value() == seen[-1]
        assert None not in seen
        assert len(set(seen)) == 4
    finally:
        database.close()
        other.close()


def test_a_write_that_is_not_over_does_not_count_and_is_not_waited_for(tmp_path: Path) -> None:
    file = tmp_path / "store.sqlite3"
    database = open_database(f"sqlite:///{file}")
    locker = sqlite3.connect(file, isolation_level=None)
    try:
        before = database.changes.value()
        locker.execute("BEGIN EXCLUSIVE")
        locker.execute("UPDATE alembic_version SET version_num = version_num")
        assert database.changes.value() == before
        locker.execute("COMMIT")
        assert database.changes.value() != before
    finally:
        locker.close()
        database.close()


def test_what_cannot_be_told_is_none(tmp_path: Path) -> None:
    no_file = ChangeCounter(create_engine(f"sqlite:///{tmp_path / 'gone' / 'store.sqlite3'}"))
    assert no_file.value() is None
    in_memory = ChangeCounter(create_engine("sqlite://"))
    assert in_memory.value() is None
    in_memory.close()
