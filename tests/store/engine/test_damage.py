"""Files whose bytes were overwritten, and how long that is remembered."""

from __future__ import annotations

import contextlib
import os
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy import event, text

from drivora_service.errors import StoreDamaged, StoreUnavailable
from drivora_service.store.database import Database, open_database
from drivora_service.store.engine import integrity_check
from drivora_service.store.engine.damage_latch import DamageLatch
from drivora_service.store.engine.integrity_check import IntegrityCheck
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify
from tests.damaged_files import overwrite_bytes, overwrite_page
from tests.store.samples import only_sqlite, submit

RESTORE = "`cp BACKUP/drivora.sqlite3 "


@pytest.fixture
def file(sqlite_url: str) -> Path:
    """A database with some hundred runs, closed."""
    database = open_database(sqlite_url)
    submit(database, 300)
    assert database.file is not None
    database.close()
    return database.file


def header(file: Path) -> None:
    overwrite_bytes(file, 0, 100)


def table(file: Path) -> None:
    overwrite_page(file, "runs")


def index(file: Path) -> None:
    overwrite_page(file, "ix_runs_queued")


def schema(file: Path) -> None:
    overwrite_bytes(file, 100, 3000)


def end(file: Path) -> None:
    os.truncate(file, file.stat().st_size // 2)


DAMAGES: tuple[Callable[[Path], None], ...] = (header, table, index, schema, end)


@pytest.mark.parametrize("damage", DAMAGES)
def test_each_damage_is_found_before_the_start(file: Path, damage: Callable[[Path], None]) -> None:
    assert IntegrityCheck(file).run(60.0)
    damage(file)
    before = file.read_bytes()
    with pytest.raises(StoreDamaged, match="restore it: stop the service") as raised:
        IntegrityCheck(file).run(60.0)
    assert f"{RESTORE}{file}" in str(raised.value)
    assert "\n" not in str(raised.value)
    assert file.read_bytes() == before


def test_a_damaged_log_never_passes_for_a_damaged_file(sqlite_url: str, tmp_path: Path) -> None:
    """SQLite has checksums for it, and leaves out what they do not fit."""
    database = open_database(sqlite_url)
    submit(database, 3)
    assert database.file is not None
    copy = tmp_path / "copy.sqlite3"
    shutil.copyfile(database.file, copy)
    log = Path(shutil.copyfile(f"{database.file}-wal", f"{copy}-wal"))
    database.close()
    overwrite_bytes(log, 32, log.stat().st_size - 32)
    assert IntegrityCheck(copy).run(60.0)
    again = open_database(f"sqlite:///{copy}")
    with again.read() as transaction:
        assert transaction.session.scalar(text("SELECT count(*) FROM runs")) == 0
    again.close()


def test_a_check_ends_in_time_and_goes_on_where_it_ended(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(integrity_check, "_LOOK_S", 0.001)
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.execute("CREATE TABLE ballast (body)")
        connection.execute(
            "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 200000) "
            "INSERT INTO ballast SELECT i FROM n"
        )
        connection.commit()
    check = IntegrityCheck(file)
    # A check that was interrupted before it knew the tables has everything left.
    assert check.unchecked
    assert not check.run(0.0)
    left = check.unchecked
    assert "ballast" in left
    assert check.run()
    assert check.unchecked == ()
    check.stop()


def test_a_damage_found_by_a_reader_refuses_writers_until_a_restart(
    sqlite_database: Database,
) -> None:
    database = sqlite_database
    told: list[str] = []
    submit(database, 300)
    file = database.file
    assert file is not None
    database.damage.listen(told.append)
    database.checkpoint()
    database.engine.dispose()
    before = file.read_bytes()
    overwrite_page(file, "runs")
    with pytest.raises(StoreDamaged, match=RESTORE), database.read() as transaction:
        transaction.session.execute(text("SELECT * FROM runs")).all()
    file.write_bytes(before)
    database.engine.dispose()
    for write in (database.probe, lambda: submit(database, 1)):
        with pytest.raises(StoreDamaged, match=RESTORE):
            write()
    with database.read() as transaction:
        assert transaction.session.scalar(text("SELECT count(*) FROM runs")) == 300
    assert told == [database.damage.found]


@only_sqlite
def test_bytes_that_are_no_text_are_a_damage(database: Database) -> None:
    submit(database, 1)
    statement = "UPDATE batches SET name = CAST(x'ff' AS TEXT)"
    with database.engine.begin() as connection:
        connection.execute(text(statement))
    with pytest.raises(StoreDamaged, match=RESTORE), database.read() as transaction:
        transaction.session.execute(text("SELECT name FROM batches")).all()


@pytest.mark.parametrize("damage", [table, index])
def test_a_verification_reports_the_damage_alone(
    file: Path, damage: Callable[[Path], None]
) -> None:
    damage(file)
    database = open_database(f"sqlite:///{file}")
    findings = tuple(verify(database, TraceFolder(file.parent / "traces")))
    database.close()
    assert {finding.kind for finding in findings} == {"damaged_database"}
    assert f"{RESTORE}{file}" in findings[-1].message


def test_the_first_damage_counts() -> None:
    latch = DamageLatch()
    told: list[str] = []
    latch.refuse()
    latch.note("one page")
    latch.note("another page")
    latch.listen(told.append)
    assert (latch.found, told) == ("one page", ["one page"])
    with pytest.raises(StoreDamaged, match="one page"):
        latch.refuse()


def _count_runs(file: Path) -> int:
    with contextlib.closing(sqlite3.connect(f"file:{file}?mode=ro", uri=True)) as connection:
        (count,) = connection.execute("SELECT count(*) FROM runs").fetchone()
        return int(count)


def test_nothing_is_stored_while_the_file_is_away(sqlite_database: Database) -> None:
    database = sqlite_database
    submit(database, 3)
    file = database.file
    assert file is not None
    away = file.with_suffix(".away")
    file.rename(away)
    for write in (database.probe, lambda: submit(database, 1)):
        with pytest.raises(StoreUnavailable, match="moved or removed while it is used"):
            write()
    assert not file.exists()
    away.rename(file)
    database.probe()
    submit(database, 1)
    assert _count_runs(file) == 4


def test_another_file_in_its_place_is_a_damage_until_a_restart(sqlite_database: Database) -> None:
    database = sqlite_database
    submit(database, 3)
    file = database.file
    assert file is not None
    database.checkpoint()
    away = file.with_suffix(".away")
    file.rename(away)
    shutil.copy(away, file)
    with pytest.raises(StoreDamaged, match="replaced by another file"):
        submit(database, 1)
    file.unlink()
    away.rename(file)
    with pytest.raises(StoreDamaged, match="replaced by another file"):
        database.probe()
    assert _count_runs(file) == 3


def test_a_database_without_a_log_has_lost_none(sqlite_database: Database) -> None:
    def do_without(connection: sqlite3.Connection, _record: object) -> None:
        connection.execute("PRAGMA journal_mode = DELETE")

    # As SQLite does by itself on a file system without shared memory.
    event.listen(sqlite_database.engine, "connect", do_without)
    sqlite_database.engine.dispose()
    submit(sqlite_database, 1)
    file = sqlite_database.file
    assert file is not None
    assert not file.with_name(f"{file.name}-wal").exists()
    sqlite_database.probe()
    submit(sqlite_database, 1)


def test_a_log_that_is_removed_while_it_is_used_is_a_damage(sqlite_database: Database) -> None:
    database = sqlite_database
    submit(database, 3)
    file = database.file
    assert file is not None
    file.with_name(f"{file.name}-wal").unlink()
    with pytest.raises(StoreDamaged, match="-wal was removed while it is used"):
        database.probe()
    with pytest.raises(StoreDamaged, match="-wal was removed"):
        submit(database, 1)
    # As the message says: closing still moves the changes into the file.
    database.close()
    assert _count_runs(file) == 3
