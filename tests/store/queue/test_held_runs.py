"""Runs that were interrupted by several deaths of the server."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

from sqlalchemy import update

from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database
from drivora_service.store.queue.run_queue import QueueRepository
from drivora_service.store.runs.run_tables import BatchRow, RunRow
from tests.store.samples import claim, finish, finished, new_run, register, submit

POLICY = RetryPolicy()


def die_with(database: Database, run: str, *, times: int) -> None:
    """Lets servers die one after another during the run."""
    for _ in range(times):
        owner = register(database)
        assert claim(database, owner, 1) == (run,)
        with database.write() as transaction:
            assert transaction.queue.reclaim(owner, POLICY) == 1
            transaction.workers.leave(owner)


def end_waits(database: Database, at: datetime) -> None:
    with database.write() as transaction:
        transaction.session.execute(
            update(RunRow).where(RunRow.not_before.is_not(None)).values(not_before=at)
        )


def status(database: Database, run: str) -> RunStatus:
    with database.read() as transaction:
        return transaction.jobs.get(run).status


def has_work(database: Database) -> bool:
    with database.read() as transaction:
        return QueueRepository(transaction.session).has_work()


def test_a_run_of_three_deaths_waits_and_runs_after_all_others(database: Database) -> None:
    (suspect,) = submit(database, 1)
    die_with(database, suspect, times=3)
    assert status(database, suspect) is RunStatus.QUEUED
    owner = register(database)
    assert not has_work(database)
    assert claim(database, owner, 5) == ()

    end_waits(database, datetime.now(UTC) - timedelta(seconds=1))
    others = submit(database, 4)
    assert claim(database, owner, 3) == others[:3]
    assert claim(database, owner, 3) == (others[3], suspect)
    finish(database, owner, finished(suspect))
    assert status(database, suspect) is RunStatus.FINISHED


def test_held_runs_run_one_at_a_time(database: Database) -> None:
    first, second = submit(database, 2)
    for _ in range(3):
        owner = register(database)
        assert claim(database, owner, 2) == (first, second)
        with database.write() as transaction:
            transaction.queue.reclaim(owner, POLICY)
    end_waits(database, datetime.now(UTC) - timedelta(seconds=1))
    owner = register(database)
    (one,) = claim(database, owner, 2)
    assert not has_work(database)
    assert claim(database, owner, 2) == ()
    finish(database, owner, finished(one))
    assert claim(database, owner, 2) == tuple({first, second} - {one})


def test_a_clock_that_is_set_back_does_not_hold_a_run_for_ever(database: Database) -> None:
    (suspect,) = submit(database, 1)
    die_with(database, suspect, times=3)
    end_waits(database, datetime.now(UTC) + timedelta(days=3))
    assert claim(database, register(database), 1) == (suspect,)


def test_a_run_that_is_put_back_keeps_nothing_of_its_former_end(database: Database) -> None:
    (run,) = submit(database, 1)
    owner = register(database)
    claim(database, owner, 1)
    finish(database, owner, finished(run, "collision", trace="abc"))
    with database.write() as transaction:
        batch = transaction.session.get_one(BatchRow, 1)
        transaction.campaign_runs.put(batch.id, new_run("{7}", run_id=run))
    with database.read() as transaction:
        job = transaction.jobs.get(run)
        row = transaction.session.get_one(RunRow, 1)
        assert transaction.jobs.report(run) is None
        assert row.trace_sha256 == ""
    assert job.status is RunStatus.QUEUED
    assert (job.violations, job.at_fault_violations, job.cause) == (None, None, "")
    assert (job.started_at, job.ended_at) == (None, None)
