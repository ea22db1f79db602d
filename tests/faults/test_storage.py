"""Folders disappear, volumes fill up, another process locks the database."""

from __future__ import annotations

import contextlib
import json
import re
import shutil
import sqlite3
import statistics
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest

from drivora_service.networks.catalogue import shipped_networks
from tests.faults.conftest import Judge
from tests.faults.service_under_test import Service
from tests.faults.volumes import full, small_volume
from tests.faults.work import good_runs

FAULT_S = 4.0
"""Seconds that a fault lasts."""

LOCKED_S = 40.0
LINES_PER_FAULT = 12
"""Warnings and errors that the log may gain; a line a turn of a loop would be hundreds."""

_LINE = re.compile(r"^20\S+Z \[(?:warning|error|critical)", re.MULTILINE)
"""The beginning of a line that is no part of a traceback."""

Fault = Callable[[Service], contextlib.AbstractContextManager[None]]


def lines(service: Service) -> int:
    return len(_LINE.findall(service.log.read_text(errors="replace")))


def remove(folder: Path) -> None:
    """Removes a folder at one moment, whatever is written into it meanwhile."""
    aside = folder.rename(folder.with_name("removed"))
    shutil.rmtree(aside, ignore_errors=True)


@contextlib.contextmanager
def traces_removed(service: Service) -> Iterator[None]:
    remove(service.data / "traces")
    yield


@contextlib.contextmanager
def traces_are_a_file(service: Service) -> Iterator[None]:
    traces = service.data / "traces"
    traces.rename(traces.with_name("traces-aside"))
    traces.write_text("no folder")
    try:
        yield
    finally:
        traces.unlink(missing_ok=True)
        traces.with_name("traces-aside").rename(traces)


@contextlib.contextmanager
def workers_folder_removed(service: Service) -> Iterator[None]:
    found = service.workers()
    remove(service.data / "workers")
    for worker in found:
        worker.kill()
    yield


@pytest.mark.parametrize("fault", [traces_removed, traces_are_a_file, workers_folder_removed])
def test_a_folder_cannot_be_used(service: Service, check: Judge, fault: Fault, trial: int) -> None:
    work = service.post(good_runs(16))
    service.wait_until_ended(work, 3)
    before = lines(service)
    with fault(service):
        time.sleep(FAULT_S)
        told = lines(service) - before
        assert httpx.get(f"{service.url}/healthz", timeout=5.0).is_success
    check(service, work)
    assert told <= LINES_PER_FAULT, f"{told} lines in {FAULT_S:g} s: {service.log_tail()}"


def test_the_volume_of_traces_full(own_service: Service, check: Judge, trial: int) -> None:
    """The queue rests, new work is refused, and both go on by themselves."""
    service = own_service
    with small_volume(service.data / "traces", megabytes=16) as traces:
        try:
            service.start()
            work = service.post(good_runs(16))
            service.wait_until_ended(work, 2)
            before = lines(service)
            with full(traces):
                time.sleep(FAULT_S)
                told = lines(service) - before
                ready = httpx.get(f"{service.url}/readyz", timeout=5.0)
                with service.client() as client:
                    refused = client.post("/jobs", json=json.loads(good_runs(1)[0].document))
            check(service, work)
        finally:
            service.stop()
    assert ready.status_code == 503
    assert "traces" in ready.text
    assert refused.status_code == 503, refused.text
    assert int(refused.headers["Retry-After"]) > 0
    assert told <= LINES_PER_FAULT, f"{told} lines in {FAULT_S:g} s: {service.log_tail()}"


def test_the_volume_of_all_data_full(own_service: Service, check: Judge, trial: int) -> None:
    service = own_service
    with small_volume(service.data, megabytes=24):
        try:
            service.start()
            work = service.post(good_runs(16))
            service.wait_until_ended(work, 2)
            before = lines(service)
            with full(service.data):
                time.sleep(FAULT_S)
                told = lines(service) - before
                answer = httpx.get(f"{service.url}/healthz", timeout=5.0)
            check(service, work)
        finally:
            service.stop()
    assert answer.is_success
    assert told <= LINES_PER_FAULT, f"{told} lines in {FAULT_S:g} s: {service.log_tail()}"


def test_an_uploaded_network_that_does_not_fit(
    own_service: Service, check: Judge, trial: int
) -> None:
    """It is refused for now, leaves nothing, and costs no run."""
    service = own_service
    networks = service.data / "networks"
    address = "/networks?name=town&format=sumo"
    xml = {"Content-Type": "application/xml"}
    network = (shipped_networks() / "tee-town" / "tee-town.net.xml").read_bytes()
    with small_volume(networks, megabytes=8):
        try:
            service.start()
            work = service.post(good_runs(6))
            with service.client() as client:
                refused = client.post(address, content=network + bytes(24 << 20), headers=xml)
                left = list(networks.iterdir())
                taken = client.post(address, content=network, headers=xml)
            check(service, work)
        finally:
            service.stop()
    assert refused.status_code == 503, refused.text
    assert "No space left on device; nothing is kept" in refused.json()["detail"]
    assert left == []
    assert taken.status_code == 201, taken.text


def test_the_database_locked_by_another_process(service: Service, check: Judge, trial: int) -> None:
    """Reads go on, writes are refused in bounded time, runs wait."""
    work = service.post(good_runs(16))
    service.wait_until_ended(work, 3)
    before = lines(service)
    paths = ("/healthz", "/readyz", f"/api/v1/batches/{work.batch}")
    unlocked = [service.latency(path) for path in paths * 3]
    latencies = []
    with contextlib.closing(sqlite3.connect(service.data / "drivora.sqlite3")) as locker:
        locker.isolation_level = None
        locker.execute("PRAGMA busy_timeout = 10000")
        locker.execute("BEGIN EXCLUSIVE")
        begun = time.monotonic()
        with service.client() as client:
            answer = client.post("/jobs", json=json.loads(good_runs(1)[0].document))
        answered = time.monotonic() - begun
        while time.monotonic() - begun < LOCKED_S:
            latencies += [service.latency(path) for path in paths]
            time.sleep(1.0)
        locker.execute("ROLLBACK")
    told = lines(service) - before
    check(service, work)
    assert answer.status_code == 503, answer.text
    assert int(answer.headers["Retry-After"]) > 0
    assert answered < 30.0
    assert told <= LINES_PER_FAULT, f"{told} lines in {LOCKED_S:g} s: {service.log_tail()}"
    # Beside those of the same machine without a lock, which may have other work.
    usual = statistics.median(unlocked)
    assert statistics.median(latencies) < 0.1 + 3.0 * usual, (sorted(latencies)[-5:], usual)
    assert max(latencies) < 1.0 + 10.0 * usual, (sorted(latencies)[-5:], usual)
