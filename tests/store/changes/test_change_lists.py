"""No change of a shown object is missing in the lists of changes."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import event, select

from drivora_service.runs.run_report import RunStatus
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import (
    CampaignRequest,
    CampaignState,
    Confirmation,
    NewCampaign,
    StudyCell,
)
from drivora_service.store.changes import change_lists
from drivora_service.store.changes.change_lists import ChangedKind, ChangeList
from drivora_service.store.changes.revisions import Position, read_position
from drivora_service.store.database import Database, Transaction, open_database
from drivora_service.store.failures.group_lists import decision_of
from drivora_service.store.failures.group_membership import names_in
from drivora_service.store.failures.group_records import NewDecision, group_id
from drivora_service.store.failures.group_tables import FailureGroupRow
from drivora_service.store.minimizations.minimization_records import MinimizationProgress
from drivora_service.store.runs.batch_repository import SINGLE_JOBS
from drivora_service.store.runs.run_records import Priority
from drivora_service.store.traces.trace_folders import CampaignTraces, TraceFolder
from drivora_service.store.upkeep.backup import back_up
from drivora_service.store.upkeep.pruning import prune
from drivora_service.store.upkeep.retention import Retention, retain
from tests.store.campaigns.test_campaign_repository import evaluation
from tests.store.samples import (
    POLICY,
    claim,
    crashed,
    finish,
    finished,
    lost,
    new_minimization,
    new_run,
    only_sqlite,
    register,
    submit,
)
from tests.store.suites.test_suite_runs import DECISION, outcome
from tests.store.test_query_plans import plan, queries

Shown = dict[tuple[ChangedKind, str], tuple[int, Any]]


def shown(transaction: Transaction) -> Shown:
    """Everything that the API shows of each object, with its revision."""
    found: Shown = {}
    for listed in transaction.jobs.page(limit=1000).items:
        detail = transaction.jobs.detail(listed.id)
        document = transaction.jobs.document(listed.id)
        found[ChangedKind.RUN, listed.id] = (detail.revision, (without(detail), document))
    for batch in transaction.batches.page(limit=1000).items:
        found[ChangedKind.BATCH, batch.id] = (batch.revision, without(batch))
    for summary in transaction.campaigns.page(limit=1000).items:
        record = transaction.campaigns.get(summary.id)
        results = (
            transaction.campaign_views.evaluations(summary.id, limit=1000).items,
            transaction.campaign_views.failures(summary.id, limit=1000).items,
            transaction.campaign_views.kinds(summary.id),
        )
        found[ChangedKind.CAMPAIGN, summary.id] = (record.revision, (without(record), results))
    for study in transaction.studies.page(limit=1000).items:
        whole = transaction.studies.get(study.id)
        found[ChangedKind.STUDY, study.id] = (whole.revision, without(whole))
    for one in transaction.minimizations.page(limit=1000).items:
        smaller = transaction.minimizations.get(one.id)
        found[ChangedKind.MINIMIZATION, one.id] = (smaller.revision, without(smaller))
    for suite_run in transaction.suite_runs.page(limit=1000).items:
        whole_run = transaction.suite_runs.get(suite_run.id)
        found[ChangedKind.SUITE, suite_run.id] = (whole_run.revision, without(whole_run))
    for row in transaction.session.scalars(select(FailureGroupRow)):
        told = (without(decision_of(row)), names_in(transaction.session, row.seq))
        found[ChangedKind.GROUP, row.id] = (row.revision, told)
    return found


def without(value: Any) -> Any:
    """The same without its revision."""
    return replace(value, revision=0)


class Witness:
    """Compares what is shown before and after operations with the list of changes."""

    def __init__(self, database: Database) -> None:
        self.database = database
        self.seen: set[ChangedKind] = set()

    @contextmanager
    def watched(self, *, changes: bool = True) -> Iterator[None]:
        """Fails if an object is shown differently afterwards, and the list does not have it."""
        with self.database.read() as transaction:
            before, begin = shown(transaction), transaction.changes.latest()
        yield
        with self.database.read() as transaction:
            after = shown(transaction)
            listed = transaction.changes.after(begin.revision, limit=10_000)
            assert transaction.changes.latest() == listed.position
        different = {
            key
            for key, (_, content) in after.items()
            if key not in before or before[key][1] != content
        }
        assert listed.is_whole
        told = {(change.kind, change.id): change for change in listed.changes}
        assert different <= set(told), "changed, and not told"
        assert bool(different) is changes
        for key in different:
            assert begin.revision < after[key][0] == told[key].revision <= listed.position.revision
        revisions = [revision for revision, _ in after.values()]
        assert len(set(revisions)) == len(revisions)
        self.seen |= {kind for kind, _ in different}


@pytest.fixture
def witness(database: Database) -> Witness:
    return Witness(database)


def write(database: Database, act: Callable[[Transaction], object]) -> Any:
    with database.write() as transaction:
        return act(transaction)


def campaign_of(database: Database, study_id: str = "") -> str:
    campaign = NewCampaign(
        name="search",
        document="{}",
        tester="random",
        agent="idm",
        town="tee-town",
        network_sha256="a" * 64,
        budget=10,
        study_id=study_id,
        cell=StudyCell(scenario="s", agent="a", method="m", repetition=1) if study_id else None,
    )
    created: str = write(database, lambda t: t.campaigns.create(campaign)).id
    return created


def test_every_operation_on_jobs_and_the_queue_is_counted(
    database: Database, witness: Witness, tmp_path: Path
) -> None:
    with witness.watched():
        singles = submit(database, 3)
    with witness.watched():
        runs = submit(database, 9, priority=Priority.CI)
    with witness.watched(changes=False):
        owner, gone = register(database), register(database)
    with witness.watched():
        claim(database, owner, 6)
    with witness.watched():
        finish(database, owner, finished(singles[0], "collision", trace="1" * 64))
    with witness.watched():
        # The first crash is repeated, and so is what the infrastructure lost.
        finish(database, owner, crashed(runs[0]), lost(runs[1]))
    with witness.watched():
        write(database, lambda t: t.queue.release(owner, [runs[2]]))
    with witness.watched():
        claim(database, gone, 2)
    with witness.watched():
        write(database, lambda t: t.queue.reclaim(gone, POLICY))
    with witness.watched():
        claim(database, owner, 9)
    with witness.watched():
        finish(database, owner, crashed(runs[0]))
    with witness.watched():
        # It was quarantined, so that it ends at once.
        write(database, lambda t: t.jobs.submit([new_run("{0}")]))
    with witness.watched():
        write(database, lambda t: t.jobs.cancel(runs[4]))
    with witness.watched(changes=False):
        write(database, lambda t: t.jobs.cancel(runs[4]))
    with witness.watched():
        batch = write(database, lambda t: t.batches.create(name="b", priority=Priority.CI))
    for act in ("pause", "resume", "cancel"):
        with witness.watched(), database.write() as transaction:
            getattr(transaction.batches, act)(batch.id)
    with witness.watched(changes=False):
        write(database, lambda t: t.batches.cancel(batch.id))
    reserved = write(
        database, lambda t: t.batches.create(name="r", priority=Priority.CI, owner_id="me")
    )
    write(database, lambda t: t.jobs.submit([new_run("r")], batch_id=reserved.id))
    with witness.watched():
        write(database, lambda t: t.batches.cancel_reserved("me"))
    later = datetime.now(UTC) + timedelta(days=1)
    traces = TraceFolder(tmp_path / "traces")
    with witness.watched():
        prune(database, traces, ended_before=later, only_traces=True)
    with witness.watched():
        # Pruned runs are gone; their batches are smaller.
        prune(database, traces, ended_before=later, keep_violated=True)
    assert witness.seen == {ChangedKind.RUN, ChangedKind.BATCH}


def test_every_operation_on_campaigns_and_studies_is_counted(
    database: Database, witness: Witness
) -> None:
    with witness.watched():
        study = write(database, lambda t: t.studies.create(name="s", document="{}"))
    with witness.watched():
        campaign = campaign_of(database, study)
    with witness.watched():
        batch = write(database, lambda t: t.campaign_runs.open(campaign))
    with witness.watched():
        write(database, lambda t: t.campaigns.begin(campaign))
    run = new_run("{0}", run_id="a" * 24)
    with witness.watched():
        write(database, lambda t: t.campaign_runs.put(batch, run))
    with witness.watched(changes=False):
        write(database, lambda t: t.campaign_runs.put(batch, run))
    with witness.watched():
        # Another scenario in place of one that waits.
        write(database, lambda t: t.campaign_runs.put(batch, new_run("{1}", run_id=run.run_id)))
    owner = register(database)
    claim(database, owner, 1)
    finish(database, owner, finished(run.run_id, "collision"))
    with witness.watched():
        # One that has ended, with another scenario, is queued again.
        write(database, lambda t: t.campaign_runs.put(batch, run))
    write(database, lambda t: t.jobs.cancel(run.run_id))
    with witness.watched():
        write(database, lambda t: t.campaign_runs.put(batch, run))
    found = [
        evaluation(0, violated=(True, None)),
        evaluation(1, status=EvaluationStatus.INVALID),
        evaluation(2, status=EvaluationStatus.FAILED),
    ]
    for record in found:
        with witness.watched(), database.write() as transaction:
            transaction.evaluations.append(campaign, [(record, "{}")], active_s=1.0)
    with witness.watched():
        write(database, lambda t: t.evaluations.confirm(campaign, 0, Confirmation.FLAKY, trace="x"))
    with witness.watched():
        write(database, lambda t: t.evaluations.group(campaign, {(0, 0): 0, (0, 1): 1}))
    with witness.watched():
        write(database, lambda t: t.campaigns.ask_for(campaign, CampaignRequest.PAUSE))
    with witness.watched():
        write(database, lambda t: t.campaigns.end(campaign, CampaignState.PAUSED, active_s=2.0))
    with witness.watched():
        write(database, lambda t: t.campaigns.queue_again(campaign))
    with witness.watched():
        write(database, lambda t: t.campaigns.ask_for(campaign, CampaignRequest.CANCEL))
    with witness.watched():
        write(database, lambda t: t.studies.ask_for(study, CampaignRequest.CANCEL))
    assert witness.seen == set(ChangedKind) - {
        ChangedKind.MINIMIZATION,
        ChangedKind.GROUP,
        ChangedKind.SUITE,
    }


def test_every_operation_on_minimisations_is_counted(database: Database, witness: Witness) -> None:
    owner = register(database)
    new = new_minimization(owner_id=owner)
    with witness.watched():
        one = write(database, lambda t: t.minimizations.open(new))
    with witness.watched():
        write(database, lambda t: t.minimizations.advance(one, MinimizationProgress(decided=3)))
    with witness.watched(changes=False):
        write(database, lambda t: t.minimizations.interrupt("another"))
    with witness.watched():
        write(database, lambda t: t.minimizations.interrupt(owner))
    with witness.watched():
        assert write(database, lambda t: t.minimizations.open(new)) == one
    with witness.watched():
        write(database, lambda t: t.minimizations.cancel(one))
    with witness.watched(changes=False):
        write(database, lambda t: t.minimizations.cancel(one))
    assert ChangedKind.MINIMIZATION in witness.seen


def test_every_decision_about_groups_is_counted(database: Database, witness: Witness) -> None:
    owner = register(database)
    runs = submit(database, 3)
    claim(database, owner, 3)
    finish(database, owner, *(finished(r, o) for r, o in zip(runs, ("a", "a", "b"), strict=True)))
    one, other = group_id("a"), group_id("b")
    with witness.watched():
        write(database, lambda t: t.decisions.decide(one, NewDecision(note="n")))
    with witness.watched(changes=False):
        write(database, lambda t: t.decisions.decide(one, NewDecision(note="n")))
    with witness.watched():
        write(database, lambda t: t.decisions.merge(one, [other]))
    with witness.watched():
        write(database, lambda t: t.decisions.split(one, names=["b"]))
    assert ChangedKind.GROUP in witness.seen


def test_every_run_of_a_suite_is_counted(database: Database, witness: Witness) -> None:
    with witness.watched():
        write(database, lambda t: t.suite_runs.add(DECISION, [outcome("a")]))
    assert witness.seen == {ChangedKind.SUITE}


def test_traces_that_retention_removes_are_counted(
    database: Database, witness: Witness, tmp_path: Path
) -> None:
    campaign = campaign_of(database)
    records = [evaluation(number, violated=(True,)) for number in range(2)]
    with database.write() as transaction:
        transaction.evaluations.append(campaign, [(one, "{}") for one in records], active_s=1.0)
        for number in range(2):
            transaction.evaluations.confirm(campaign, number, Confirmation.CONFIRMED, trace="x")
        transaction.campaigns.end(campaign, CampaignState.FINISHED)
    with witness.watched():
        retain(
            database,
            TraceFolder(tmp_path / "traces"),
            CampaignTraces(tmp_path / "campaigns"),
            Retention(campaign_traces=timedelta(0)),
            now=datetime.now(UTC) + timedelta(days=1),
        )
    assert witness.seen == {ChangedKind.CAMPAIGN}


def test_statements_that_no_flush_sees_are_only_where_the_changes_are_counted() -> None:
    """A flush counts by itself; the operations of the modules here are in the tests above."""
    shown = "RunRow|BatchRow|CampaignRow|StudyRow|FailureRow|FailureKindRow|RUNS|BATCHES|_BATCHES"
    statement = re.compile(rf"\b(?:insert|update)\(\s*(?:{shown})\b")
    found = {
        path.name
        for path in Path(change_lists.__file__).parents[1].rglob("*.py")
        if statement.search(path.read_text())
    }
    assert found == {
        "cancelling.py",
        "pruning.py",
        "retention.py",
        "revisions.py",
        "run_statements.py",
        "submitting.py",
    }


def after(database: Database, revision: int, *kinds: ChangedKind, limit: int = 500) -> ChangeList:
    with database.read() as transaction:
        return transaction.changes.after(revision, kinds or tuple(ChangedKind), limit=limit)


def test_each_changed_object_comes_once_as_it_is_now_with_what_it_belongs_to(
    database: Database,
) -> None:
    study = write(database, lambda t: t.studies.create(name="s", document="{}"))
    campaign = campaign_of(database, study)
    batch = write(database, lambda t: t.campaign_runs.open(campaign))
    write(database, lambda t: t.campaign_runs.put(batch, new_run("{}", run_id="a" * 24)))
    (single,) = submit(database, 1)
    owner = register(database)
    claim(database, owner, 2)
    finish(database, owner, finished(single))
    listed = after(database, 0)
    told = {change.id: change for change in listed.changes}
    assert len(told) == len(listed.changes) == 5
    assert [change.revision for change in listed.changes] == sorted(
        change.revision for change in listed.changes
    )
    run = told["a" * 24]
    assert (run.status, run.batch_id, run.campaign_id, run.study_id) == (
        RunStatus.RUNNING,
        batch,
        campaign,
        study,
    )
    assert all(run.is_of(owner_id) for owner_id in (run.id, batch, campaign, study))
    assert (told[single].status, told[single].batch_id) == (RunStatus.FINISHED, "")
    assert not told[single].is_of(batch)
    assert not any(change.batch_id == SINGLE_JOBS for change in listed.changes)
    assert (told[batch].status, told[batch].campaign_id) == ("open", campaign)
    assert (told[campaign].status, told[campaign].batch_id) == ("queued", batch)
    assert told[study].study_id == study
    only = after(database, 0, ChangedKind.CAMPAIGN, ChangedKind.STUDY)
    assert {change.id for change in only.changes} == {campaign, study}
    assert only.position == listed.position
    assert after(database, listed.position.revision).changes == ()


def test_long_lists_come_in_parts_that_miss_nothing(database: Database) -> None:
    runs = submit(database, 20, priority=Priority.CI)
    owner = register(database)
    found: list[str] = []
    revision = 0
    for _ in range(100):
        part = after(database, revision, limit=3)
        assert len(part.changes) <= 3
        found += [change.id for change in part.changes]
        # Others change meanwhile.
        for run_id in claim(database, owner, 1):
            finish(database, owner, finished(run_id))
        if part.is_whole and not part.changes:
            break
        revision = part.position.revision
    assert set(runs) <= set(found)
    last = {change.id: change.status for change in after(database, 0).changes}
    assert {last[run_id] for run_id in runs} == {RunStatus.FINISHED}


def test_the_count_goes_on_when_the_newest_objects_are_deleted(
    database: Database, tmp_path: Path
) -> None:
    (run_id,) = submit(database, 1)
    owner = register(database)
    claim(database, owner, 1)
    finish(database, owner, finished(run_id))
    before = after(database, 0).position.revision
    prune(
        database,
        TraceFolder(tmp_path / "traces"),
        ended_before=datetime.now(UTC) + timedelta(days=1),
    )
    submit(database, 1)
    assert after(database, before).changes[-1].revision > before


def known(database: Database, position: Position) -> bool:
    with database.read() as transaction:
        return transaction.changes.is_known(position)


def test_positions_are_known_in_later_epochs_and_in_no_other_database(
    database: Database, tmp_path: Path
) -> None:
    register(database)
    submit(database, 5)
    position = after(database, 0).position
    register(database)
    submit(database, 5)
    later = after(database, 0).position
    assert later.epoch != position.epoch
    assert known(database, position)
    assert known(database, later)
    assert not known(database, replace(position, revision=position.revision + 1))
    assert not known(database, replace(later, revision=later.revision + 1))
    other = open_database(f"sqlite:///{tmp_path / 'other' / 'drivora.sqlite3'}")
    submit(other, 50)
    assert not known(other, position)
    assert known(other, Position(epoch="", revision=position.revision))
    other.close()


@only_sqlite
def test_changes_that_a_restored_backup_lost_make_positions_unknown(
    database: Database, tmp_path: Path
) -> None:
    register(database)
    submit(database, 5)
    kept = after(database, 0).position
    back_up(database, TraceFolder(tmp_path / "traces"), tmp_path / "backup")
    submit(database, 5)
    lost_position = after(database, 0).position
    restored = open_database(f"sqlite:///{tmp_path / 'backup' / 'drivora.sqlite3'}")
    register(restored)
    # Its count is soon beyond that of the lost changes.
    submit(restored, 50)
    assert known(restored, kept)
    assert not known(restored, lost_position)
    restored.close()


def test_positions_are_text() -> None:
    position = Position(epoch="0123456789ab", revision=42)
    assert read_position(str(position)) == position
    assert read_position("42") == Position(epoch="", revision=42)
    for text in ("", "x", "0123456789ab.", ".1", "-1", "0123456789AB.1", "1" * 16, "1 ", "1.2"):
        assert read_position(text) is None


@only_sqlite
def test_the_count_costs_a_transaction_one_statement_and_no_scan(database: Database) -> None:
    submit(database, 20, priority=Priority.CI)
    owner = register(database)
    sent: list[str] = []

    def note(_: object, __: object, statement: str, *___: object) -> None:
        sent.append(statement)

    event.listen(database.engine, "before_cursor_execute", note)
    runs = claim(database, owner, 10)
    finish(database, owner, *map(finished, runs))
    event.remove(database.engine, "before_cursor_execute", note)
    counting = [statement for statement in sent if "change_epochs" in statement]
    assert len(counting) == 2
    for statement in counting:
        assert [step for step in plan(database, statement, (1,)) if "change_epochs" in step] == [
            "SEARCH change_epochs USING INTEGER PRIMARY KEY (rowid=?)",
            "SEARCH change_epochs",
        ]
    with queries(database) as asked:
        assert after(database, 0).changes
    steps = [step for query in asked for step in plan(database, *query)]
    assert {step for step in steps if step.startswith("SCAN")} == {"SCAN change_epochs"}


def test_revisions_of_older_versions_are_followed(tmp_path: Path) -> None:
    path = tmp_path / "old.sqlite3"
    data = Path(__file__).parents[1] / "data" / "revision_0011.sql"
    old = sqlite3.connect(path)
    old.executescript(data.read_text())
    (newest,) = old.execute("SELECT max(revision) FROM runs").fetchone()
    old.close()
    database = open_database(f"sqlite:///{path}")
    with Witness(database).watched():
        submit(database, 1, priority=Priority.CI)
    listed = after(database, newest)
    database.close()
    assert {change.kind for change in listed.changes} >= {
        ChangedKind.RUN,
        ChangedKind.BATCH,
        ChangedKind.CAMPAIGN,
    }
