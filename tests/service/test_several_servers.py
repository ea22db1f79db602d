"""Several servers on one database, of which some are killed, or hang."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from benchmarks.several_servers import Plan, measure
from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.store.database import open_database
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify
from tests.command_process import Begun, begin
from tests.faults import processes
from tests.forked_service import begin_service, forked_service, wait_until_ready
from tests.postgresql_server import PostgresqlServer

_LONGEST_S = 120.0


@pytest.mark.slow(seconds=25)
def test_what_killed_servers_leave_is_done_by_the_others_and_judged_once(
    postgresql: PostgresqlServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # `measure` sets it.
    monkeypatch.setenv("DRIVORA_DATABASE_URL", os.environ.get("DRIVORA_DATABASE_URL", ""))
    url = postgresql.create(migrated=False)
    plan = Plan(runs=90, batch=30, simulations=20, kill_every_s=1.5, most_kills=3, down_s=2.0)
    outcome = measure(url, tmp_path, plan, begun)
    database = open_database(url)
    contradictions = list(verify(database, TraceFolder(tmp_path / "traces")))
    database.close()
    assert outcome.is_clean, outcome
    assert outcome.kills >= 2
    assert outcome.interrupted >= 1
    assert outcome.evaluations == plan.simulations
    assert contradictions == []
    postgresql.drop(url)


@pytest.mark.slow(seconds=60)
def test_a_late_trace_of_a_server_that_hung_is_not_that_of_the_run(
    postgresql: PostgresqlServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = postgresql.create()
    monkeypatch.setenv("DRIVORA_DATABASE_URL", url)
    traces = TraceFolder(tmp_path / "shared" / "traces")
    traces.root.parent.mkdir()
    monkeypatch.setenv("DRIVORA_TRACES_URL", f"file://{traces.root.parent}")
    with service_that_hangs(tmp_path / "one") as (address, server, worker):
        # It has the run, and nothing becomes of it.
        worker.suspend()
        job = posted(address)
        run_until(address, job, "running")
        wait_until(lambda: job in httpx.get(f"{address}/api/v1/workers").text)
        server.suspend()
        with forked_service(tmp_path / "other", workers=1) as other:
            judged = run_until(other, job, "finished")
        late = Path(traces.address(job))
        assert not late.exists()
        assert trace_sha256(read_trace(traces.path(job, 2))) == judged["trace_sha256"]
        worker.resume()
        wait_until(late.is_file)
        late.write_bytes(b"what a worker writes late may differ")
        assert trace_sha256(read_trace(traces.path(job, 2))) == judged["trace_sha256"]
        server.resume()
        # The server that was taken for dead goes on, and its late report changes nothing.
        assert run_until(address, posted(address), "finished")["attempts"] == 1
        assert run_until(address, job, "finished") == judged
    assert judged["attempts"] == 2
    database = open_database(url)
    assert (
        list(verify(database, traces, hash_trace=lambda path: trace_sha256(read_trace(path)))) == []
    )
    database.close()
    assert traces.remove(job) > 0
    assert list(traces.root.rglob(f"{job}*")) == []
    postgresql.drop(url)


def begun(arguments: Sequence[str], environment: Mapping[str, str], log: Path) -> Begun:
    return begin(*arguments, folder=log.parent, environment=environment, out=log, err=log)


@contextmanager
def service_that_hangs(data: Path) -> Iterator[tuple[str, psutil.Process, psutil.Process]]:
    """Yields the address of a service with one worker, its process, and that of its worker."""
    begun = begin_service(data, workers=1)
    try:
        address = wait_until_ready(begun, data)
        (logs,) = data.rglob("workers")
        # One that still gets ready is given no run.
        wait_until(lambda: slot_states(address) == ["idle"])
        wait_until(lambda: len(processes.workers(logs)) == 1)
        yield address, psutil.Process(begun.process.pid), processes.workers(logs)[0]
    finally:
        begun.kill()


def slot_states(address: str) -> list[str]:
    """Returns what the workers of a service do."""
    answer = httpx.get(f"{address}/api/v1/workers").raise_for_status()
    return [slot["state"] for slot in answer.json()["slots"]]


def posted(address: str) -> str:
    """Posts a run; returns its id."""
    answer = httpx.post(f"{address}/api/v1/jobs", json=SCENARIO).raise_for_status()
    return str(answer.json()["id"])


def run_until(address: str, run_id: str, status: str) -> dict[str, Any]:
    """Waits until a run has a status; returns the run."""
    found: dict[str, Any] = {}

    def is_reached() -> bool:
        found.update(httpx.get(f"{address}/api/v1/jobs/{run_id}").raise_for_status().json())
        return bool(found["status"] == status)

    wait_until(is_reached)
    return found


def wait_until(is_so: Callable[[], bool]) -> None:
    """Waits until something is so."""
    deadline = time.monotonic() + _LONGEST_S
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.1)
