"""Pages of the database are overwritten, and its write-ahead log is lost."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import sqlite3
import subprocess
import sys
import time

import httpx
import pytest

from tests.damaged_files import overwrite_bytes, overwrite_page, page_of
from tests.faults.conftest import Judge
from tests.faults.service_under_test import ROOT, Service
from tests.faults.work import good_runs

NAME = "drivora.sqlite3"
QUIET_S = 3.0
"""Seconds with a known damage and many requests, during which the log must not grow."""


def command(service: Service, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs a command on the data folder of a service."""
    return subprocess.run(
        [sys.executable, "-m", "drivora_service.cli", *arguments, "--data-dir", str(service.data)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        cwd=service.folder,
        env=os.environ | {"PYTHONPATH": f"{service.site}:{ROOT}"},
    )


def refused_start(service: Service) -> str:
    """Starts a server that must refuse to serve; returns what it printed."""
    before = len(service.log.read_text())
    service.launch()
    assert service.process is not None
    assert service.process.wait(120.0) == 3, service.log_tail()
    service.process = None
    return service.log.read_text()[before:]


def damage_until_noticed(service: Service, offset: int, size: int) -> httpx.Response:
    """Overwrites a page again and again: the service may write it anew from its memory."""
    file = service.data / NAME
    until = time.monotonic() + 30.0
    while time.monotonic() < until:
        with contextlib.suppress(sqlite3.Error), contextlib.closing(sqlite3.connect(file)) as other:
            other.execute("PRAGMA wal_checkpoint").fetchall()
        overwrite_bytes(file, offset, size)
        with service.client() as client:
            answer = client.post("/jobs", json=json.loads(good_runs(1)[0].document))
            assert answer.status_code in (202, 503), answer.text
        ready = httpx.get(f"{service.url}/readyz", timeout=5.0)
        if ready.status_code == 503:
            return ready
        time.sleep(0.1)
    raise AssertionError(f"a damaged page was not noticed: {service.log_tail()}")


@pytest.mark.parametrize("name", ["runs", "ix_runs_queued"])
def test_a_page_overwritten_while_runs_wait(
    own_service: Service, check: Judge, name: str, trial: int
) -> None:
    """It is reported everywhere and once in the log; the advice restores everything."""
    service = own_service
    service.start()
    work = service.post(good_runs(12))
    service.wait_until_ended(work, 2)
    backup = service.folder / "backup"
    assert command(service, "store", "backup", str(backup)).returncode == 0
    before = len(service.log.read_text())
    page = page_of(service.data / NAME, name)
    ready = damage_until_noticed(service, *page)
    until, statuses = time.monotonic() + QUIET_S, set()
    with service.client() as client:
        while time.monotonic() < until:
            refused = client.post("/jobs", json=json.loads(good_runs(1)[0].document))
            paths = ("/runs", "/runs?status=queued", "/workers", f"/batches/{work.batch}")
            statuses |= {client.get(path).status_code for path in paths}
            cancelled = client.post(f"/batches/{work.batch}:cancel")
    metrics = httpx.get(f"{service.url}/metrics", timeout=5.0)
    told = [line for line in service.log.read_text()[before:].splitlines() if line.strip()]
    service.stop()
    # The end may have written the page anew as well.
    overwrite_page(service.data / NAME, name)
    damaged_start = refused_start(service)
    verified = command(service, "store", "verify")
    ran = command(service, "runs", "list")
    # What the message says.
    for end in ("", "-wal", "-shm"):
        (service.data / f"{NAME}{end}").unlink(missing_ok=True)
    shutil.copyfile(backup / NAME, service.data / NAME)
    service.start()
    check(service, work)

    checks = {one["name"]: one for one in ready.json()["checks"]}
    assert not checks["database"]["ok"]
    details = (checks["database"]["detail"], refused.json()["detail"])
    # A command that needs no damaged page works.
    failed = [ran.stderr] if ran.returncode else []
    for message in (*details, damaged_start, verified.stderr, *failed):
        assert "Traceback" not in message
        assert f"`cp BACKUP/drivora.sqlite3 {service.data / NAME}`" in message
    assert (refused.status_code, cancelled.status_code) == (503, 503)
    assert refused.headers["Content-Type"] == "application/problem+json"
    assert int(refused.headers["Retry-After"]) > 0
    assert statuses <= {200, 503}
    assert metrics.is_success
    assert 'drivora_fault{check="database"} 1.0' in metrics.text
    assert len(told) == 1, told
    assert "database_damaged" in told[0]
    assert (verified.returncode, ran.returncode) == (1, 3 if name == "runs" else 0)


def test_a_lost_write_ahead_log(own_service: Service, check: Judge, trial: int) -> None:
    """An empty database beside traces is refused by all; with its log, everything is back."""
    service = own_service
    service.start()
    work = service.post(good_runs(4))
    service.wait_until_ended(work, 4)
    service.kill()
    log = service.data / f"{NAME}-wal"
    kept = log.rename(service.folder / "kept-wal")
    traces = sorted(service.data.glob("traces/**/*.parquet"))
    if len(service.query("SELECT id FROM runs")) > 0:
        pytest.skip("a checkpoint came before the kill")
    log.unlink(missing_ok=True)
    refusal = refused_start(service)
    verified = command(service, "store", "verify")
    pruned = command(service, "store", "prune", "--older-than", "0")
    ran = command(service, "runs", "list")
    left = sorted(service.data.glob("traces/**/*.parquet"))
    for end in ("-wal", "-shm"):
        (service.data / f"{NAME}{end}").unlink(missing_ok=True)
    kept.rename(log)
    service.start()
    check(service, work)

    assert traces
    assert left == traces
    assert verified.returncode == 1, verified
    assert "1 contradictions" in verified.stdout
    assert "prune" not in verified.stderr
    assert (pruned.returncode, ran.returncode) == (3, 3)
    for message in (refusal, verified.stderr, pruned.stderr, ran.stderr):
        assert f"holds no run, but traces of runs are in {service.data / 'traces'}" in message
        assert "put the log back first" in message
        assert "Traceback" not in message
