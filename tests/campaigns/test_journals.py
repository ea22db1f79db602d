"""Both journals keep the same, and only the one in the database survives."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import pytest
from sqlalchemy import make_url

from drivora_service.campaigns.records import store_journal
from drivora_service.campaigns.records.journal import Journal, MemoryJournal
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.campaigns.search.confirmation import confirm_failures, group_failures
from drivora_service.errors import Conflict
from drivora_service.store.campaigns.campaign_records import (
    CampaignRequest,
    Confirmation,
    EvaluationRecord,
    NewCampaign,
)
from drivora_service.store.database import Database, open_database
from drivora_service.store.locks.work_locks import LongWork
from tests.campaigns.analytic import Computed, run, sequence
from tests.postgresql_server import PostgresqlServer

Make = Callable[[], Journal]


@pytest.fixture(params=["memory", "store"])
def journal(request: pytest.FixtureRequest, database: Database) -> Journal:
    return MemoryJournal() if request.param == "memory" else stored(database)


@pytest.fixture(scope="module")
def records() -> list[EvaluationRecord]:
    journal = MemoryJournal()
    run(journal)
    return list(journal.evaluations())


def stored(database: Database) -> StoreJournal:
    return StoreJournal(database, stored_id(database))


def stored_id(database: Database) -> str:
    campaign = NewCampaign(
        name="computed",
        document="{}",
        tester="climber",
        agent="formula",
        town="nowhere",
        network_sha256="0" * 64,
        budget=60,
    )
    with database.write() as transaction:
        return transaction.campaigns.create(campaign).id


def append_now(journal: Journal, record: EvaluationRecord) -> None:
    journal.append(record, "[]")
    journal.flush()


def test_what_was_appended_is_read_again(journal: Journal, records: list[EvaluationRecord]) -> None:
    run(journal)
    read = list(journal.evaluations())
    assert sequence(read) == sequence(records)
    assert [r.report for r in read] == [r.report for r in records]


def test_a_campaign_is_resumed_from_its_journal(
    database: Database, records: list[EvaluationRecord]
) -> None:
    for known in (0, 1, 17, len(records)):
        journal = stored(database)
        for record in records[:known]:
            journal.append(record, "[]" if record.document_sha256 else "")
        run(journal, evaluator=Computed(slots=2, seed=known))
        assert sequence(list(journal.evaluations())) == sequence(records)


def test_more_than_a_page_is_read(database: Database) -> None:
    journal = stored(database)
    run(journal, budget=450)
    read = list(journal.evaluations())
    assert [record.number for record in read] == list(range(len(read)))
    assert len(read) > 450


def test_numbers_follow_one_another(journal: Journal, records: list[EvaluationRecord]) -> None:
    append_now(journal, records[0])
    for wrong in (records[0], records[2]):
        with pytest.raises((Conflict, ValueError)):
            append_now(journal, wrong)
    assert len(list(journal.evaluations())) == 1


def test_every_violation_is_a_failure(journal: Journal, records: list[EvaluationRecord]) -> None:
    run(journal)
    expected = [
        (record.number, place, key, verdict)
        for record in records
        for place, (key, verdict) in enumerate(
            zip(record.failure_kinds, record.violations, strict=True)
        )
    ]
    found = journal.failures()
    assert [(f.evaluation, f.place, f.kind, f.verdict) for f in found] == expected
    assert {f.confirmation for f in found} == {Confirmation.OPEN}
    assert {f.group for f in found} == {None}


def test_confirmations_and_groups_are_kept(journal: Journal) -> None:
    run(journal)
    failures = journal.failures()
    first, last = failures[0], failures[-1]
    journal.confirm(first.evaluation, Confirmation.CONFIRMED, "a.trace.parquet")
    journal.confirm(last.evaluation, Confirmation.FLAKY, "")
    journal.group({(first.evaluation, first.place): 4})
    kept = journal.failures()
    assert kept[0] == replace(
        first, confirmation=Confirmation.CONFIRMED, trace="a.trace.parquet", group=4
    )
    assert kept[-1].confirmation is Confirmation.FLAKY
    assert {f.confirmation for f in kept[1:-1]} <= {Confirmation.OPEN}


def test_failures_are_run_again_and_grouped_without_changing_the_search(
    journal: Journal, records: list[EvaluationRecord]
) -> None:
    run(journal)
    evaluator = Computed(slots=2)
    confirm_failures(journal, evaluator, run_prefix="test", trace_address=None)
    group_failures(journal)
    failing = {r.number for r in records if r.violations}
    assert sorted(evaluator.submitted) == sorted(failing)
    assert {f.confirmation for f in journal.failures()} == {Confirmation.CONFIRMED}
    assert all(f.group is not None for f in journal.failures())
    assert sequence(list(journal.evaluations())) == sequence(records)
    again = Computed()
    confirm_failures(journal, again, run_prefix="test", trace_address=None)
    assert again.submitted == []


def test_evaluations_are_written_together_once_the_first_has_waited(
    database: Database, records: list[EvaluationRecord]
) -> None:
    now = 0.0
    journal = StoreJournal(database, stored_id(database), clock=lambda: now)
    before = database.changes.value()
    for record in records[:5]:
        journal.append(record, "[]" if record.document_sha256 else "")
    journal.write_due()
    assert database.changes.value() == before
    now = 0.19
    journal.write_due()
    assert database.changes.value() == before
    now = 0.21
    journal.write_due()
    assert database.changes.value() != before
    assert sequence(list(journal.evaluations())) == sequence(records[:5])

    # The longer a campaign runs, the longer they wait, up to two seconds.
    for number, (begin, wait) in enumerate(((10.0, 1.0), (1000.0, 2.0)), start=5):
        before, now = database.changes.value(), begin
        journal.append(records[number], "[]" if records[number].document_sha256 else "")
        now = begin + wait - 0.01
        journal.write_due()
        assert database.changes.value() == before
        now = begin + wait + 0.01
        journal.write_due()
        assert database.changes.value() != before


def test_a_request_is_seen_soon(database: Database) -> None:
    now = 0.0
    campaign_id = stored_id(database)
    journal = StoreJournal(database, campaign_id, clock=lambda: now)
    assert journal.read_request() is CampaignRequest.NONE
    with database.write() as transaction:
        transaction.campaigns.begin(campaign_id)
        transaction.campaigns.ask_for(campaign_id, CampaignRequest.PAUSE)
    assert journal.read_request() is CampaignRequest.NONE
    now = 0.6
    assert journal.read_request() is CampaignRequest.PAUSE


def test_a_command_takes_the_lost_lock_of_its_campaign_again(postgresql: PostgresqlServer) -> None:
    url = postgresql.create()
    database, other = open_database(url), open_database(url)
    campaign_id, seconds = stored_id(database), iter(range(0, 100, 10))
    work = LongWork.campaign(campaign_id)
    held = database.locks.hold(work)
    journal = StoreJournal(database, campaign_id, clock=lambda: float(next(seconds)))
    journal.read_request()
    # As a restart of the server does.
    postgresql.execute(
        "SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity "
        f"WHERE datname = '{make_url(url).database}'"
    )
    assert not other.locks.is_held(work)
    journal.read_request()
    assert other.locks.is_held(work)
    held.release()
    assert not other.locks.is_held(work)
    for one in (database, other):
        one.close()
    postgresql.drop(url)


def test_what_is_due_is_written_while_a_tester_works(
    database: Database, records: list[EvaluationRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store_journal, "_LONGEST_WRITE_S", 0.02)
    campaign_id = stored_id(database)
    times = iter([0.0, 0.0, 100.0, 100.0, 100.0])
    journal = StoreJournal(database, campaign_id, clock=lambda: next(times, 200.0))
    with journal.written_meanwhile():
        journal.append(records[0], "[]")
        deadline = time.monotonic() + 30.0
        while not count_stored(database, campaign_id):
            assert time.monotonic() < deadline
            time.sleep(0.01)
    assert count_stored(database, campaign_id) == 1


def test_what_cannot_be_written_meanwhile_is_a_fault_of_the_next_write(
    database: Database, records: list[EvaluationRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store_journal, "_LONGEST_WRITE_S", 0.02)
    journal = StoreJournal(database, stored_id(database), claim="lost")
    with journal.written_meanwhile():
        journal.append(records[0], "[]")
        time.sleep(0.3)
    with pytest.raises(Conflict):
        journal.flush()


def count_stored(database: Database, campaign_id: str) -> int:
    with database.read() as transaction:
        return len(transaction.evaluations.page(campaign_id, after=-1, limit=10))
