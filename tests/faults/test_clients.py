"""Clients that go away in the middle, that say only half, and that cancel when runs end."""

from __future__ import annotations

import contextlib
import random
import socket
import statistics
import struct
import time
from collections.abc import Iterator

import httpx

from tests.faults.conftest import Judge
from tests.faults.service_under_test import Service
from tests.faults.work import good_runs

HALF_OPEN = 500
CANCELS = 8


def connect(service: Service) -> socket.socket:
    url = httpx.URL(service.url)
    return socket.create_connection((url.host, url.port or 80), timeout=10.0)


def hang_up(connection: socket.socket) -> None:
    """Closes a connection with a reset rather than an end."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


@contextlib.contextmanager
def half_open(service: Service, count: int) -> Iterator[list[socket.socket]]:
    """Opens connections that send half a request each."""
    opened: list[socket.socket] = []
    try:
        for _ in range(count):
            with contextlib.suppress(OSError):
                opened.append(connect(service))
                opened[-1].sendall(b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Le")
        yield opened
    finally:
        for connection in opened:
            connection.close()


def test_clients_hang_up_in_request_and_answer(
    service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    work = service.post(good_runs(12))
    body = good_runs(1)[0].document.encode()
    request = b"POST /api/v1/scenarios:validate HTTP/1.1\r\nHost: localhost\r\n"
    request += b"Content-Type: application/json\r\n"
    request += b"Content-Length: %d\r\n\r\n%s" % (len(body), body)
    listing = b"GET /api/v1/networks/tee-town/geometry HTTP/1.1\r\nHost: localhost\r\n\r\n"
    for number in range(100):
        connection = connect(service)
        said = request if number % 2 else listing
        connection.sendall(said[: luck.randrange(1, len(said) + 1)])
        if number % 3 == 0:
            time.sleep(0.01)
        hang_up(connection)
    check(service, work)
    assert "Traceback" not in service.log_tail()


def test_five_hundred_half_open_connections(service: Service, check: Judge, trial: int) -> None:
    work = service.post(good_runs(12))
    with half_open(service, HALF_OPEN) as opened:
        latencies = [service.latency("/healthz") for _ in range(20)]
        time.sleep(1.0)
    assert len(opened) == HALF_OPEN
    check(service, work)
    assert statistics.median(latencies) < 1.0, latencies


def test_cancelled_when_runs_end(
    service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    """One job of some, and one whole batch, at the moments when their runs end."""
    work = service.post(good_runs(16))
    with service.client() as client:
        for number in range(CANCELS):
            other = service.post(good_runs(3))
            first = next(iter(other.runs))
            while service.statuses(other)[first] == "queued":
                time.sleep(0.01)
            time.sleep(luck.uniform(0.0, 0.6))
            address = f"/batches/{other.batch}" if number % 2 else f"/jobs/{first}"
            client.post(f"{address}:cancel").raise_for_status()
            service.wait_until_ended(other, len(other.runs), seconds=60.0)
            statuses = service.statuses(other)
            assert set(statuses.values()) <= {"finished", "cancelled"}, statuses
            if number % 2 == 0:
                rest = {status for run, status in statuses.items() if run != first}
                assert rest == {"finished"}, statuses
            assert set(statuses) == set(other.runs)
    check(service, work)
