"""The query plans of lists: by an index, for all filters."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from itertools import combinations
from typing import Any, TypeVar

import pytest
from sqlalchemy import event

from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.run_report import RunStatus
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import (
    CampaignState,
    Confirmation,
    EvaluationFilter,
    FailureFilter,
    NewCampaign,
)
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import JobFilter, Priority
from tests.store.samples import claim, finish, finished, new_run, only_sqlite, register

pytestmark = only_sqlite

Filter = TypeVar("Filter", EvaluationFilter, FailureFilter)

RUN_FILTERS: dict[str, Any] = {
    "statuses": frozenset({RunStatus.FINISHED, RunStatus.QUEUED}),
    "agent": "idm",
    "town": "tee-town",
    "oracle": "collision",
    "accountability": Accountability.AVOIDABLE,
    "violated": True,
    "scenario_sha256": new_run("0").scenario_sha256,
    "batch_id": "",
    "at_fault": True,
    "since": datetime(2020, 1, 1, tzinfo=UTC),
    "until": datetime(2100, 1, 1, tzinfo=UTC),
}
"""A value for each documented filter that some rows pass; the batch's id is set later."""

UNBOUNDED = ("runs", "verdicts", "evaluations", "failures", "reports", "documents", "attempts")


@pytest.fixture
def batch_id(database: Database) -> str:
    """A batch of nine runs; one has a violation, one is running."""
    with database.write() as transaction:
        batch = transaction.batches.create(name="b", priority=Priority.CAMPAIGN)
        transaction.jobs.submit([new_run(str(n)) for n in range(9)], batch_id=batch.id)
    owner = register(database)
    first, _ = claim(database, owner, 2)
    finish(database, owner, finished(first, "collision"))
    return batch.id


@pytest.mark.parametrize("newest_first", [True, False])
def test_runs_are_found_by_an_index_whatever_the_filters(
    database: Database, batch_id: str, newest_first: bool
) -> None:
    values = RUN_FILTERS | {"batch_id": batch_id}
    several = [names for size in range(1, 4) for names in combinations(sorted(values), size)]
    for names in (*several, tuple(values)):
        wanted = JobFilter(**{name: values[name] for name in names})
        with queries(database) as asked, database.read() as transaction:
            page = transaction.jobs.page(wanted, limit=2, newest_first=newest_first)
        assert page.items != ()
        steps = [step for query in asked for step in plan(database, *query)]
        refuse_unbounded(steps)
        index = r"rowid[=<>]|facet=|document_sha256=|\(id=|run_seq="
        # The greatest number of a run is read from the end of the table.
        touched = [
            step
            for step in steps
            if re.search(r"\b(runs|verdicts|batches)\b", step) and step != "SEARCH runs"
        ]
        assert touched != []
        assert [step for step in touched if not re.search(index, step)] == []
        if names == ("batch_id",):
            assert any("ix_runs_batch_facet (batch_seq=? AND facet=?)" in step for step in steps)


def test_pages_of_a_filter_begin_where_the_last_ended(database: Database, batch_id: str) -> None:
    wanted = JobFilter(batch_id=batch_id)
    with database.read() as transaction:
        token = transaction.jobs.page(wanted, limit=2).next_page_token
        with queries(database) as asked:
            transaction.jobs.page(wanted, limit=2, page_token=token)
    steps = [step for query in asked for step in plan(database, *query)]
    refuse_unbounded(steps)
    assert any("(batch_seq=? AND facet=? AND seq<?)" in step for step in steps)


def test_counts_and_the_queue_read_no_runs_but_those_they_take(
    database: Database, batch_id: str
) -> None:
    owner = register(database)
    with queries(database) as asked:
        with database.read() as transaction:
            transaction.batches.get(batch_id)
            transaction.batches.page()
            transaction.jobs.counts()
            transaction.jobs.count_queued_runs()
            transaction.changes.latest()
            transaction.changes.after(0)
            transaction.jobs.page(limit=2)
            transaction.queue.has_work()
            transaction.queue.to_cancel()
        claim(database, owner, 4)
    assert len(asked) >= 11
    steps = [step for query in asked for step in plan(database, *query)]
    # A list without a filter is walked from its end until the page is full.
    assert {step for step in steps if step.startswith("SCAN runs")} == {"SCAN runs"}
    refuse_unbounded([step for step in steps if step != "SCAN runs"])


def test_cancelling_a_batch_reads_only_its_unfinished_runs(
    database: Database, batch_id: str
) -> None:
    with queries(database) as asked, database.write() as transaction:
        transaction.batches.cancel(batch_id)
    steps = [step for query in asked for step in plan(database, *query)]
    refuse_unbounded(steps)
    assert any("ix_runs_batch_facet (batch_seq=? AND facet=?)" in step for step in steps)


@pytest.mark.parametrize("newest_first", [True, False])
def test_evaluations_and_failures_are_found_by_an_index_whatever_the_filters(
    database: Database, newest_first: bool
) -> None:
    with database.write() as transaction:
        campaign_id = transaction.campaigns.create(
            NewCampaign(
                name="search",
                document="{}",
                tester="random",
                agent="idm",
                town="tee-town",
                network_sha256="a" * 64,
                budget=10,
            )
        ).id
    evaluations = EvaluationFilter(status=EvaluationStatus.JUDGED, violating=False, generation=0)
    failures = FailureFilter(
        kind="collision",
        oracle="collision",
        at_fault=True,
        accountability=Accountability.AVOIDABLE,
        confirmation=Confirmation.OPEN,
    )
    with queries(database) as asked, database.read() as transaction:
        views = transaction.campaign_views
        views.kinds(campaign_id)
        transaction.campaigns.page(limit=2)
        transaction.campaigns.page(states={CampaignState.QUEUED, CampaignState.FAILED}, limit=2)
        for wanted in _several(evaluations):
            views.evaluations(campaign_id, wanted, newest_first=newest_first, limit=2)
        for chosen in _several(failures):
            views.failures(campaign_id, chosen, limit=2)
    steps = [step for query in asked for step in plan(database, *query)]
    refuse_unbounded(steps)
    walks = [step for step in steps if "evaluations" in step or "failures" in step]
    assert len(walks) > 40
    assert all("campaign_seq=?" in step for step in walks)
    filtered = [step for step in walks if "INDEX ix_failures" in step]
    assert {step.split(" (")[0] for step in filtered} == {
        "SEARCH failures USING COVERING INDEX ix_failures_filters"
    }


def _several(wanted: Filter) -> Iterator[Filter]:
    """Yields the filter with all and with each choice of its restrictions."""
    names = wanted.__slots__
    defaults = type(wanted)()
    for size in range(len(names) + 1):
        for left_out in combinations(names, size):
            yield replace(wanted, **{name: getattr(defaults, name) for name in left_out})


def refuse_unbounded(steps: list[str]) -> None:
    """Fails if a table that grows with the runs is read or sorted as a whole."""
    for step in steps:
        table = re.match(r"SCAN (\w+)", step)
        assert table is None or table.group(1) not in UNBOUNDED, step
        assert "TEMP B-TREE FOR ORDER BY" not in step, steps


Query = tuple[str, tuple[object, ...]]


@contextmanager
def queries(database: Database) -> Iterator[list[Query]]:
    """Collects the queries with their values."""
    asked: list[Query] = []

    def note(
        _: object, __: object, statement: str, values: tuple[object, ...], *___: object
    ) -> None:
        if statement.startswith("SELECT"):
            asked.append((statement, values))

    event.listen(database.engine, "before_cursor_execute", note)
    yield asked
    event.remove(database.engine, "before_cursor_execute", note)


def plan(database: Database, statement: str, values: tuple[object, ...]) -> list[str]:
    """Returns SQLite's query plan, which does not depend on the number of rows."""
    with database.engine.connect() as connection:
        rows = connection.exec_driver_sql("EXPLAIN QUERY PLAN " + statement, values)
        return [row.detail for row in rows]
