"""A service whose traces are in a storage of objects, and another one that reads them."""

from __future__ import annotations

import io
import json
import os
import time
from collections.abc import Iterator
from pathlib import Path

import fsspec
import httpx
import pyarrow.parquet as pq
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from tests.command_process import begin
from tests.forked_service import forked_service
from tests.object_storage import BUCKET, object_storage
from tests.postgresql_server import PostgresqlServer

_LONGEST_S = 120.0


@pytest.fixture
def storage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Address of the traces, which services and commands get by their environment."""
    url = f"s3://{BUCKET}/{tmp_path.name}"
    with object_storage() as environment:
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        monkeypatch.setenv("DRIVORA_TRACES_URL", url)
        yield url


@pytest.mark.slow(seconds=60)
def test_traces_are_written_read_and_removed_in_a_storage(
    postgresql: PostgresqlServer, storage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DRIVORA_DATABASE_URL", postgresql.create())
    with forked_service(tmp_path / "one", workers=1) as address:
        run_id = driven(address)
    assert not (tmp_path / "one" / "traces").exists()
    # Another machine: nothing but the database and the storage is shared.
    with (
        forked_service(tmp_path / "other", workers=1) as address,
        httpx.Client(base_url=f"{address}/api/v1", timeout=60.0) as client,
    ):
        run = client.get(f"/runs/{run_id}").raise_for_status().json()
        answer = client.get(
            f"/runs/{run_id}/observations", headers={"Accept": "application/vnd.apache.parquet"}
        ).raise_for_status()
    table = pq.read_table(io.BytesIO(answer.content))
    assert max(table.column("step").to_pylist()) == run["steps"] - 1
    data = tmp_path / "other"
    assert command(data, "verify", "--hashes") == (0, "0 contradictions\n")
    system = fsspec.filesystem("s3", endpoint_url=os.environ["FSSPEC_S3_ENDPOINT_URL"])
    (file,) = system.find(f"{storage.removeprefix('s3://')}/traces")
    system.pipe_file(file, b"damaged")
    code, told = command(data, "verify", "--hashes")
    assert (code, "damaged_trace" in told) == (1, True), told
    code, told = command(data, "prune", "--older-than", "0")
    assert (code, "1 traces" in told) == (0, True), told
    assert system.find(f"{storage.removeprefix('s3://')}/traces") == []


def driven(address: str) -> str:
    """Has a service drive a scenario; returns the id of the run once it has ended."""
    with httpx.Client(base_url=f"{address}/api/v1", timeout=60.0) as client:
        job = client.post("/jobs", json=SCENARIO).raise_for_status().json()["id"]
        deadline = time.monotonic() + _LONGEST_S
        while True:
            found = client.get(f"/jobs/{job}").raise_for_status().json()
            if found["status"] not in ("queued", "running"):
                assert found["status"] == "finished", json.dumps(found)
                return str(found["id"])
            assert time.monotonic() < deadline
            time.sleep(0.1)


def command(data: Path, *arguments: str) -> tuple[int, str]:
    """Runs ``drivora store``; returns its exit code and what it printed."""
    printed = data / "printed"
    printed.write_bytes(b"")
    begun = begin(
        "store",
        *arguments,
        "--data-dir",
        data,
        folder=data,
        environment=dict(os.environ),
        out=printed,
        err=printed,
    )
    return begun.wait(_LONGEST_S), printed.read_text()
