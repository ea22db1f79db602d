"""Figures for the operator follow what is queued, fails and is stored."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import Priority
from drivora_service.store.upkeep.store_figures import StoreFigures
from tests.store.samples import claim, crashed, ended, finish, finished, register, submit


def figures(database: Database) -> StoreFigures:
    with database.read() as transaction:
        return transaction.figures.figures()


def test_an_empty_store_has_nothing_but_its_size(database: Database, tmp_path: Path) -> None:
    found = figures(database)
    assert not found.failures
    assert found.oldest_queued_at is None
    assert found.quarantined == 0
    assert found.database_bytes > 0
    if database.engine.dialect.name == "sqlite":
        files = (tmp_path / "data").glob("drivora.sqlite3*")
        assert found.database_bytes <= sum(file.stat().st_size for file in files)


def test_failures_are_counted_by_status_and_cause(database: Database) -> None:
    submit(database, 5)
    owner = register(database)
    one, two, three, four, five = claim(database, owner, 5)
    for run_id, cause in ((one, "agent_hung"), (two, "agent_hung"), (three, "agent_raised")):
        failure = RunFailure(cause=cause, message="")
        report = RunReport(run_id=run_id, status=RunStatus.AGENT_FAILED, failure=failure)
        finish(database, owner, ended(report))
    finish(database, owner, finished(four))
    finish(database, owner, crashed(five))
    claim(database, owner, 1)
    finish(database, owner, crashed(five))
    found = figures(database)
    assert found.failures == {
        (RunStatus.AGENT_FAILED, "agent_hung"): 2,
        (RunStatus.AGENT_FAILED, "agent_raised"): 1,
        (RunStatus.SIMULATOR_CRASHED, "signal"): 1,
    }
    assert found.quarantined == 1


def test_the_oldest_run_of_a_batch_that_is_not_paused_counts(database: Database) -> None:
    first, _ = submit(database, 2, priority=Priority.CI)
    (second,) = submit(database, 1, priority=Priority.CI)
    with database.read() as transaction:
        paused = transaction.jobs.get(first)
        other = transaction.jobs.get(second)
    assert figures(database).oldest_queued_at == paused.created_at
    assert datetime.now(UTC) - paused.created_at < timedelta(minutes=5)
    with database.write() as transaction:
        transaction.batches.pause(paused.batch_id)
    assert figures(database).oldest_queued_at == other.created_at
    owner = register(database)
    assert claim(database, owner, 5) == (second,)
    assert figures(database).oldest_queued_at is None
