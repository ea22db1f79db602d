"""Folders disappear, volumes fill up, another process locks the database."""

from __future__ import annotations

import contextlib
import shutil
import time
from collections.abc import Callable, Iterator

import httpx
import pytest

from tests.faults.conftest import Judge
from tests.faults.service_under_test import Service
from tests.faults.volumes import full, small_volume
from tests.faults.work import good_runs

FAULT_S = 6.0
"""Seconds that a fault lasts."""

LOCKED_S = 40.0
LINES_PER_FAULT = 30
"""Lines that the log may gain while a fault lasts; a line a turn of a loop would be hundreds."""

Fault = Callable[[Service], contextlib.AbstractContextManager[None]]


def lines(service: Service) -> int:
    return service.log.read_text(errors="replace").count("\n")


@contextlib.contextmanager
def traces_removed(service: Service) -> Iterator[None]:
    shutil.rmtree(service.data / "traces")
    yield


@contextlib.contextmanager
def workers_folder_removed(service: Service) -> Iterator[None]:
    shutil.rmtree(service.data / "workers")
    for worker in service.workers():
        worker.kill()
    yield


@pytest.mark.parametrize("fault", [traces_removed, workers_folder_removed])
def test_a_folder_cannot_be_used(service: Service, check: Judge, fault: Fault, trial: int) -> None:
    work = service.post(good_runs(24))
    service.wait_until_ended(work, 3)
    before = lines(service)
    with fault(service):
        time.sleep(FAULT_S)
        told = lines(service) - before
        assert httpx.get(f"{service.url}/healthz", timeout=5.0).is_success
    check(service, work)
    assert told <= LINES_PER_FAULT, f"{told} lines in {FAULT_S:g} s: {service.log_tail()}"


def test_the_volume_of_all_data_full(own_service: Service, check: Judge, trial: int) -> None:
    service = own_service
    with small_volume(service.data, megabytes=24):
        try:
            service.start()
            work = service.post(good_runs(24))
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
