"""Stored minimisations: their states, their runs, and those of commands that have ended."""

from __future__ import annotations

from dataclasses import replace

import pytest

from drivora_service.errors import Conflict, InvalidDocument, UnknownName
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database
from drivora_service.store.minimizations.minimization_records import (
    MinimizationProgress,
    MinimizationRecord,
    MinimizationState,
)
from drivora_service.store.runs.run_records import BatchState, Priority
from tests.store.samples import (
    claim,
    finish,
    finished,
    new_minimization,
    new_run,
    register,
)

PROGRESS = MinimizationProgress(
    stage="actors", decided=7, simulations=9, simulation_s=1.5, removed=("One.",), document={"a": 1}
)


def opened(database: Database, **changes: object) -> str:
    with database.write() as transaction:
        return transaction.minimizations.open(new_minimization(**changes))


def record(database: Database, minimization_id: str) -> MinimizationRecord:
    with database.read() as transaction:
        return transaction.minimizations.get(minimization_id)


def test_one_is_read_back_with_its_progress(database: Database) -> None:
    one = opened(database)
    found = record(database, one)
    assert found.state is MinimizationState.QUEUED
    assert found.failure == new_minimization().failure
    assert (found.budget, found.started_at, found.document) == (100, None, None)
    with database.write() as transaction:
        transaction.minimizations.advance(one, PROGRESS)
    found = record(database, one)
    assert found.state is MinimizationState.RUNNING
    assert found.started_at is not None
    assert found.ended_at is None
    for name in ("stage", "decided", "simulations", "simulation_s", "removed", "document"):
        assert getattr(found, name) == getattr(PROGRESS, name)
    with database.write() as transaction:
        done = replace(PROGRESS, one_minimal=True, minimal_run_id="x")
        transaction.minimizations.advance(one, done, MinimizationState.FINISHED)
    found = record(database, one)
    assert (found.state, found.one_minimal) == (MinimizationState.FINISHED, True)
    assert found.ended_at is not None
    with database.write() as transaction, pytest.raises(Conflict, match="finished"):
        transaction.minimizations.advance(one, PROGRESS)


def test_its_runs_come_after_single_ones_and_before_campaigns(database: Database) -> None:
    one = record(database, opened(database))
    with database.read() as transaction:
        batch = transaction.batches.get(one.batch_id)
    assert batch.priority is Priority.CI
    assert batch.name == f"minimise {one.run_id}"


def test_lists_are_newest_first_and_of_a_run(database: Database) -> None:
    ids = [opened(database, run_id=run) for run in ("a", "b", "a", "a")]
    with database.read() as transaction:
        page = transaction.minimizations.page(limit=3)
        rest = transaction.minimizations.page(limit=3, page_token=page.next_page_token)
        of_run = transaction.minimizations.page(run_id="b")
        with pytest.raises(InvalidDocument):
            transaction.minimizations.page(run_id="b", page_token=page.next_page_token)
        with pytest.raises(UnknownName, match="unknown minimisation 'none'; known: "):
            transaction.minimizations.get("none")
    assert [item.id for item in (*page.items, *rest.items)] == ids[::-1]
    assert rest.next_page_token == ""
    assert [item.id for item in of_run.items] == [ids[1]]


def test_a_process_works_on_its_own(database: Database) -> None:
    owner = register(database)
    of_service, of_command = opened(database), opened(database, owner_id=owner)
    cancelled = opened(database)
    with database.write() as transaction:
        transaction.minimizations.cancel(cancelled)
    with database.read() as transaction:
        active = transaction.minimizations.active
        assert [one.id for one in active("")] == [of_service]
        assert [one.id for one in active(owner)] == [of_command]


def test_its_runs_that_have_ended_and_the_others(database: Database) -> None:
    one = record(database, opened(database))
    runs = [new_run(f"{{{n}}}", run_id=f"run-{n}") for n in range(3)]
    with database.write() as transaction:
        transaction.campaign_runs.put(one.batch_id, *runs)
    owner = register(database)
    claim(database, owner, 2)
    finish(database, owner, finished("run-0", "collision"), finished("run-1"))
    with database.read() as transaction:
        reports = list(transaction.minimizations.reports(one.id))
        unfinished = transaction.minimizations.unfinished_runs(one.id)
    assert sorted(report.run_id for report in reports) == ["run-0", "run-1"]
    assert unfinished == ("run-2",)


def test_a_cancelled_one_takes_its_runs_along_and_stays_so(database: Database) -> None:
    one = record(database, opened(database))
    with database.write() as transaction:
        transaction.campaign_runs.put(one.batch_id, new_run(run_id="run-0"))
        transaction.minimizations.cancel(one.id)
        transaction.minimizations.cancel(one.id)
    with database.read() as transaction:
        assert transaction.jobs.get("run-0").status is RunStatus.CANCELLED
        assert transaction.batches.get(one.batch_id).state is BatchState.CANCELLED
    assert record(database, one.id).state is MinimizationState.CANCELLED


def test_one_whose_command_has_ended_is_reopened_by_an_equal_request(database: Database) -> None:
    owner, other = register(database), register(database)
    one = record(database, opened(database, owner_id=owner))
    with database.write() as transaction:
        transaction.campaign_runs.put(one.batch_id, new_run(run_id="run-0"))
        transaction.minimizations.interrupt(owner)
        transaction.batches.cancel_reserved(owner)
    assert record(database, one.id).state is MinimizationState.INTERRUPTED
    assert opened(database, owner_id=other, budget=99) != one.id
    assert opened(database, owner_id=other) == one.id
    assert opened(database, owner_id=other) != one.id, "it runs, and another one was wanted"
    with database.write() as transaction:
        # Its cancelled run is queued again, for the new process.
        transaction.campaign_runs.put(one.batch_id, new_run(run_id="run-0"))
        assert transaction.jobs.get("run-0").status is RunStatus.QUEUED
        assert one.id in [found.id for found in transaction.minimizations.active(other)]
    assert record(database, one.id).batch_id == one.batch_id
