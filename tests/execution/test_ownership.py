from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

from drivora_service.execution.ownership import SILENCE_S, Ownership
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.report import RunStatus
from drivora_service.store.database import Database, open_database
from drivora_service.store.records import NewRun
from drivora_service.store.tables import OwnerRow


def running(database: Database, owner_id: str) -> str:
    with database.write() as transaction:
        run = NewRun(document="{}", scenario_sha256="s", town="town", agent="idm", label="")
        (run_id,) = transaction.jobs.submit([run])
        transaction.queue.claim(owner_id, 1, trace_path=str)
    return run_id


def status(database: Database, run_id: str) -> RunStatus:
    with database.read() as transaction:
        return transaction.jobs.get(run_id).status


def jump(database: Database, owner_id: str, by: timedelta) -> None:
    """Sets a heartbeat as the clock of its owner had it before that jumped."""
    with database.write() as transaction:
        owner = transaction.session.get_one(OwnerRow, owner_id)
        owner.heartbeat_at = datetime.now(UTC) - by


def test_a_clock_that_jumps_takes_no_lease_from_a_server_that_lives(tmp_path: Path) -> None:
    database = open_database(f"sqlite:///{tmp_path / 'shared.sqlite3'}")
    clock = [0.0]
    policy = RetryPolicy()
    other = Ownership(database, policy, exclusive=False)
    mine = Ownership(database, policy, exclusive=False, clock=lambda: clock[0])
    other.register()
    run_id = running(database, other.owner_id)
    jump(database, other.owner_id, timedelta(hours=1))
    mine.register()
    for _ in range(5):
        clock[0] += 0.9 * SILENCE_S
        jump(database, other.owner_id, timedelta(hours=1))
        mine.beat(())
    assert status(database, run_id) is RunStatus.RUNNING

    clock[0] += SILENCE_S
    mine.beat(())
    assert status(database, run_id) is RunStatus.QUEUED
    # It was only slow: from its next heartbeat on it owns what it claims.
    other.beat(())
    with database.read() as transaction:
        assert other.owner_id in transaction.workers.heartbeats(me=mine.owner_id)
    database.close()
