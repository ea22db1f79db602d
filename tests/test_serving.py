"""A service in a process of its own that is told to end while something runs."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.database import open_database


@contextmanager
def service(data: Path, *, drain_s: float) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Starts a service and gives its process and address once it is ready."""
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "drivora_service.cli",
            "serve",
            "--data-dir",
            str(data),
            "--port",
            "0",
        ],
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "DRIVORA_DRAIN_S": str(drain_s), "DRIVORA_WORKERS": "1"},
    )
    try:
        wait_until((data / "service.json").is_file)
        url = json.loads((data / "service.json").read_text())["url"]
        wait_until(lambda: ready(url))
        yield process, url
    finally:
        process.kill()
        process.communicate()


def ready(url: str) -> bool:
    try:
        return httpx.get(f"{url}/readyz", timeout=30).is_success
    except httpx.HTTPError:
        return False


def wait_until(condition: Callable[[], bool], seconds: float = 200.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def post(url: str, runs: int) -> httpx.Response:
    """Posts a batch of runs."""
    body = "\n".join(json.dumps({**SCENARIO, "seed": seed}) for seed in range(runs))
    headers = {"Content-Type": "application/x-ndjson"}
    return httpx.post(f"{url}/api/v1/batches", content=body, headers=headers, timeout=60)


def statuses(data: Path) -> Counter[RunStatus]:
    database = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
    try:
        with database.read() as transaction:
            return Counter(job.status for job in transaction.jobs.page(limit=1000).items)
    finally:
        database.close()


def test_the_first_signal_drains_and_the_second_ends_at_once(tmp_path: Path) -> None:
    with service(tmp_path, drain_s=100.0) as (process, url):
        # Holds the worker, so that there is something to wait for.
        worker = hold_a_worker(url, tmp_path)
        process.send_signal(signal.SIGTERM)
        wait_until(lambda: httpx.get(f"{url}/readyz", timeout=30).status_code == 503)
        checks = httpx.get(f"{url}/readyz", timeout=30).json()["checks"]
        assert [check["name"] for check in checks if not check["ok"]] == ["accepting"]
        assert httpx.get(f"{url}/healthz", timeout=30).is_success
        refused = post(url, 1)
        assert refused.status_code == 503
        assert refused.headers["Retry-After"] == "5"
        assert refused.headers["Content-Type"] == "application/problem+json"
        assert process.poll() is None
        process.send_signal(signal.SIGTERM)
        began = time.monotonic()
        _, err = process.communicate(timeout=60)
        assert time.monotonic() - began < 30
        assert process.returncode in (0, 3), err
        assert "Traceback" not in err
    assert not Path(f"/proc/{worker}").exists()
    assert set(statuses(tmp_path)) == {RunStatus.QUEUED}


def hold_a_worker(url: str, data: Path) -> int:
    """Stops the worker and posts runs, so that one runs on; returns the worker's process id."""
    found: list[int] = []

    def started() -> bool:
        database = open_database(f"sqlite:///{data / 'drivora.sqlite3'}")
        try:
            with database.read() as transaction:
                (owner,) = transaction.workers.living_owners()
        finally:
            database.close()
        # One that is still starting takes no run: what it was to get goes back at the first signal.
        found[:] = [slot.pid for slot in owner.slots if slot.pid and slot.phase != "starting"]
        return bool(found)

    wait_until(started)
    os.kill(found[0], signal.SIGSTOP)
    assert post(url, 3).status_code == 202
    wait_until(lambda: statuses(data)[RunStatus.RUNNING] > 0)
    return found[0]
