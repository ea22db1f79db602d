"""A real service on PostgreSQL: killed in the middle of a batch, dumped and restored."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from sqlalchemy import make_url

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunStatus
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.store.database import open_database
from drivora_service.store.migration import newest_revision
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify
from tests.command_process import begin
from tests.forked_service import forked_service, killed_service
from tests.postgresql_server import PostgresqlServer

RUNS, SIMULATIONS = 24, 40
CAMPAIGN = {
    "name": "tee",
    "tester": {"name": "avfuzzer"},
    "agent": {"name": "idm"},
    "scenario": SCENARIO,
    "oracles": ["collision", "discomfort"],
    "budget": {"simulations": SIMULATIONS},
    "seed": 3,
}
_LONGEST_S = 240.0


@pytest.fixture
def url(postgresql: PostgresqlServer, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The address of an empty database, which services and commands get by their environment."""
    made = postgresql.create(migrated=False)
    monkeypatch.setenv("DRIVORA_DATABASE_URL", made)
    yield made
    postgresql.drop(made)


def batch_lines() -> str:
    """Returns short drives."""
    network = NetworkCatalogue(shipped_networks()).get("tee-town")
    seeds = generate_seeds(network, count=20, min_length=60, max_length=150, seed=4, agent="idm")
    documents = [json.loads(document_text(seed)) for seed in seeds]
    return "\n".join(json.dumps(documents[n % 20] | {"seed": n}) for n in range(RUNS))


@pytest.mark.slow(seconds=30)
def test_a_killed_service_loses_nothing_and_its_dump_is_restored(
    postgresql: PostgresqlServer, url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = tmp_path / "data"
    with killed_service(data) as (_, address), httpx.Client(timeout=60.0) as client:
        answer = client.post(f"{address}/api/v1/campaigns", json=CAMPAIGN)
        campaign = f"/campaigns/{answer.raise_for_status().json()['id']}"
        # The runs of the batch come first: most of the campaign is still to come when it is killed.
        until(client, f"{address}/api/v1{campaign}", lambda one: one["counts"]["evaluations"] >= 8)
        answer = client.post(
            f"{address}/api/v1/batches",
            content=batch_lines(),
            headers={"Content-Type": "application/x-ndjson"},
        )
        batch = answer.raise_for_status().json()["batch"]["id"]
        wait_for(client, f"{address}/api/v1/batches/{batch}", done=8)
        told = client.get(f"{address}/api/v1{campaign}").raise_for_status().json()
        assert told["state"] == "running"
    assert not (data / "drivora.sqlite3").exists()
    with (
        forked_service(data, workers=2) as address,
        httpx.Client(base_url=f"{address}/api/v1", timeout=60.0) as client,
    ):
        wait_for(client, f"/batches/{batch}", done=RUNS)
        counts = client.get(f"/batches/{batch}").json()["counts"]
        first = client.get("/runs", params={"batch": batch, "limit": 1}).raise_for_status()
        ended = until(client, campaign, lambda one: one["state"] != "running")
    assert sum(counts.values()) == RUNS
    assert counts[RunStatus.FINISHED] == RUNS
    assert first.json()["items"][0]["status"] == RunStatus.FINISHED
    assert (ended["state"], ended["counts"]["evaluations"]) == ("finished", SIMULATIONS)
    assert contradictions(url, data) == []

    dump = tmp_path / "drivora.dump"
    name = make_url(url).database or ""
    tool(postgresql, "pg_dump", "--format=custom", f"--file={dump}", name)
    restored_url = postgresql.create(migrated=False)
    restored = make_url(restored_url).database or ""
    tool(postgresql, "pg_restore", "--no-owner", f"--dbname={restored}", str(dump))
    copy = tmp_path / "copy"
    for folder in ("traces", "campaigns"):
        if (data / folder).exists():
            shutil.copytree(data / folder, copy / folder)
    assert contradictions(restored_url, copy) == []
    monkeypatch.setenv("DRIVORA_DATABASE_URL", restored_url)
    with (
        forked_service(copy, workers=1) as address,
        httpx.Client(base_url=f"{address}/api/v1", timeout=60.0) as client,
    ):
        assert client.get(f"/batches/{batch}").raise_for_status().json()["counts"] == counts
        assert client.get(campaign).raise_for_status().json()["counts"] == ended["counts"]
    postgresql.drop(restored_url)


@pytest.mark.slow
def test_commands_about_the_file_name_the_tools_of_postgresql(url: str, tmp_path: Path) -> None:
    assert command(tmp_path, "migrate") == (0, f"the database has schema {newest_revision()}\n")
    refused, message = command(tmp_path, "backup", "copy")
    assert (refused, "pg_dump" in message) == (3, True)
    refused, message = command(tmp_path, "prune", "--older-than", "1", "--compact")
    assert (refused, "VACUUM FULL" in message) == (3, True)
    assert command(tmp_path, "verify") == (0, "0 contradictions\n")


def command(folder: Path, *arguments: str) -> tuple[int, str]:
    """Runs ``drivora store``; returns its exit code and what it printed."""
    printed = folder / "printed"
    printed.write_bytes(b"")
    begun = begin(
        "store",
        *arguments,
        "--data-dir",
        folder / "data",
        folder=folder,
        environment=dict(os.environ),
        out=printed,
        err=printed,
    )
    return begun.wait(120.0), printed.read_text()


def until(
    client: httpx.Client, address: str, is_wanted: Callable[[dict[str, Any]], bool]
) -> dict[str, Any]:
    """Waits until what an address answers is as wanted, and returns it."""
    deadline = time.monotonic() + _LONGEST_S
    while True:
        found: dict[str, Any] = client.get(address).raise_for_status().json()
        if is_wanted(found):
            return found
        assert time.monotonic() < deadline, found
        time.sleep(0.2)


def wait_for(client: httpx.Client, batch: str, *, done: int) -> None:
    """Waits until a number of runs of a batch have ended."""
    deadline = time.monotonic() + _LONGEST_S
    while True:
        counts = client.get(batch).raise_for_status().json()["counts"]
        left = counts.get(RunStatus.QUEUED, 0) + counts.get(RunStatus.RUNNING, 0)
        if RUNS - left >= done:
            return
        assert time.monotonic() < deadline, counts
        time.sleep(0.1)


def contradictions(url: str, data: Path) -> list[object]:
    """Returns what contradicts itself in a store."""
    database = open_database(url)
    found: list[object] = list(verify(database, TraceFolder(data / "traces")))
    database.close()
    return found


def tool(server: PostgresqlServer, program: str, *options: str) -> None:
    """Runs a tool of the server's package."""
    connection = {"PGHOST": str(server.folder), "PGUSER": "postgres"}
    done = subprocess.run(
        [server.programs / program, *options],
        env={**os.environ, **connection},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
