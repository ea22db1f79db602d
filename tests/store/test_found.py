"""The failures of all campaigns and batches in one list."""

from __future__ import annotations

import json
import re
from collections import Counter
from datetime import UTC, datetime, timedelta
from importlib import import_module
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select, text, update

from drivora_service.errors import InvalidDocument, UnknownName
from drivora_service.oracles.verdict import Answer, Severity
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import COUNTED, Counted
from drivora_service.store.campaigns.campaign_records import Confirmation, NewCampaign
from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.store.database import Database
from drivora_service.store.failures.failure_records import FoundFailure, FoundFilter
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.failures.group_records import GroupFilter, group_id
from drivora_service.store.queue.endings import reset_run
from drivora_service.store.runs.run_records import JobFilter, Priority
from drivora_service.store.runs.run_tables import RunRow
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.pruning import prune
from tests.store.campaigns.test_campaign_repository import append, create, evaluation
from tests.store.make_revision_data import fill
from tests.store.samples import (
    claim,
    finish,
    finished,
    new_run,
    only_sqlite,
    register,
    slow_on_postgresql,
)
from tests.store.test_query_plans import plan, queries

BEGIN = datetime(2026, 3, 1, tzinfo=UTC)


def everything(database: Database, wanted: FoundFilter | None = None) -> tuple[FoundFailure, ...]:
    with database.read() as transaction:
        page = transaction.found.page(wanted or FoundFilter(counts=Counted.ANY), limit=500)
    assert page.next_page_token == ""
    return page.items


@pytest.fixture
def campaign_id(database: Database) -> str:
    """Failures of two campaigns, of a batch and of single jobs, a minute apart."""
    campaign_id, other = create(database), create(database, "other")
    append(
        database,
        campaign_id,
        evaluation(0, violated=(True, None), avoidable=Answer.YES),
        evaluation(1),
        evaluation(2, violated=(False,), oracle="red_light"),
    )
    append(database, other, evaluation(0, violated=(True,), avoidable=Answer.NO))
    with database.write() as transaction:
        transaction.evaluations.confirm(campaign_id, 2, Confirmation.FLAKY, trace="2.trace.parquet")
        batch = transaction.batches.create(name="b", priority=Priority.CI)
        runs = [new_run(str(n), agent=f"a{n % 2}", town="grid") for n in range(3)]
        transaction.jobs.submit(runs, batch_id=batch.id)
        transaction.jobs.submit([new_run("{}")])
    owner = register(database)
    single, *rest = claim(database, owner, 4)
    finish(database, owner, finished(single, "collision", avoidable=Answer.YES))
    finish(database, owner, finished(rest[0], "speeding", "red_light", faults=(True, False)))
    finish(database, owner, finished(rest[1], "near_miss", severity=Severity.OBSERVATION))
    finish(database, owner, finished(rest[2]))
    with database.write() as transaction:
        for seq in transaction.session.scalars(select(FoundRow.seq)):
            transaction.session.execute(
                update(FoundRow)
                .where(FoundRow.seq == seq)
                .values(found_at=BEGIN + timedelta(minutes=seq))
            )
    return campaign_id


def test_failures_of_campaigns_and_runs_are_listed_the_last_found_first(
    database: Database, campaign_id: str
) -> None:
    found = everything(database)
    assert [failure.oracle for failure in found] == [
        *("red_light", "red_light", "speeding", "speeding", "collision"),
        *("collision", "red_light", "collision", "collision"),
    ]
    assert sorted((f.id for f in found), reverse=True) == [f.id for f in found]
    single, of_other, flaky = found[4:7]
    assert (single.campaign_id, single.batch_id, single.evaluation) == ("", "", None)
    assert (single.agent, single.town, single.confirmation) == ("idm", "tee-town", None)
    assert single.accountability is Accountability.AVOIDABLE
    assert of_other.accountability is Accountability.UNAVOIDABLE
    assert (flaky.campaign_id, flaky.evaluation, flaky.place) == (campaign_id, 2, 0)
    assert (flaky.kind, flaky.confirmation) == ("red_light|road a", Confirmation.FLAKY)
    assert not flaky.is_recorded
    assert flaky.sentence == "Violated red_light, on road a of tee-town; not the fault of the ego."
    for failure in found:
        assert failure.verdict.oracle == failure.oracle
        assert failure.verdict.at_fault == failure.at_fault
    with database.read() as transaction:
        assert transaction.found.failure(single.id) == single
        report = transaction.jobs.report(single.run_id)
        assert report is not None
        assert report.verdicts[single.place] == single.verdict
        with pytest.raises(UnknownName):
            transaction.found.failure(999)


def filters(database: Database, campaign_id: str, most: int = 3) -> list[FoundFilter]:
    """Filters of every part, of every two, and of every third combination of three."""
    (batch_id,) = {failure.batch_id for failure in everything(database)} - {""}
    values: dict[str, Any] = {
        "oracle": "red_light",
        "group": group_id("collision"),
        "at_fault": True,
        "accountability": Accountability.AVOIDABLE,
        "agent": "idm",
        "town": "tee-town",
        "campaign_id": campaign_id,
        "batch_id": batch_id,
        "confirmation": Confirmation.OPEN,
        "counts": Counted.AT_FAULT,
        "since": BEGIN + timedelta(minutes=2),
        "until": BEGIN + timedelta(minutes=8),
    }
    return [
        FoundFilter(**{name: values[name] for name in names})
        for size in range(most + 1)
        for names in list(combinations(values, size))[:: 3 if size == 3 else 1]
    ]


def passes(failure: FoundFailure, wanted: FoundFilter) -> bool:
    facts = {name: getattr(failure, name) for name in FoundFailure.__slots__}
    facts |= {"group": failure.group_id, "study_id": ""}
    # The campaigns say nothing of what they count, and keep only that; the runs count by default.
    counted = (
        failure.campaign_id != ""
        if wanted.counts is None
        else failure.accountability in COUNTED[wanted.counts]
    ) or (wanted.counts is None and failure.accountability in COUNTED[Counted.ACCOUNTABLE])
    return (
        counted
        and all(
            getattr(wanted, name) in ("", None) or getattr(wanted, name) == facts[name]
            for name in FoundFilter.__slots__
            if name not in ("since", "until", "counts", "all_kept")
        )
        and (wanted.since or BEGIN) <= failure.found_at < (wanted.until or datetime.now(UTC))
    )


@slow_on_postgresql
def test_filters_and_groups_are_those_of_the_whole_list(
    database: Database, campaign_id: str
) -> None:
    found = everything(database)
    sizes = set()
    for wanted in filters(database, campaign_id):
        expected = [failure for failure in found if passes(failure, wanted)]
        sizes.add(len(expected))
        assert list(everything(database, wanted)) == expected, wanted
        with database.read() as transaction:
            groups = transaction.groups.page(GroupFilter(failures=wanted), limit=500).items
        counts = Counter(failure.group_id for failure in expected)
        assert {one.id: one.failures for one in groups} == counts
        assert [one.id for one in groups] == list(counts), "the last seen come first"
        for one in groups:
            members = [failure for failure in expected if failure.group_id == one.id]
            assert one.names == (members[0].group_name,)
            avoidable = [m for m in members if m.accountability is Accountability.AVOIDABLE]
            assert (one.avoidable, one.others) == (len(avoidable), len(members) - len(avoidable))
            usual = (avoidable or members)[0]
            assert one.example == usual or (one.example.is_recorded and not usual.is_recorded)
            assert one.example in members
            assert one.example.is_recorded == any(m.is_recorded for m in members)
            assert one.sentence == one.example.sentence
            assert (one.first_seen, one.last_seen) == (members[-1].found_at, members[0].found_at)
            assert one.campaigns == len({m.campaign_id for m in members} - {""})
            assert one.towns == len({m.town for m in members})
    assert len(sizes) > 5


def test_the_example_of_a_group_has_a_recording_if_one_of_its_failures_has(
    database: Database,
) -> None:
    """The newest failures may be of a campaign that ended before they were run again."""

    def example() -> FoundFailure:
        with database.read() as transaction:
            (group,) = transaction.groups.page().items
        return group.example

    whole, cancelled = create(database), create(database, "cancelled")
    append(
        database,
        whole,
        *(
            evaluation(n, violated=(True,), avoidable=(Answer.YES, Answer.NO)[n > 1])
            for n in range(3)
        ),
    )
    append(database, cancelled, evaluation(0, violated=(True,), avoidable=Answer.YES))
    assert (example().campaign_id, example().is_recorded) == (cancelled, False)
    for number, confirmation, trace in (
        (2, Confirmation.FLAKY, ""),
        (0, Confirmation.CONFIRMED, "000000.trace.parquet"),
    ):
        with database.write() as transaction:
            transaction.evaluations.confirm(whole, number, confirmation, trace=trace)
    assert (example().campaign_id, example().evaluation) == (whole, 0)
    with database.write() as transaction:
        transaction.evaluations.confirm(whole, 1, Confirmation.CONFIRMED, trace="1.trace.parquet")
    assert (example().campaign_id, example().evaluation) == (whole, 1), "the last that is avoidable"
    with database.read() as transaction:
        (group,) = transaction.groups.page(
            GroupFilter(failures=FoundFilter(campaign_id=cancelled))
        ).items
    assert group.example.campaign_id == cancelled, "another is not in the list"


def test_pages_follow_one_another(database: Database, campaign_id: str) -> None:
    found = everything(database, FoundFilter())
    assert len(found) < len(everything(database)), "what does not count is left out"
    with database.read() as transaction:
        pages: list[FoundFailure] = []
        token = ""
        while token or not pages:
            page = transaction.found.page(limit=2, page_token=token)
            pages += page.items
            token = page.next_page_token
        first = transaction.groups.page(limit=2)
        second = transaction.groups.page(limit=2, page_token=first.next_page_token)
        whole = transaction.groups.page(limit=10)
        with pytest.raises(InvalidDocument):
            transaction.groups.page(limit=2, page_token=page.next_page_token or "x")
        with pytest.raises(InvalidDocument):
            transaction.found.page(FoundFilter(town="grid"), page_token=first.next_page_token)
    assert tuple(pages) == found
    assert (*first.items, *second.items) == whole.items
    assert second.next_page_token == ""


def test_unknown_campaigns_and_batches_have_no_failures(
    database: Database, campaign_id: str
) -> None:
    for wanted in (FoundFilter(campaign_id="none"), FoundFilter(batch_id="none")):
        assert everything(database, wanted) == ()
        with database.read() as transaction:
            assert transaction.groups.page(GroupFilter(failures=wanted)).items == ()


def test_runs_of_campaigns_are_not_listed_a_second_time(database: Database) -> None:
    campaign_id = create(database)
    with database.write() as transaction:
        batch_id = transaction.campaign_runs.open(campaign_id)
        transaction.jobs.submit([new_run("{}", run_id=f"{campaign_id}-0")], batch_id=batch_id)
    owner = register(database)
    (run_id,) = claim(database, owner, 1)
    finish(database, owner, finished(run_id, "collision"))
    assert everything(database) == ()
    append(database, campaign_id, evaluation(0, violated=(True,)))
    (failure,) = everything(database)
    assert (failure.campaign_id, failure.run_id) == (campaign_id, run_id)


def test_a_failure_is_on_the_network_of_its_seed_scenario(database: Database) -> None:
    towns = ("Town01", "Town02")
    seeds = [{"name": town, "scenario": {"map_region": {"town": town}}} for town in towns]
    with database.write() as transaction:
        campaign_id = transaction.campaigns.create(
            NewCampaign(
                name="two",
                document=json.dumps({"scenarios": seeds}),
                tester="random",
                agent="idm",
                town="Town01",
                network_sha256="a" * 64,
                budget=10,
            )
        ).id
    one = evaluation(0, violated=(True,))
    append(database, campaign_id, type(one)(**{**_fields(one), "seed_number": 1}))
    assert [failure.town for failure in everything(database)] == ["Town02"]


def _fields(record: Any) -> dict[str, Any]:
    return {name: getattr(record, name) for name in record.__slots__}


def test_failures_go_with_their_runs_and_campaigns(
    database: Database, campaign_id: str, tmp_path: Path
) -> None:
    of_campaign = everything(database, FoundFilter(campaign_id=campaign_id))
    assert len(of_campaign) == 3
    with database.write() as transaction:
        row = transaction.session.scalars(
            select(CampaignRow).where(CampaignRow.id == campaign_id)
        ).one()
        transaction.session.delete(row)
    left = everything(database)
    assert len(left) == 6
    with database.write() as transaction:
        run = transaction.session.scalars(select(RunRow).where(RunRow.id == left[0].run_id)).one()
        reset_run(transaction.session, run)
    kept = [failure.id for failure in left if failure.run_id != left[0].run_id]
    assert [failure.id for failure in everything(database)] == kept
    soon = datetime.now(UTC) + timedelta(days=1)
    prune(database, TraceFolder(tmp_path / "traces"), ended_before=soon)
    assert [failure.oracle for failure in everything(database)] == ["collision"]


def test_what_does_not_count_is_shown_on_demand(database: Database, campaign_id: str) -> None:
    counted = everything(database, FoundFilter())
    rest = [one for one in everything(database) if one not in counted]
    # Campaigns keep what they count, whatever that is; runs count by the default here.
    assert {one.campaign_id for one in rest} == {""}
    assert {one.accountability for one in rest} == {Accountability.NOT_AT_FAULT}
    with database.read() as transaction:
        jobs = transaction.jobs.page(JobFilter(), limit=100).items
        failing = transaction.jobs.page(JobFilter(failing=True), limit=100).items
        numbers = transaction.jobs.counts_by_filter(JobFilter())
        (batch,) = (one for one in transaction.batches.page().items if one.name == "b")
    ended = [job for job in jobs if job.failures is not None]
    assert {job.id for job in failing} == {job.id for job in ended if job.failures}
    assert {job.id for job in failing} == {one.run_id for one in counted if not one.campaign_id}
    assert (numbers.failing, numbers.not_failing) == (len(failing), len(ended) - len(failing))
    assert batch.failing_runs == sum(job.batch_id == batch.id for job in failing)


def test_a_migrated_database_has_the_failures_that_it_would_have_written(
    database: Database,
) -> None:
    fill(database)
    written = [facts(failure) for failure in everything(database)]
    assert len(written) > 4
    migration = import_module("drivora_service.store.migrations.versions.0013_found_failures")
    with database.engine.connect() as connection:
        rows = [*migration._of_campaigns(connection), *migration._of_runs(connection)]
    with database.write() as transaction:
        transaction.session.execute(text("DELETE FROM found_failures"))
        rows.sort(key=lambda row: row["found_at"])
        for row in rows:
            values = row | {
                "group": row["group_name"],
                # As a later migration fills it, of runs whose scenarios name no agent.
                "configuration": row["agent"],
                "found_at": row["found_at"].replace(tzinfo=UTC),
            }
            del values["group_name"]
            transaction.session.add(FoundRow(**values))
    migrated = [facts(failure) for failure in everything(database)]
    assert sorted(migrated) == sorted(written)


def facts(failure: FoundFailure) -> str:
    """All but the id, which follows the order of finding."""
    return repr({name: getattr(failure, name) for name in FoundFailure.__slots__[1:]})


@only_sqlite
def test_lists_read_the_narrow_table_only_and_the_failures_shown(
    database: Database, campaign_id: str
) -> None:
    for wanted in filters(database, campaign_id, most=2):
        with queries(database) as asked, database.read() as transaction:
            transaction.found.page(wanted, limit=2)
            transaction.groups.page(GroupFilter(failures=wanted), limit=2)
        steps = [step for query in asked for step in plan(database, *query)]
        scanned = {step for step in steps if re.match(r"SCAN [a-z]", step)}
        grouped = "SCAN found_failures USING COVERING INDEX ix_found_failures_group"
        # What people have decided about is little.
        assert scanned <= {"SCAN found_failures", "SCAN failure_group_names", grouped}
        assert wanted.group or grouped in scanned
        assert "USE TEMP B-TREE FOR GROUP BY" not in steps
        assert any("found_failures USING INTEGER PRIMARY KEY (rowid=?)" in step for step in steps)
    with queries(database) as asked, database.read() as transaction:
        transaction.found.page(limit=2)
    steps = [step for query in asked for step in plan(database, *query)]
    assert not any("TEMP B-TREE" in step for step in steps)
