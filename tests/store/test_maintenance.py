from __future__ import annotations

import hashlib
import sqlite3
import threading
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import text

from drivora_service.errors import Conflict, StoreError
from drivora_service.store.database import Database, open_database
from drivora_service.store.locks.server_lock import ServerLock
from drivora_service.store.runs.run_records import Priority
from drivora_service.store.traces.trace_folders import TraceFolder, run_ids
from drivora_service.store.upkeep.backup import DATABASE_NAME, back_up
from drivora_service.store.upkeep.pruning import prune
from drivora_service.store.upkeep.store_verification import verify
from tests.store.samples import claim, finish, finished, new_run, only_sqlite, register, submit


def file_hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.fixture
def traces(tmp_path: Path) -> TraceFolder:
    return TraceFolder(tmp_path / "data" / "traces")


@pytest.fixture
def runs(database: Database, traces: TraceFolder) -> tuple[str, ...]:
    """Three finished runs with traces, the first one violated, and one that is queued."""
    ids = submit(database, 4, priority=Priority.CI)
    owner = register(database)
    for number, run_id in enumerate(claim(database, owner, 3)):
        Path(traces.prepare(run_id)).write_bytes(run_id.encode())
        violated = ["collision"] if number == 0 else []
        finish(database, owner, finished(run_id, *violated, trace=file_hash(traces.path(run_id))))
    return ids


def kinds(database: Database, traces: TraceFolder) -> set[str]:
    return {finding.kind for finding in verify(database, traces, hash_trace=file_hash)}


def test_every_contradiction_is_found(
    database: Database, traces: TraceFolder, runs: tuple[str, ...]
) -> None:
    assert kinds(database, traces) == set()
    traces.path(runs[0]).unlink()
    traces.path(runs[1]).write_bytes(b"damaged")
    Path(traces.prepare("0123456789ab")).write_bytes(b"stray")
    with database.engine.begin() as connection:
        connection.execute(text("DELETE FROM reports WHERE run_seq = 3"))
        connection.execute(text("INSERT INTO reports (run_seq, body) VALUES (4, '{}')"))
        connection.execute(text("UPDATE batches SET queued = 7"))
    assert kinds(database, traces) == {
        "missing_trace",
        "damaged_trace",
        "trace_without_run",
        "missing_report",
        "early_report",
        "wrong_count",
    }


@only_sqlite
def test_a_backup_is_a_data_folder(
    database: Database, traces: TraceFolder, runs: tuple[str, ...], tmp_path: Path
) -> None:
    backup = back_up(database, traces, tmp_path / "backup")
    assert (backup.runs, backup.traces, backup.missing_traces) == (4, 3, ())
    copy = open_database(f"sqlite:///{tmp_path / 'backup' / DATABASE_NAME}")
    assert kinds(copy, TraceFolder(tmp_path / "backup" / "traces")) == set()
    with copy.read() as transaction:
        report = transaction.jobs.report(runs[0])
    assert report is not None
    assert len(report.verdicts) == 2
    copy.close()
    with pytest.raises(StoreError, match="not empty"):
        back_up(database, traces, tmp_path / "backup")


@only_sqlite
def test_a_backup_is_one_view_while_others_write(
    database: Database, traces: TraceFolder, tmp_path: Path
) -> None:
    with database.write() as transaction:
        transaction.jobs.submit([new_run(f"{n}" + "x" * 100_000) for n in range(400)])
    path = str(database.engine.url.database)
    over = threading.Event()

    def write() -> None:
        # As another process would: over a connection that the backup knows nothing of.
        with closing(sqlite3.connect(path, timeout=30, isolation_level=None)) as connection:
            connection.execute("PRAGMA synchronous = OFF")
            while not over.is_set():
                connection.execute("UPDATE batches SET served = served + 1")

    done: list[int] = []
    writer = threading.Thread(target=write)
    copier = threading.Thread(
        target=lambda: done.append(back_up(database, traces, tmp_path / "backup").runs)
    )
    writer.start()
    copier.start()
    copier.join(20)
    while_others_wrote = list(done)
    over.set()
    writer.join()
    copier.join()
    assert while_others_wrote == [400]
    with closing(sqlite3.connect(tmp_path / "backup" / DATABASE_NAME)) as copy:
        assert copy.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def test_pruning_keeps_what_is_wanted_and_leaves_no_contradiction(
    database: Database, traces: TraceFolder, runs: tuple[str, ...]
) -> None:
    long_ago = datetime.now(UTC) - timedelta(days=1)
    soon = datetime.now(UTC) + timedelta(days=1)
    assert prune(database, traces, ended_before=long_ago).runs == 0
    pruned = prune(database, traces, ended_before=soon, keep_violated=True)
    assert (pruned.runs, pruned.traces, pruned.freed_bytes) == (2, 2, 48)
    assert kinds(database, traces) == set()
    with database.read() as transaction:
        left = {job.id for job in transaction.jobs.page().items}
        batch = transaction.batches.get(transaction.jobs.get(runs[0]).batch_id)
    assert left == {runs[0], runs[3]}
    assert batch.size == 2


def test_pruning_only_traces_keeps_the_runs(
    database: Database, traces: TraceFolder, runs: tuple[str, ...]
) -> None:
    soon = datetime.now(UTC) + timedelta(days=1)
    pruned = prune(database, traces, ended_before=soon, only_traces=True)
    assert (pruned.runs, pruned.traces) == (0, 3)
    assert list(run_ids(traces)) == []
    assert kinds(database, traces) == set()
    with database.read() as transaction:
        assert len(transaction.jobs.page().items) == 4
        assert transaction.jobs.get(runs[0]).trace_sha256 == ""


def test_a_data_folder_has_one_server(tmp_path: Path) -> None:
    lock = ServerLock(tmp_path)
    with pytest.raises(Conflict, match="already serves"):
        ServerLock(tmp_path)
    lock.release()
    ServerLock(tmp_path).release()
