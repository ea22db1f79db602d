"""Counts of runs by filter: those of the lists."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import cache
from itertools import combinations
from typing import Any

import pytest
from sqlalchemy import update

from drivora_service.oracles.verdict import Answer, Outcome
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database
from drivora_service.store.runs.run_counts import NO_RUNS, RunCounts
from drivora_service.store.runs.run_records import JobFilter, Priority, RunSummary
from drivora_service.store.runs.run_tables import RunRow
from tests.store.samples import (
    claim,
    crashed,
    finish,
    finished,
    new_run,
    register,
    slow_on_postgresql,
)

BEGIN = datetime(2026, 3, 1, tzinfo=UTC)
ORACLES = ("collision", "red_light", "near_miss")


@pytest.fixture
def batch_id(database: Database) -> str:
    """The second of two batches with runs of every kind, submitted a minute apart."""
    ends: list[dict[str, Any]] = [
        {},
        {"violated": ("collision",), "avoidable": Answer.YES},
        {"violated": ("collision", "red_light"), "faults": (True, False)},
        {"violated": ("red_light",), "faults": (False,)},
        {"violated": ("red_light",), "avoidable": Answer.NO},
        {"violated": ("near_miss",), "faults": (False, False)},
    ]
    for town in ("tee-town", "signal-grid"):
        with database.write() as transaction:
            batch = transaction.batches.create(name=town, priority=Priority.CAMPAIGN)
            runs = [new_run(str(n % 5), town=town, agent=f"a{n % 2}") for n in range(10)]
            transaction.jobs.submit(runs, batch_id=batch.id)
        owner = register(database)
        for end, run_id in zip(ends, claim(database, owner, len(ends)), strict=True):
            finish(database, owner, finished(run_id, *end.pop("violated", ()), **end))
            end.update(violated=("collision",))
        (failing,) = claim(database, owner, 1)
        finish(database, owner, crashed(failing))
    with database.write() as transaction:
        for number in range(20):
            time = BEGIN + timedelta(minutes=number)
            transaction.session.execute(
                update(RunRow).where(RunRow.seq == number + 1).values(created_at=time)
            )
    return batch.id


def filters(batch_id: str, sizes: range) -> Iterator[JobFilter]:
    """Every filter of so many parts."""
    values: dict[str, Any] = {
        "batch_id": batch_id,
        "statuses": frozenset({RunStatus.FINISHED, RunStatus.SIMULATOR_CRASHED}),
        "agent": "a1",
        "town": "tee-town",
        "oracle": "collision",
        "at_fault": False,
        "accountability": Accountability.AVOIDABLE,
        "violated": True,
        "scenario_sha256": new_run("1").scenario_sha256,
        "since": BEGIN + timedelta(minutes=3),
        "until": BEGIN + timedelta(minutes=14),
    }
    for size in sizes:
        for names in combinations(values, size):
            yield JobFilter(**{name: values[name] for name in names})


@slow_on_postgresql
def test_counts_are_the_lengths_of_the_lists(database: Database, batch_id: str) -> None:
    with database.read() as transaction:

        def number(wanted: JobFilter) -> int:
            return len(transaction.jobs.page(wanted, limit=500).items)

        for wanted in filters(batch_id, range(2)):
            counts = transaction.jobs.counts_by_filter(wanted)
            assert counts.total == number(wanted), wanted
            for status in RunStatus:
                listed = number(replace(wanted, statuses=frozenset({status})))
                assert counts.status.get(status, 0) == listed, (wanted, status)
            for degree in Accountability:
                listed = number(replace(wanted, accountability=degree))
                assert counts.accountability.get(degree, 0) == listed, (wanted, degree)
            for part, names, found in (
                ("agent", ("a0", "a1"), counts.agent),
                ("town", ("tee-town", "signal-grid"), counts.town),
                ("oracle", ORACLES, counts.oracle),
            ):
                for name in names:
                    listed = number(replace(wanted, **{part: name}))  # type: ignore[arg-type]  # the names are fields
                    assert found.get(name, 0) == listed, (wanted, part, name)
            assert (counts.violated, counts.not_violated, counts.at_fault, counts.not_at_fault) == (
                number(replace(wanted, violated=True)),
                number(replace(wanted, violated=False)),
                number(replace(wanted, at_fault=True)),
                number(replace(wanted, at_fault=False)),
            ), wanted


@slow_on_postgresql
@pytest.mark.parametrize(
    "sizes",
    [range(3), pytest.param(range(3, 4), marks=pytest.mark.slow)],
    ids=["up to two parts", "three parts"],
)
def test_counts_are_those_of_the_listed_runs(
    database: Database, batch_id: str, sizes: range
) -> None:
    totals: set[int] = set()
    with database.read() as transaction:

        @cache
        def listed(wanted: JobFilter) -> tuple[RunSummary, ...]:
            return transaction.jobs.page(wanted, limit=500).items

        def number(wanted: JobFilter) -> int:
            return len(listed(wanted))

        chosen = list(filters(batch_id, sizes))
        if 3 in sizes and database.engine.dialect.name == "postgresql":
            # SQLite executes the statements of all.
            chosen = chosen[1::4]
        for wanted in chosen:
            counts = transaction.jobs.counts_by_filter(wanted)
            totals.add(counts.total)
            assert counts.total == number(wanted), wanted
            # The values of a part are counted without the filter's own value of it.
            of_statuses = listed(replace(wanted, statuses=frozenset()))
            of_degrees = listed(replace(wanted, accountability=None))
            for found, expected in (
                (counts.status, Counter(run.status for run in of_statuses)),
                (counts.accountability, Counter(run.accountability for run in of_degrees)),
                (counts.agent, Counter(run.agent for run in listed(replace(wanted, agent="")))),
                (counts.town, Counter(run.town for run in listed(replace(wanted, town="")))),
            ):
                del expected[None]
                assert Counter(found) == expected, wanted
            # A list does not say which oracles its runs violated, nor who was at fault for which.
            for name in ORACLES:
                assert counts.oracle.get(name, 0) == number(replace(wanted, oracle=name)), wanted
            judged = Counter(
                None if run.violations is None else run.violations > 0
                for run in listed(replace(wanted, violated=None))
            )
            assert (counts.violated, counts.not_violated, counts.at_fault, counts.not_at_fault) == (
                judged[True],
                judged[False],
                number(replace(wanted, at_fault=True)),
                number(replace(wanted, at_fault=False)),
            ), wanted
    # Filters that let nothing or everything pass would compare nothing.
    assert len(totals) > 8
    assert max(totals) > 10


def test_runs_are_found_by_the_time_of_their_submission(database: Database, batch_id: str) -> None:
    def listed(since: int | None, until: int | None) -> list[int]:
        wanted = JobFilter(
            since=None if since is None else BEGIN + timedelta(minutes=since),
            until=None if until is None else BEGIN + timedelta(minutes=until),
        )
        with database.read() as transaction:
            page = transaction.jobs.page(wanted, limit=50, newest_first=False)
        return [int((run.created_at - BEGIN) / timedelta(minutes=1)) for run in page.items]

    assert listed(None, None) == list(range(20))
    assert listed(5, 8) == [5, 6, 7]
    assert listed(-1, 1) == [0]
    assert listed(19, None) == [19]
    assert listed(20, None) == []
    assert listed(None, 0) == []
    assert listed(8, 5) == []
    with database.write() as transaction:
        for seq in (6, 7, 8):
            row = transaction.session.get_one(RunRow, seq)
            transaction.session.delete(row)
    assert listed(5, 10) == [8, 9]
    assert listed(None, 7) == [0, 1, 2, 3, 4]


def test_fault_without_an_oracle_is_that_of_the_run(database: Database, batch_id: str) -> None:
    with database.read() as transaction:
        blamed = transaction.jobs.page(JobFilter(at_fault=True), limit=50).items
        others = transaction.jobs.page(JobFilter(at_fault=False), limit=50).items
    assert blamed != ()
    assert all(run.at_fault_violations for run in blamed)
    assert others != ()
    assert all(run.violations and not run.at_fault_violations for run in others)


def test_counts_of_unknown_batches_and_campaigns_are_empty(
    database: Database, batch_id: str
) -> None:
    for wanted in (
        JobFilter(batch_id="none"),
        JobFilter(campaign_id="none"),
        JobFilter(batch_id=batch_id, campaign_id="none"),
    ):
        with database.read() as transaction:
            counts: RunCounts = transaction.jobs.counts_by_filter(wanted)
            assert transaction.jobs.page(wanted).items == ()
        assert counts == NO_RUNS


def test_verdicts_that_are_not_measurable_are_counted_by_outcome(
    database: Database, batch_id: str
) -> None:
    wanted = JobFilter(outcome=Outcome.NOT_MEASURABLE)
    with database.read() as transaction:
        counts = transaction.jobs.counts_by_filter(wanted)
    assert (counts.total, counts.oracle) == (20, {})
