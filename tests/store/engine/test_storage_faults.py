"""What is said of databases and data folders that cannot be used."""

from __future__ import annotations

import contextlib
import errno
import os
import sqlite3
import subprocess
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import text

from drivora_service.errors import NothingStored, StoreError, StoreUnavailable
from drivora_service.store.command_database import CommandDatabase
from drivora_service.store.database import open_database
from drivora_service.store.engine.storage_faults import explain_sqlite_error, make_folder_error
from drivora_service.store.locks.server_lock import ServerLock

ADVICE = "choose another data folder with --data-dir or DRIVORA_DATA_DIR"
_WITHOUT_TEXTS_OF_SQLALCHEMY = ("sqlalche.me", "[SQL:", "Background on this error")


def refused(file: Path, kind: type[StoreError] = StoreError) -> str:
    """Returns the message with which a database is refused."""
    with pytest.raises(kind) as raised:
        open_database(f"sqlite:///{file}")
    message = str(raised.value)
    assert not any(one in message for one in _WITHOUT_TEXTS_OF_SQLALCHEMY)
    assert str(file.parent) in message
    assert ADVICE in message
    return message


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Path of a database that does not exist yet."""
    return tmp_path / "drivora.sqlite3"


@pytest.fixture
def small_volume(tmp_path: Path) -> Iterator[Path]:
    """A folder on a volume of 256 KiB."""
    folder = tmp_path / "volume"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=256k", "none", str(folder)]
    try:
        mounted = subprocess.run(command, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        mounted = False
    if not mounted:
        pytest.skip("this user cannot mount a small volume")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_text_in_place_of_a_database(file: Path) -> None:
    file.write_text("This is no database, but a text that is long enough to be looked at.")
    assert "is no SQLite database; restore it: stop the service, move" in refused(file)


def test_a_folder_in_place_of_a_database(file: Path) -> None:
    file.mkdir()
    assert "is a folder, not a database" in refused(file, StoreUnavailable)


@pytest.mark.parametrize(
    ("statements", "sign"),
    [
        (["CREATE TABLE places (id INTEGER)"], "it has the table 'places'"),
        (
            [
                "CREATE TABLE alembic_version (version_num TEXT)",
                "INSERT INTO alembic_version VALUES ('1f3a9c')",
            ],
            "its schema is '1f3a9c'",
        ),
    ],
)
def test_the_database_of_another_program_is_left_as_it_is(
    file: Path, statements: list[str], sign: str
) -> None:
    with closing(sqlite3.connect(file)) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()
    before = file.read_bytes()
    assert f"is the database of another program ({sign})" in refused(file)
    assert file.read_bytes() == before
    assert [one.name for one in file.parent.iterdir()] == [file.name]


def test_a_newer_schema_is_named_with_that_of_this_version(file: Path) -> None:
    database = open_database(f"sqlite:///{file}")
    with database.engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    database.close()
    message = refused(file)
    assert "has schema '9999', which this version does not know (its own is '" in message


def test_a_damaged_database(file: Path) -> None:
    open_database(f"sqlite:///{file}").close()
    content = bytearray(file.read_bytes())
    content[1024:] = b"x" * (len(content) - 1024)
    file.write_bytes(content)
    assert "is damaged; restore it: stop the service, move" in refused(file)


def test_a_full_volume(small_volume: Path) -> None:
    message = refused(small_volume / "drivora.sqlite3", StoreUnavailable)
    assert "is full; free space there" in message
    with contextlib.suppress(OSError):
        (small_volume / "rest").write_bytes(bytes(1 << 20))
    with pytest.raises(StoreError, match=r"cannot be written: No space left.*free space there"):
        ServerLock(small_volume)


def test_a_read_only_volume(small_volume: Path) -> None:
    subprocess.run(["mount", "-o", "remount,ro", str(small_volume)], check=True)
    message = refused(small_volume / "drivora.sqlite3", StoreUnavailable)
    assert f"{small_volume} cannot be written: Read-only file system" in message
    with pytest.raises(StoreError, match=r"cannot be written: Read-only file system; choose"):
        ServerLock(small_volume)


def test_a_folder_of_another_user_names_its_owner() -> None:
    error = PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    own = str(make_folder_error(Path(__file__).parent, error))
    assert own.endswith(f"cannot be used: Permission denied; {ADVICE}")
    other = next(
        (path for path in (Path("/root"), Path("/lost+found")) if _is_of_other(path)), None
    )
    if other is not None:
        assert "it belongs to the user " in str(make_folder_error(other, error))


def _is_of_other(path: Path) -> bool:
    return path.exists() and path.stat().st_uid != os.geteuid()


def test_an_error_without_an_explanation_has_none(file: Path) -> None:
    assert explain_sqlite_error(file, "SQLITE_BUSY") == ""


@pytest.mark.parametrize(
    ("made", "fault"),
    [
        (lambda _file: None, "there is no drivora.sqlite3"),
        (Path.touch, "drivora.sqlite3 is empty"),
        (Path.mkdir, "drivora.sqlite3 is a folder, not a database"),
    ],
)
def test_a_command_that_only_reads_says_why_there_is_nothing(
    file: Path, made: object, fault: str
) -> None:
    assert callable(made)
    made(file)
    database = CommandDatabase(file.parent, f"sqlite:///{file}", makes_data=False)
    with pytest.raises(NothingStored, match=fault):
        database()
