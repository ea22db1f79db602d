from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import psutil
import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import text

from drivora_service.errors import StoreError
from drivora_service.runs.report import RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.migration import schema_version
from drivora_service.store.records import JobFilter
from drivora_service.store.tables import Base

DATA = Path(__file__).parent / "data"


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
    assert (job.violations, job.observations, job.accountability) == (3, None, None)
    assert report is not None
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
    with pytest.raises(StoreError, match="cannot be used") as refusal:
        open_database(f"sqlite:///{path}")
    assert refusal.value.__traceback__ is not None
    assert str(path) not in {file.path for file in psutil.Process().open_files()}


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
