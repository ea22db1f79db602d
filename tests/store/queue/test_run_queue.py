from __future__ import annotations

import threading
from collections import Counter
from dataclasses import replace

import pytest

from drivora_service.errors import Conflict, QueueFull
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.queue.quarantine import quarantine_key
from drivora_service.store.runs.run_records import BatchState, JobFilter, Priority, RunOptions
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify
from tests.store.samples import (
    POLICY,
    claim,
    crashed,
    ended,
    finish,
    finished,
    lost,
    new_run,
    register,
    submit,
)


def status(database: Database, run_id: str) -> RunStatus:
    with database.read() as transaction:
        return transaction.jobs.get(run_id).status


def batch_of(database: Database, run_id: str) -> str:
    with database.read() as transaction:
        return transaction.jobs.get(run_id).batch_id


def test_interactive_jobs_go_before_ci_batches_before_campaigns(database: Database) -> None:
    campaign = submit(database, 2, priority=Priority.CAMPAIGN)
    ci = submit(database, 2, priority=Priority.CI)
    single = submit(database, 2)
    owner = register(database)
    order = [claim(database, owner, 1)[0] for _ in range(6)]
    assert order == [*single, *ci, *campaign]
    assert claim(database, owner, 1) == ()


def test_one_claim_may_span_priorities(database: Database) -> None:
    campaign = submit(database, 5, priority=Priority.CAMPAIGN)
    single = submit(database, 2)
    assert sorted(claim(database, register(database), 4)) == sorted([*single, *campaign[:2]])


def test_batches_of_one_priority_take_turns(database: Database) -> None:
    long = submit(database, 40, priority=Priority.CAMPAIGN)
    owner = register(database)
    claim(database, owner, 20)
    late = submit(database, 10, priority=Priority.CAMPAIGN)
    taken = [run for _ in range(3) for run in claim(database, owner, 4)]
    share = Counter(batch_of(database, run) for run in taken)
    assert share == {batch_of(database, long[0]): 6, batch_of(database, late[0]): 6}


def test_a_paused_batch_waits_and_goes_on(database: Database) -> None:
    runs = submit(database, 3, priority=Priority.CI)
    batch_id = batch_of(database, runs[0])
    owner = register(database)
    with database.write() as transaction:
        assert transaction.batches.pause(batch_id).state is BatchState.PAUSED
        assert not transaction.queue.has_work()
    assert claim(database, owner, 3) == ()
    with database.write() as transaction:
        transaction.batches.resume(batch_id)
    assert claim(database, owner, 3) == runs


def test_a_report_that_comes_twice_is_one_result(database: Database) -> None:
    (run,) = submit(database, 1)
    owner = register(database)
    claim(database, owner, 1)
    assert len(finish(database, owner, finished(run, "collision"), finished(run))) == 1
    assert finish(database, owner, lost(run)) == ()
    with database.read() as transaction:
        job = transaction.jobs.get(run)
        report = transaction.jobs.report(run)
    assert (job.status, job.violations, job.at_fault_violations) == (RunStatus.FINISHED, 1, 1)
    assert report is not None
    assert report.metrics == {"speed": 3.0, "gap": None}


def test_an_owner_that_lost_its_lease_cannot_end_the_run(database: Database) -> None:
    (run,) = submit(database, 1)
    old, new = register(database), register(database)
    claim(database, old, 1)
    with database.write() as transaction:
        assert list(transaction.workers.heartbeats(me=new)) == [old]
        assert transaction.queue.reclaim(old, POLICY) == 1
    assert claim(database, new, 1) == (run,)
    assert finish(database, old, finished(run, "collision")) == ()
    assert status(database, run) is RunStatus.RUNNING
    finish(database, new, finished(run))
    with database.read() as transaction:
        assert transaction.jobs.get(run).violations == 0
        outcomes = [attempt.outcome for attempt in transaction.jobs.attempts(run)]
    assert outcomes == ["interrupted", "finished"]


def test_an_attempt_that_was_taken_for_lost_does_not_end_the_next_one_of_its_owner(
    database: Database,
) -> None:
    (run,) = submit(database, 1)
    owner = register(database)
    claim(database, owner, 1)
    with database.write() as transaction:
        transaction.queue.reclaim(owner, POLICY)
    assert claim(database, owner, 1) == (run,)
    assert finish(database, owner, replace(finished(run, "collision"), attempt=1)) == ()
    assert status(database, run) is RunStatus.RUNNING
    assert len(finish(database, owner, replace(finished(run), attempt=2))) == 1
    with database.read() as transaction:
        assert transaction.jobs.get(run).violations == 0


def test_a_confirmed_crash_quarantines_the_scenario(database: Database) -> None:
    (run,) = submit(database, 1)
    owner = register(database)
    for attempt in (1, 2):
        assert claim(database, owner, 1) == (run,)
        assert len(finish(database, owner, crashed(run))) == attempt - 1
    assert status(database, run) is RunStatus.SIMULATOR_CRASHED
    scenario = new_run("{0}")
    with database.write() as transaction:
        (entry,) = transaction.quarantine.newest()
        again, other_seed = transaction.jobs.submit(
            [scenario, new_run("{0}", options=RunOptions(seed_override=5))]
        )
    assert (entry.run_id, entry.signal, entry.log) == (run, "SIGSEGV", "last line")
    assert entry.key == quarantine_key(scenario.scenario_sha256, "", None)
    with database.read() as transaction:
        assert transaction.jobs.get(again).cause == "quarantined"
        assert transaction.jobs.get(other_seed).status is RunStatus.QUEUED
    with database.write() as transaction:
        assert transaction.quarantine.release(scenario.scenario_sha256) == 1
        (third,) = transaction.jobs.submit([scenario])
    assert status(database, third) is RunStatus.QUEUED


def test_lost_attempts_are_repeated_a_limited_number_of_times(database: Database) -> None:
    (run,) = submit(database, 1)
    owner = register(database)
    for _ in range(POLICY.infrastructure_failures):
        assert claim(database, owner, 1) == (run,)
        finish(database, owner, lost(run))
    assert claim(database, owner, 1) == ()
    assert status(database, run) is RunStatus.INFRASTRUCTURE_FAILED


def test_cancelling_ends_queued_runs_and_asks_for_running_ones(database: Database) -> None:
    runs = submit(database, 3, priority=Priority.CI)
    owner = register(database)
    claim(database, owner, 1)
    with database.write() as transaction:
        batch = transaction.batches.cancel(batch_of(database, runs[0]))
        assert batch.counts == {RunStatus.RUNNING: 1, RunStatus.CANCELLED: 2}
        assert transaction.queue.to_cancel() == runs[:1]
        with pytest.raises(Conflict, match="cancelled"):
            transaction.jobs.submit([new_run()], batch_id=batch.id)
    # It is lost, not ended by the cancellation: it must not be tried again nevertheless.
    finish(database, owner, lost(runs[0]))
    assert status(database, runs[0]) is RunStatus.CANCELLED
    assert claim(database, owner, 3) == ()


def test_released_runs_are_handed_out_again(database: Database) -> None:
    runs = submit(database, 2)
    owner = register(database)
    claim(database, owner, 2)
    with database.write() as transaction:
        transaction.queue.release(owner, runs)
    assert claim(database, owner, 2) == runs


def test_a_full_queue_takes_nothing_of_a_submission_too_large(database: Database) -> None:
    submit(database, 8)
    with pytest.raises(QueueFull) as caught, database.write() as transaction:
        transaction.jobs.submit([new_run(str(n)) for n in range(3)], queue_limit=10)
    assert (caught.value.queued, caught.value.limit) == (8, 10)
    with database.write() as transaction:
        assert transaction.jobs.count_queued_runs() == 8
        transaction.jobs.submit([new_run(str(n)) for n in range(2)], queue_limit=10)
        assert transaction.jobs.count_queued_runs() == 10


def test_a_run_that_is_over_before_it_began_is_not_handed_out(database: Database) -> None:
    report = ended(crashed("x").report).report
    with database.write() as transaction:
        bad, good = transaction.jobs.submit([new_run("bad", report=report), new_run("good")])
    assert claim(database, register(database), 5) == (good,)
    with database.read() as transaction:
        stored = transaction.jobs.report(bad)
    assert stored is not None
    assert stored.run_id == bad


def test_two_servers_never_get_the_same_run(database: Database) -> None:
    runs = submit(database, 120, priority=Priority.CI)
    taken: list[str] = []

    def server() -> None:
        # A connection pool of its own, as in another process.
        own = open_database(str(database.engine.url))
        owner = register(own)
        while got := claim(own, owner, 3):
            taken.extend(got)
            finish(own, owner, *(finished(run) for run in got))
        own.close()

    threads = [threading.Thread(target=server) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(taken) == sorted(runs)
    with database.read() as transaction:
        page = transaction.jobs.page(JobFilter(statuses=frozenset({RunStatus.FINISHED})), limit=500)
    assert len(page.items) == 120


def test_the_counts_stay_right(database: Database, tmp_path: object) -> None:
    runs = submit(database, 6, priority=Priority.CI)
    owner = register(database)
    claim(database, owner, 4)
    finish(database, owner, lost(runs[0]), finished(runs[1]), crashed(runs[2]))
    with database.write() as transaction:
        transaction.jobs.cancel(runs[5])
        transaction.queue.release(owner, [runs[3]])
    folder = TraceFolder(tmp_path / "traces")  # type: ignore[operator] # pytest's own path
    assert list(verify(database, folder)) == []
