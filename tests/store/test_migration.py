from __future__ import annotations

from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import text

from drivora_service.errors import StoreError
from drivora_service.store.database import Database, open_database
from drivora_service.store.migration import schema_version
from drivora_service.store.tables import Base


def test_the_migrated_schema_is_that_of_the_models(database: Database) -> None:
    with database.engine.connect() as connection:
        context = MigrationContext.configure(
            connection, opts={"compare_type": True, "compare_server_default": True}
        )
        assert compare_metadata(context, Base.metadata) == []


def test_partial_indices_are_migrated_with_their_conditions(database: Database) -> None:
    query = text("SELECT name FROM sqlite_master WHERE type = 'index' AND sql LIKE '%WHERE%'")
    with database.engine.connect() as connection:
        found = set(connection.scalars(query))
    wanted = {
        index.name
        for table in Base.metadata.tables.values()
        for index in table.indexes
        if index.dialect_options["sqlite"]["where"] is not None
    }
    assert found == wanted
    assert len(wanted) >= 4


def test_opening_again_changes_nothing(database: Database) -> None:
    version = schema_version(database.engine)
    again = open_database(str(database.engine.url))
    assert schema_version(again.engine) == version != ""
    again.close()


def test_a_newer_database_is_refused(database: Database) -> None:
    with database.engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(StoreError, match="'9999'"):
        open_database(str(database.engine.url))


@pytest.mark.parametrize("url", ["nonsense", "sqlite://", "sqlite:///:memory:"])
def test_addresses_that_cannot_work_are_refused(url: str) -> None:
    with pytest.raises(StoreError):
        open_database(url)


def test_a_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.sqlite3"
    path.write_bytes(b"this is not a database" * 100)
    with pytest.raises(StoreError, match="cannot be used"):
        open_database(f"sqlite:///{path}")


def test_the_database_is_safe_against_a_killed_process(database: Database) -> None:
    with database.engine.connect() as connection:
        pragmas = {
            name: connection.scalar(text(f"PRAGMA {name}"))
            for name in ("journal_mode", "synchronous", "foreign_keys", "busy_timeout")
        }
    assert pragmas == {
        "journal_mode": "wal",
        "synchronous": 2,
        "foreign_keys": 1,
        "busy_timeout": 30_000,
    }
