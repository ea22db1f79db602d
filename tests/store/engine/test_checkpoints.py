"""What is in the file of a database without its write-ahead log."""

from __future__ import annotations

import contextlib
import shutil
import sqlite3
import time
from pathlib import Path

import pytest
from sqlalchemy import text

from drivora_service.store.database import Database, open_database
from drivora_service.store.migration import newest_revision
from tests.store.samples import submit

_DATA = Path(__file__).parents[1] / "data"


def runs_without_log(database: Database, tmp_path: Path) -> int:
    """Counts the runs in a copy of the file alone."""
    assert database.file is not None
    copy = shutil.copyfile(database.file, tmp_path / "alone.sqlite3")
    with contextlib.closing(sqlite3.connect(copy)) as connection:
        (count,) = connection.execute("SELECT count(*) FROM runs").fetchone()
    return int(count)


def with_checkpoints(database: Database, every_s: float) -> Database:
    return Database(database.engine, checkpoint_s=every_s)


def test_commits_reach_the_file_on_a_schedule(sqlite_database: Database, tmp_path: Path) -> None:
    seldom = with_checkpoints(sqlite_database, 1000.0)
    submit(seldom, 2)
    assert runs_without_log(seldom, tmp_path) == 0
    often = with_checkpoints(sqlite_database, 0.0)
    submit(often, 1)
    assert runs_without_log(often, tmp_path) == 3


def test_a_long_reader_holds_up_no_checkpoint_and_no_writer(
    sqlite_database: Database, tmp_path: Path
) -> None:
    """What it cannot see stays in the log until it has ended."""
    often = with_checkpoints(sqlite_database, 0.0)
    submit(often, 1)
    with often.read() as transaction:
        assert transaction.session.scalar(text("SELECT count(*) FROM runs")) == 1
        begun = time.monotonic()
        submit(often, 1)
        submit(often, 1)
        assert time.monotonic() - begun < 5.0
        assert runs_without_log(often, tmp_path) == 1
    submit(often, 1)
    assert runs_without_log(often, tmp_path) == 4


def test_a_failed_checkpoint_fails_no_write(
    sqlite_database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    often = with_checkpoints(sqlite_database, 0.0)
    engine = often.engine

    def refuse() -> None:
        raise sqlite3.OperationalError("disk I/O error")

    monkeypatch.setattr(engine, "raw_connection", refuse)
    (run,) = submit(often, 1)
    monkeypatch.undo()
    with often.read() as transaction:
        assert transaction.session.scalar(text("SELECT id FROM runs")) == run


def test_a_migration_is_in_the_file(tmp_path: Path) -> None:
    file = tmp_path / "old.sqlite3"
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.executescript((_DATA / "revision_0022.sql").read_text())
    database = open_database(f"sqlite:///{file}")
    copy = shutil.copyfile(file, tmp_path / "alone.sqlite3")
    with contextlib.closing(sqlite3.connect(copy)) as connection:
        found = connection.execute("SELECT version_num FROM alembic_version").fetchall()
    database.close()
    assert found == [(newest_revision(),)]
