"""SIGTERM while runs are going on."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest

from tests.faults.conftest import Judge
from tests.faults.processes import wait_until
from tests.faults.service_under_test import Service
from tests.faults.work import SLOW, good_runs

DRAIN_S = 3.0
STOP_S = 8.0
"""Seconds beside the drain that a server may take to end, on a busy machine."""


@pytest.fixture
def own_service(tmp_path: Path) -> Service:
    return Service(tmp_path, variables={"DRIVORA_DRAIN_S": f"{DRAIN_S:g}"})


def test_a_server_drains_and_hands_back_the_rest(own_service: Service, check: Judge) -> None:
    service = own_service
    service.start()
    try:
        work = service.post([*good_runs(8), *good_runs(4, agent=SLOW)])
        service.wait_until_ended(work, 4)
        begun = time.monotonic()
        service.signal(signal.SIGTERM)
        assert service.process is not None
        assert service.process.wait(60.0) == 0
        assert time.monotonic() - begun < DRAIN_S + STOP_S
        wait_until(lambda: not service.leftovers(), seconds=10.0, what="processes are left")
        assert set(service.statuses(work).values()) <= {"queued", "finished"}
        assert service.query("SELECT * FROM attempts WHERE ended_at IS NULL") == []
        service.start()
        check(service, work)
    finally:
        service.stop()


def test_a_second_signal_ends_at_once(own_service: Service, check: Judge) -> None:
    service = own_service
    service.variables = {"DRIVORA_DRAIN_S": "60"}
    service.start()
    try:
        work = service.post(good_runs(4, agent=SLOW))
        # One that is merely claimed goes back at once, and nothing is left to drain.
        wait_until(
            lambda: service.query("SELECT * FROM slots WHERE phase = 'in_agent'"),
            seconds=30.0,
            what="no run drives",
        )
        service.signal(signal.SIGTERM)
        wait_until(
            lambda: "the service is being stopped" in service.readiness(),
            seconds=10.0,
            what="the first signal did not drain",
        )
        assert service.process is not None
        assert service.process.poll() is None
        begun = time.monotonic()
        service.signal(signal.SIGTERM)
        service.process.wait(60.0)
        taken = time.monotonic() - begun
        service.start()
        check(service, work)
        assert taken < 2.0
    finally:
        service.stop()
