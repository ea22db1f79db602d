"""What clients see while nothing can be stored."""

from __future__ import annotations

import sqlite3
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx

from tests.api.conftest import MakeOffline
from tests.damaged_files import overwrite_page

THREADS = 40
"""Those of the application; requests that wait for the database in all of them leave none."""


def test_a_locked_database_refuses_writes_in_time_and_goes_on_reading(
    make_offline: MakeOffline, tmp_path: Path, scenario: dict[str, Any]
) -> None:
    offline = make_offline(patience_s=2.0)
    url = str(offline.client.base_url)
    (posted,) = [offline.client.post("/api/v1/jobs", json=scenario)]
    assert posted.status_code == 202
    other = sqlite3.connect(tmp_path / "0.sqlite3", check_same_thread=False)
    other.execute("BEGIN IMMEDIATE")
    with ThreadPoolExecutor(2 * THREADS) as clients:
        answers = [
            clients.submit(httpx.post, f"{url}/api/v1/jobs", json=scenario, timeout=60)
            for _ in range(2 * THREADS)
        ]
        began = time.monotonic()
        read = httpx.get(f"{url}/api/v1/jobs", timeout=60)
        assert read.is_success, read.text
        assert len(read.json()["items"]) == 1
        refused = [answer.result() for answer in answers]
        assert time.monotonic() - began < 40
    assert {answer.status_code for answer in refused} == {503}
    for answer in refused:
        assert answer.headers["Content-Type"] == "application/problem+json"
        assert int(answer.headers["Retry-After"]) > 0
    other.rollback()
    other.close()
    assert offline.client.post("/api/v1/jobs", json=scenario).status_code == 202


def test_a_known_fault_refuses_what_would_be_stored_and_nothing_else(
    make_offline: MakeOffline, scenario: dict[str, Any]
) -> None:
    fault = [""]
    offline = make_offline(storage_fault=lambda: fault[0])
    client = offline.client
    job = client.post("/api/v1/jobs", json=scenario).json()["id"]
    fault[0] = "traces: no space is left"
    for path in ("jobs", "batches", "campaigns"):
        answer = client.post(f"/api/v1/{path}", json=scenario)
        assert (answer.status_code, answer.headers["Retry-After"]) == (503, "5")
        assert "traces: no space is left" in answer.json()["detail"]
    assert client.post("/api/v1/scenarios:validate", json=scenario).is_success
    assert client.get(f"/api/v1/jobs/{job}").is_success
    assert client.post(f"/api/v1/jobs/{job}:cancel").status_code == 202


def test_a_damaged_page_is_no_internal_error(
    make_offline: MakeOffline, scenario: dict[str, Any]
) -> None:
    """Requests that read or write it get 503, then all that write, and the others go on."""
    offline = make_offline()
    client, database = offline.client, offline.context.database
    assert client.post("/api/v1/jobs", json=scenario).status_code == 202
    assert database.file is not None
    database.checkpoint()
    database.engine.dispose()
    overwrite_page(database.file, "runs")
    for answer in (client.get("/api/v1/runs"), client.post("/api/v1/jobs", json=scenario)):
        assert answer.status_code == 503, answer.text
        assert answer.headers["Content-Type"] == "application/problem+json"
        assert int(answer.headers["Retry-After"]) > 0
        assert "`cp BACKUP/drivora.sqlite3 " in answer.json()["detail"]
    assert client.get("/api/v1/campaigns").is_success
    metrics = httpx.get(f"{client.base_url}/metrics")
    assert metrics.is_success
    assert "drivora_fault" in metrics.text


def test_health_needs_no_thread_and_no_database(make_offline: MakeOffline) -> None:
    offline = make_offline()
    url = str(offline.client.base_url)
    let_go = threading.Event()

    def busy() -> str:
        let_go.wait(60)
        return "busy"

    @offline.app.get("/api/v1/busy")
    def hold() -> str:
        return busy()

    with ThreadPoolExecutor(THREADS + 10) as clients:
        held = [
            clients.submit(httpx.get, f"{url}/api/v1/busy", timeout=90) for _ in range(THREADS + 10)
        ]
        time.sleep(1.0)
        try:
            with httpx.Client(base_url=url, timeout=30) as client:
                assert client.get("/healthz").json()["status"] == "ok"
                assert client.get("/readyz").status_code == 503
        finally:
            let_go.set()
        assert all(answer.result().is_success for answer in held)
