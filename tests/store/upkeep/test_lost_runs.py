"""Traces and folders of campaigns beside a database that knows nothing of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from drivora_service.errors import StoreDamaged
from drivora_service.store.database import Database
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.lost_runs import find_lost_runs, refuse_lost_runs
from drivora_service.store.upkeep.store_verification import verify
from tests.store.samples import submit


@pytest.fixture
def traces(tmp_path: Path) -> TraceFolder:
    return TraceFolder(tmp_path / "traces")


@pytest.fixture
def campaigns(tmp_path: Path) -> Path:
    return tmp_path / "campaigns"


def test_traces_without_any_run_are_lost_runs(
    database: Database, traces: TraceFolder, campaigns: Path
) -> None:
    refuse_lost_runs(database, traces, campaigns)
    Path(traces.prepare("0123456789ab")).write_bytes(b"a trace")
    with pytest.raises(StoreDamaged, match="holds no run, but traces of runs are in") as raised:
        refuse_lost_runs(database, traces, campaigns)
    message = str(raised.value)
    assert f"move {traces.root} away" in message
    assert ("put the log back first" if database.file else "DRIVORA_DATABASE_URL") in message
    (finding,) = verify(database, traces, campaigns=campaigns)
    assert (finding.kind, finding.message) == ("lost_runs", message)
    assert "prune" not in finding.message
    # One run is enough for the traces of others to be leftovers.
    submit(database, 1)
    refuse_lost_runs(database, traces, campaigns)
    (finding,) = verify(database, traces, campaigns=campaigns)
    assert finding.kind == "trace_without_run"


def test_folders_without_any_campaign_are_lost_campaigns(
    database: Database, traces: TraceFolder, campaigns: Path
) -> None:
    (campaigns / "0123456789ab").mkdir(parents=True)
    assert find_lost_runs(database, traces, campaigns) is None
    (campaigns / "0123456789ab" / "engine.log").write_text("it ran")
    lost = find_lost_runs(database, traces, campaigns)
    assert lost is not None
    assert lost.place == str(campaigns)
    assert "holds no campaign, but files of campaigns are in" in lost.message
