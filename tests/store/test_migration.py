from __future__ import annotations

import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import psutil
import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import (
    Boolean,
    Engine,
    MetaData,
    RowMapping,
    String,
    Table,
    Text,
    create_engine,
    inspect,
    text,
)
from sqlalchemy.types import TypeEngine

from drivora_service.errors import StoreError
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.engine.base_tables import Base
from drivora_service.store.migration import (
    newest_revision,
    revisions,
    schema_version,
    upgrade,
)
from drivora_service.store.runs.run_records import JobFilter
from tests.postgresql_server import PostgresqlServer
from tests.store.samples import only_sqlite

DATA = Path(__file__).parent / "data"
UNUSED = ("alembic", "sqlalchemy.dialects.postgresql", "psycopg")
"""What a new database of SQLite needs not, and takes long to import."""


@pytest.fixture
def migrated(tmp_path: Path) -> Iterator[Engine]:
    """A database of SQLite that all migrations have made, one after another."""
    engine = create_engine(f"sqlite:///{tmp_path / 'migrated.sqlite3'}")
    upgrade(engine)
    yield engine
    engine.dispose()


def test_the_migrated_schema_is_that_of_the_models(migrated: Engine) -> None:
    assert differences(migrated, compare_type=True) == []


def test_the_schema_on_postgresql_is_that_of_the_models(postgresql: PostgresqlServer) -> None:
    url = postgresql.create(migrated=False)
    database = open_database(url)
    assert differences(database.engine, compare_type=_differs_on_postgresql) == []
    database.close()
    postgresql.drop(url)


def differences(engine: Engine, *, compare_type: object) -> list[Any]:
    """Changes that would make the schema of a database that of the models."""
    options = {"compare_type": compare_type, "compare_server_default": True}
    with engine.connect() as connection:
        context = MigrationContext.configure(connection, opts=options)
        return list(compare_metadata(context, Base.metadata))


def _differs_on_postgresql(
    _context: object, _column: object, _model: object, found: TypeEngine[Any], wanted: Any
) -> bool | None:
    """Compares types; ``None``: as usually."""
    if isinstance(wanted, String):
        return not (isinstance(found, Text) and found.collation == "C")
    return None


def schema(engine: Engine) -> dict[str, list[str]]:
    """Columns, keys, constraints and indices by table."""
    found = inspect(engine)
    described: dict[str, list[str]] = {}
    for table in found.get_table_names():
        parts: list[Any] = [
            *found.get_columns(table),
            *found.get_indexes(table),
            *found.get_foreign_keys(table),
            *found.get_unique_constraints(table),
            *found.get_check_constraints(table),
            found.get_pk_constraint(table),
        ]
        for part in parts:
            # A number as a default is the same in quotes.
            if isinstance(part.get("default"), str):
                part["default"] = part["default"].strip("'")
            options = part.get("dialect_options", {})
            part["dialect_options"] = {name: str(value) for name, value in options.items()}
        described[table] = sorted(map(repr, parts))
    return described


@only_sqlite
def test_a_new_database_has_the_schema_of_one_that_was_migrated(
    database: Database, migrated: Engine
) -> None:
    assert schema(database.engine) == schema(migrated)
    assert schema_version(database.engine) == schema_version(migrated) == newest_revision()
    assert len(schema(migrated)) > 10


def test_postgresql_has_the_conditions_of_partial_indices(postgresql: PostgresqlServer) -> None:
    url = postgresql.create()
    database = open_database(url)
    with database.read() as transaction:
        query = text("SELECT indexname FROM pg_indexes WHERE indexdef LIKE '% WHERE %'")
        found = set(transaction.session.scalars(query))
    database.close()
    postgresql.drop(url)
    assert found == partial_indices()


def partial_indices() -> set[str]:
    """Names of the indices with conditions."""
    wanted = {
        str(index.name)
        for table in Base.metadata.tables.values()
        for index in table.indexes
        if index.dialect_options["sqlite"]["where"] is not None
    }
    assert len(wanted) >= 4
    return wanted


def test_a_new_database_is_made_without_migrations(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from drivora_service.store.database import open_database\n"
        "open_database('sqlite:///new.sqlite3').close()\n"
        f"print([name for name in {UNUSED} if name in sys.modules])"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    assert ended.stdout.strip() == "[]"


def test_partial_indices_are_migrated_with_their_conditions(migrated: Engine) -> None:
    query = text("SELECT name FROM sqlite_master WHERE type = 'index' AND sql LIKE '%WHERE%'")
    with migrated.connect() as connection:
        found = set(connection.scalars(query))
    assert found == partial_indices()


def test_a_database_of_the_version_before_accountability_is_read(tmp_path: Path) -> None:
    """What it holds was written by that version: a campaign of 12 simulations and a run."""
    path = tmp_path / "old.sqlite3"
    with closing(sqlite3.connect(path)) as old:
        old.executescript((DATA / "schema_0003.sql").read_text())
    database = open_database(f"sqlite:///{path}")
    with database.read() as transaction:
        (campaign,) = transaction.campaigns.page().items
        records = transaction.evaluations.page(campaign.id)
        failures = transaction.evaluations.failures(campaign.id)
        summaries = transaction.campaign_views.evaluations(campaign.id).items
        (job,) = transaction.jobs.page(JobFilter()).items
        report = transaction.jobs.report(job.id)
    database.close()
    assert (campaign.counts.violating, campaign.counts.at_fault) == (8, 2)
    assert campaign.counts.avoidable is None
    assert campaign.counts.undetermined is None
    assert len(records) == 12
    assert len(failures) == 10
    assert all(summary.accountability is None for summary in summaries)
    # Of three violations one is a destination that was missed because of another one.
    assert (job.violations, job.observations, job.accountability) == (2, None, None)
    assert report is not None
    assert job.failures is None, "that version did not list the violations of runs"
    assert all(verdict.avoidable is None for verdict in report.verdicts)


def test_runs_that_ended_by_an_oracle_of_a_package_get_the_status_of_plug_ins(
    tmp_path: Path,
) -> None:
    path = tmp_path / "old.sqlite3"
    with closing(sqlite3.connect(path)) as old:
        old.executescript((DATA / "schema_0003.sql").read_text())
        old.execute("UPDATE runs SET status = 'oracle_failed'")
        for table, column in (("reports", "body"), ("evaluations", "report")):
            old.execute(
                f"UPDATE {table} SET {column} = "
                f"""replace({column}, '"status":"finished"', '"status":"oracle_failed"')"""
            )
        old.commit()
    database = open_database(f"sqlite:///{path}")
    with database.read() as transaction:
        (job,) = transaction.jobs.page(
            JobFilter(statuses=frozenset({RunStatus.PLUGIN_FAILED}))
        ).items
        report = transaction.jobs.report(job.id)
        (campaign,) = transaction.campaigns.page().items
        records = transaction.evaluations.page(campaign.id)
    database.close()
    assert job.status is RunStatus.PLUGIN_FAILED
    assert report is not None
    assert {report.status, *(record.report.status for record in records)} == {
        RunStatus.PLUGIN_FAILED
    }


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
    # What was raised is kept, and with it all that its frames hold.
    with pytest.raises(StoreError, match="is no SQLite database") as refusal:
        open_database(f"sqlite:///{path}")
    assert refusal.value.__traceback__ is not None
    assert str(path) not in {file.path for file in psutil.Process().open_files()}


@only_sqlite
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


def test_the_newest_migration_does_on_postgresql_what_it_does_on_sqlite(
    tmp_path: Path, postgresql: PostgresqlServer
) -> None:
    """A database with the runs, campaigns and failures of the revision before."""
    *_, before, newest = revisions()
    path = tmp_path / "old.sqlite3"
    with closing(sqlite3.connect(path)) as old:
        old.executescript((DATA / f"revision_{before}.sql").read_text())
    sqlite_engine = create_engine(f"sqlite:///{path}")
    url = postgresql.create(migrated=False)
    server_engine = create_engine(url)
    upgrade(server_engine, before)
    _copy_rows(sqlite_engine, server_engine)
    for engine in (sqlite_engine, server_engine):
        upgrade(engine, newest)
    expected, found = _rows(sqlite_engine), _rows(server_engine)
    for engine in (sqlite_engine, server_engine):
        engine.dispose()
    postgresql.drop(url)
    assert len(expected["runs"]) > 10
    assert len(expected["found_failures"]) > 1
    for table, rows in expected.items():
        assert found[table] == rows, table


def _copy_rows(source: Engine, target: Engine) -> None:
    """Copies all rows between databases of one revision, each value in the type of its column."""
    tables = MetaData()
    tables.reflect(target)
    with source.connect() as reading, target.begin() as writing:
        # Without the checks of foreign keys, so that any order will do.
        writing.execute(text("SET LOCAL session_replication_role = replica"))
        for table in tables.sorted_tables:
            writing.execute(table.delete())
            rows = reading.execute(text(f"SELECT * FROM {table.name}")).mappings().all()
            if rows:
                writing.execute(table.insert(), [_typed(table, row) for row in rows])


def _typed(table: Table, row: RowMapping) -> dict[str, Any]:
    return {
        name: bool(value)
        if isinstance(table.c[name].type, Boolean) and value is not None
        else value
        for name, value in row.items()
    }


def _rows(engine: Engine) -> dict[str, list[list[str]]]:
    """The rows of the tables that migrations fill, as texts that do not depend on the database."""
    names = ("runs", "verdicts", "found_failures", "campaigns", "facets", "batch_facets")
    found = {}
    with engine.connect() as connection:
        for name in names:
            rows = connection.execute(text(f"SELECT * FROM {name}"))
            keys = sorted(key for key in rows.keys() if not key.endswith("_at"))  # noqa: SIM118 # of rows
            found[name] = sorted(
                [f"{key}={_plain(row._mapping[key])}" for key in keys] for row in rows
            )
    return found


def _plain(value: Any) -> Any:
    return int(value) if isinstance(value, bool) else value
