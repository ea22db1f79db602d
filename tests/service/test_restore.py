"""The drill of docs/how-to/operate-the-service.md: a destroyed data folder is fully restored."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import pytest

from drivora_service.cli.application.service_process import run_service
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds

RUNS = 6


def drivora(*arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "drivora_service.cli", *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


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
    with run_service(data, workers=2) as url:
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
        drivora("store", "backup", str(backup), "--data-dir", str(data))
    assert len(before) == RUNS
    traces = {path.name: path.read_bytes() for path in (data / "traces").rglob("*.parquet")}
    assert len(traces) == RUNS

    shutil.rmtree(data)
    shutil.copytree(backup, data)
    data.chmod(0o700)
    assert "0 contradictions" in drivora("store", "verify", "--hashes", "--data-dir", str(data))
    with (
        run_service(data, workers=1) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client,
    ):
        assert runs_of(client) == before
        for run_id in before:
            answer = client.get(f"/runs/{run_id}/observations?first=0&last=0")
            assert answer.raise_for_status().text.startswith('{"step":0')
    restored = {path.name: path.read_bytes() for path in (data / "traces").rglob("*.parquet")}
    assert restored == traces
