"""A database for each test: one of SQLite, and an empty one of PostgreSQL."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from drivora_service.store.database import Database, open_database
from tests.postgresql_server import PostgresqlServer


@pytest.fixture(params=["sqlite", "postgresql"])
def database_url(request: pytest.FixtureRequest) -> Iterator[str]:
    """The address of a new database with the newest schema, of each kind."""
    if request.param == "sqlite":
        yield request.getfixturevalue("sqlite_url")
        return
    url: str = request.getfixturevalue("postgresql_url")
    yield url
    server: PostgresqlServer = request.getfixturevalue("postgresql")
    server.empty(url)


@pytest.fixture(scope="session")
def postgresql_url(postgresql: PostgresqlServer) -> str:
    """The address of a database of PostgreSQL that each test leaves empty."""
    return postgresql.create()


@pytest.fixture
def sqlite_url(tmp_path: Path, empty_database: Path) -> str:
    """The address of a new file."""
    (tmp_path / "data").mkdir(mode=0o700)
    return f"sqlite:///{shutil.copy(empty_database, tmp_path / 'data' / 'drivora.sqlite3')}"


@pytest.fixture
def database(database_url: str) -> Iterator[Database]:
    """A database of each kind."""
    opened = open_database(database_url)
    yield opened
    opened.close()


@pytest.fixture
def sqlite_database(sqlite_url: str) -> Iterator[Database]:
    """A database of SQLite, for tests of what only files have."""
    opened = open_database(sqlite_url)
    yield opened
    opened.close()
