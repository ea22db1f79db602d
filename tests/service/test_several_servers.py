"""Several servers on one database and one data folder, of which some are killed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from benchmarks.several_servers import Plan, measure
from drivora_service.store.database import open_database
from drivora_service.store.traces import TraceFolder
from drivora_service.store.verification import verify
from tests.postgresql_server import PostgresqlServer


@pytest.mark.slow(seconds=60)
def test_what_killed_servers_leave_is_done_by_the_others_and_judged_once(
    postgresql: PostgresqlServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # `measure` sets it.
    monkeypatch.setenv("DRIVORA_DATABASE_URL", os.environ.get("DRIVORA_DATABASE_URL", ""))
    url = postgresql.create(migrated=False)
    plan = Plan(runs=300, batch=100, simulations=60, kill_every_s=6.0, down_s=4.0)
    outcome = measure(url, tmp_path, plan)
    database = open_database(url)
    contradictions = list(verify(database, TraceFolder(tmp_path / "traces")))
    database.close()
    assert outcome.is_clean, outcome
    assert outcome.kills >= 2
    assert outcome.interrupted >= 1
    assert outcome.evaluations == plan.simulations
    assert contradictions == []
    postgresql.drop(url)
