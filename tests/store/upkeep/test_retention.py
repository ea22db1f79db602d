"""Retention times, and writers that need not wait for the removal."""

from __future__ import annotations

import sqlite3
import threading
import time
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import text

from drivora_service.execution.housekeeping import Housekeeping
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignState, Confirmation
from drivora_service.store.database import Database
from drivora_service.store.runs.run_records import Priority
from drivora_service.store.traces.trace_folders import CampaignTraces, TraceFolder, run_ids
from drivora_service.store.upkeep.free_space import return_free_space, rewrite_database
from drivora_service.store.upkeep.pruning import prune
from drivora_service.store.upkeep.retention import Retention, retain
from drivora_service.store.upkeep.store_verification import verify
from tests.store.campaigns.test_campaign_repository import append, create, evaluation
from tests.store.samples import (
    claim,
    ended,
    finish,
    finished,
    new_minimization,
    new_run,
    only_sqlite,
    register,
    slow_on_postgresql,
    submit,
)

NOW = datetime.now(UTC) + timedelta(days=30)


@pytest.fixture
def traces(tmp_path: Path) -> TraceFolder:
    return TraceFolder(tmp_path / "data" / "traces")


@pytest.fixture
def campaign_traces(tmp_path: Path) -> CampaignTraces:
    return CampaignTraces(tmp_path / "data" / "campaigns")


@pytest.fixture
def runs(database: Database, traces: TraceFolder) -> tuple[str, ...]:
    """One passed run, one with a violation, one with a failed agent, one queued."""
    ids = submit(database, 4, priority=Priority.CI)
    owner = register(database)
    claim(database, owner, 3)
    for run_id in ids[:3]:
        Path(traces.prepare(run_id)).write_bytes(b"trace")
    failure = RunFailure(cause="agent_raised", message="no")
    report = RunReport(
        run_id=ids[2], status=RunStatus.AGENT_FAILED, failure=failure, trace_sha256="t"
    )
    finish(
        database,
        owner,
        finished(ids[0], trace="t"),
        finished(ids[1], "collision", trace="t"),
        ended(report),
    )
    return ids


def left(database: Database, traces: TraceFolder) -> tuple[set[str], set[str]]:
    """Returns the existing runs and traces."""
    assert list(verify(database, traces)) == []
    with database.read() as transaction:
        jobs = transaction.jobs.page(limit=500).items
    return {job.id for job in jobs}, set(run_ids(traces))


def test_everything_is_kept_by_default(
    database: Database,
    traces: TraceFolder,
    campaign_traces: CampaignTraces,
    runs: tuple[str, ...],
) -> None:
    retain(database, traces, campaign_traces, Retention(), now=NOW)
    assert left(database, traces) == (set(runs), set(runs[:3]))


@pytest.mark.parametrize(
    ("retention", "kept_runs", "kept_traces"),
    [
        (Retention(passed_traces=timedelta(days=7)), (0, 1, 2, 3), (1, 2)),
        (Retention(passed_runs=timedelta(days=7)), (1, 2, 3), (1, 2)),
        (Retention(passed_runs=timedelta(days=90)), (0, 1, 2, 3), (0, 1, 2)),
        (Retention(failing_traces=timedelta(days=7)), (0, 1, 2, 3), (0,)),
        (Retention(failing_runs=timedelta(days=7)), (0, 3), (0,)),
        (
            Retention(passed_runs=timedelta(days=7), failing_traces=timedelta(days=7)),
            (1, 2, 3),
            (),
        ),
    ],
)
def test_failing_runs_are_kept_for_longer(
    database: Database,
    traces: TraceFolder,
    campaign_traces: CampaignTraces,
    runs: tuple[str, ...],
    retention: Retention,
    kept_runs: tuple[int, ...],
    kept_traces: tuple[int, ...],
) -> None:
    retain(database, traces, campaign_traces, retention, now=NOW)
    assert left(database, traces) == (
        {runs[place] for place in kept_runs},
        {runs[place] for place in kept_traces},
    )


def test_runs_of_a_campaign_that_is_not_over_stay(
    database: Database, traces: TraceFolder, campaign_traces: CampaignTraces
) -> None:
    campaign_id = create(database)
    with database.write() as transaction:
        batch_id = transaction.campaign_runs.open(campaign_id)
        transaction.campaigns.begin(campaign_id)
        (run_id,) = transaction.jobs.submit([new_run()], batch_id=batch_id)
    owner = register(database)
    claim(database, owner, 1)
    finish(database, owner, finished(run_id))
    retention = Retention(passed_runs=timedelta(days=1))
    retain(database, traces, campaign_traces, retention, now=NOW)
    assert left(database, traces) == ({run_id}, set())
    with database.write() as transaction:
        transaction.campaigns.end(campaign_id, CampaignState.FINISHED)
    retain(database, traces, campaign_traces, retention, now=NOW)
    assert left(database, traces) == (set(), set())


def test_runs_of_a_minimization_that_goes_on_stay(
    database: Database, traces: TraceFolder, campaign_traces: CampaignTraces
) -> None:
    with database.write() as transaction:
        minimization = transaction.minimizations.open(new_minimization())
        batch_id = transaction.minimizations.get(minimization).batch_id
        transaction.campaign_runs.put(batch_id, new_run(run_id="run-0"))
    owner = register(database)
    claim(database, owner, 1)
    finish(database, owner, finished("run-0"))
    retention = Retention(passed_runs=timedelta(days=1))
    retain(database, traces, campaign_traces, retention, now=NOW)
    assert left(database, traces) == ({"run-0"}, set())
    with database.write() as transaction:
        transaction.minimizations.cancel(minimization)
    retain(database, traces, campaign_traces, retention, now=NOW)
    assert left(database, traces) == (set(), set())


@pytest.mark.parametrize(
    ("oracles", "groups", "kept"),
    [
        (("collision",) * 4, (0, 0, 1, 1), (0, 2)),
        # Groups are numbered from 0 within each oracle.
        (
            ("collision", "collision", "off_road", "off_road", "off_road"),
            (0, 1, 0, 1, 1),
            (0, 1, 2, 3),
        ),
        (("collision", "off_road", "off_road"), (None, None, None), (0, 1)),
    ],
)
def test_of_the_failures_of_a_campaign_the_first_of_each_kind_and_group_keeps_its_trace(
    database: Database,
    traces: TraceFolder,
    campaign_traces: CampaignTraces,
    oracles: tuple[str, ...],
    groups: tuple[int | None, ...],
    kept: tuple[int, ...],
) -> None:
    campaign_id = create(database)
    records = [evaluation(n, violated=(True,), oracle=name) for n, name in enumerate(oracles)]
    append(database, campaign_id, *records)
    campaign_traces.path(campaign_id, "any").parent.mkdir(parents=True)
    names = [f"{number:06d}.trace.parquet" for number in range(len(oracles))]
    with database.write() as transaction:
        for number, name in enumerate(names):
            campaign_traces.path(campaign_id, name).write_text("trace")
            transaction.evaluations.confirm(campaign_id, number, Confirmation.CONFIRMED, trace=name)
        numbered = {(number, 0): group for number, group in enumerate(groups) if group is not None}
        transaction.evaluations.group(campaign_id, numbered)
        transaction.campaigns.end(campaign_id, CampaignState.FINISHED)
    campaign_traces.path(campaign_id, "left-by-a-kill.parquet").write_text("trace")
    retain(
        database,
        traces,
        campaign_traces,
        Retention(campaign_traces=timedelta(days=7)),
        now=NOW,
    )
    files = set(campaign_traces.names(campaign_id))
    assert files == {names[number] for number in kept}
    assert list(verify(database, traces, campaign_traces=campaign_traces)) == []


def test_files_that_a_kill_left_behind_go_with_the_next_pass(
    database: Database, traces: TraceFolder, runs: tuple[str, ...]
) -> None:
    # As after a kill between the rows and the files.
    with database.write() as transaction:
        transaction.session.execute(text("UPDATE runs SET trace_sha256 = '' WHERE seq = 1"))
    assert {finding.kind for finding in verify(database, traces)} == {"trace_without_run"}
    pruned = prune(database, traces, ended_before=NOW, only_traces=True)
    assert pruned.traces == 3
    assert left(database, traces) == (set(runs), set())


@slow_on_postgresql
def test_others_write_while_thousands_of_runs_are_removed(
    database: Database, traces: TraceFolder
) -> None:
    for _ in range(3):
        submit(database, 300, priority=Priority.CI)
        owner = register(database)
        finish(database, owner, *map(finished, claim(database, owner, 300)))
    held: list[float] = []
    over = threading.Event()

    def write() -> None:
        while not over.is_set():
            with database.write() as transaction:
                waited = time.perf_counter()
                transaction.session.execute(text("UPDATE batches SET served = served + 1"))
            held.append(time.perf_counter() - waited)

    writer = threading.Thread(target=write)
    writer.start()
    pruned = prune(database, traces, ended_before=NOW)
    over.set()
    writer.join()
    assert pruned.runs == 900
    # The writer has had its turn between the chunks, which were several.
    assert len(held) >= 10
    assert list(verify(database, traces)) == []


@only_sqlite
def test_the_file_becomes_shorter(database: Database, traces: TraceFolder) -> None:
    path = Path(str(database.engine.url.database))
    with database.write() as transaction:
        transaction.jobs.submit([new_run(f"{n}" + "x" * 50_000) for n in range(80)])
        job_ids = [job.id for job in transaction.jobs.page(limit=80).items]
        for job_id in job_ids:
            transaction.jobs.cancel(job_id)
    checkpoint(path)
    before = path.stat().st_size
    prune(database, traces, ended_before=NOW)
    checkpoint(path)
    assert path.stat().st_size < before / 4
    assert return_free_space(database) == 0


@only_sqlite
def test_an_old_file_is_rewritten_so_that_it_can_become_shorter(database: Database) -> None:
    with closing(database.engine.raw_connection()) as connection:
        for statement in ("PRAGMA auto_vacuum = NONE", "VACUUM"):
            connection.cursor().execute(statement)
    assert return_free_space(database) == 0
    rewrite_database(database)
    with database.engine.connect() as connection:
        assert connection.scalar(text("PRAGMA auto_vacuum")) == 2


def test_a_service_removes_expired_runs_automatically(
    database: Database,
    traces: TraceFolder,
    campaign_traces: CampaignTraces,
    runs: tuple[str, ...],
) -> None:
    retention = Retention(passed_runs=timedelta(seconds=0))
    housekeeping = Housekeeping(database, traces, campaign_traces, retention, every_s=0.05)
    housekeeping.start()
    deadline = time.monotonic() + 30
    while runs[0] in run_ids(traces) and time.monotonic() < deadline:
        time.sleep(0.02)
    housekeeping.stop()
    assert left(database, traces)[0] == set(runs[1:])


def checkpoint(path: Path) -> None:
    """Writes everything into the file itself."""
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
