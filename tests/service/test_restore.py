"""The drill of docs/how-to/operate-the-service.md: a destroyed data folder is fully restored."""

from __future__ import annotations

import json
import os
import shutil
import time
from pathlib import Path
from typing import Any

import httpx
import pytest

from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds
from tests.command_process import begin
from tests.forked_service import forked_service

RUNS = 6


def drivora(folder: Path, *arguments: str) -> str:
    printed = folder / "printed"
    printed.write_bytes(b"")
    begun = begin(*arguments, folder=folder, environment=os.environ, out=printed, err=printed)
    assert begun.wait(300.0) == 0, printed.read_text()
    return printed.read_text()


def runs_of(client: httpx.Client) -> dict[str, dict[str, Any]]:
    """Every run with its verdicts and metrics, by id."""
    listed = client.get("/runs").raise_for_status().json()["items"]
    return {run["id"]: client.get(f"/runs/{run['id']}").json() for run in listed}


@pytest.mark.slow
def test_a_destroyed_data_folder_is_restored_from_its_backup(tmp_path: Path) -> None:
    network = NetworkCatalogue(shipped_networks()).get("tee-town")
    seeds = generate_seeds(network, count=RUNS, min_length=60, max_length=90, seed=8, agent="idm")
    lines = "\n".join(json.dumps(json.loads(document_text(seed))) for seed in seeds)
    data, backup = tmp_path / "data", tmp_path / "backup"
    with forked_service(data, workers=2) as url:
        with httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client:
            posted = client.post(
                "/batches", content=lines, headers={"Content-Type": "application/x-ndjson"}
            )
            batch = posted.raise_for_status().json()["batch"]["id"]
            deadline = time.monotonic() + 240.0
            while not client.get(f"/batches/{batch}").json()["done"]:
                assert time.monotonic() < deadline
                time.sleep(0.2)
            before = runs_of(client)
        # While the service runs.
        drivora(tmp_path, "store", "backup", str(backup), "--data-dir", str(data))
    assert len(before) == RUNS
    traces = {path.name: path.read_bytes() for path in (data / "traces").rglob("*.parquet")}
    assert len(traces) == RUNS

    shutil.rmtree(data)
    shutil.copytree(backup, data)
    data.chmod(0o700)
    told = drivora(tmp_path, "store", "verify", "--hashes", "--data-dir", str(data))
    assert "0 contradictions" in told
    with (
        forked_service(data, workers=1) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client,
    ):
        assert runs_of(client) == before
        for run_id in before:
            answer = client.get(f"/runs/{run_id}/observations?first=0&last=0")
            assert answer.raise_for_status().text.startswith('{"step":0')
    restored = {path.name: path.read_bytes() for path in (data / "traces").rglob("*.parquet")}
    assert restored == traces
