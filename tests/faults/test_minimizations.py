"""The service is killed in the middle of minimisations: they go on, and find the same."""

from __future__ import annotations

import random
import signal
import time
from typing import Any

import httpx
import pytest

from tests.faults import processes
from tests.faults.conftest import Judge
from tests.faults.processes import wait_until
from tests.faults.service_under_test import Service
from tests.faults.work import good_runs
from tests.suites.minimization.crowded_crash import ONLY_NEEDED, crowded_crash

_SAME = ("state", "message", "decided", "one_minimal", "document", "removed", "before", "after")
"""What must not depend on kills."""


def get(client: httpx.Client, path: str) -> dict[str, Any]:
    found: dict[str, Any] = client.get(path).raise_for_status().json()
    return found


def failing_run(service: Service) -> str:
    with service.client() as client:
        job = client.post("/jobs", json=crowded_crash()).raise_for_status().json()
        wait_until(
            lambda: get(client, f"/jobs/{job['id']}")["status"] == "finished",
            seconds=60.0,
            what="the run does not end",
        )
    run: str = job["id"]
    return run


def started(service: Service, run: str) -> str:
    with service.client() as client:
        answer = client.post(f"/runs/{run}:minimize").raise_for_status()
    return f"/minimizations/{answer.json()['id']}"


def ended(service: Service, address: str) -> dict[str, Any]:
    with service.client() as client:
        wait_until(
            lambda: get(client, address)["state"] not in ("queued", "running"),
            seconds=120.0,
            what="the minimisation does not end",
        )
        return get(client, address)


@pytest.mark.faults
def test_the_server_killed_again_and_again(
    own_service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    """Nothing is lost, nothing counts twice, and the result is that of an undisturbed one."""
    service = own_service
    service.start()
    run = failing_run(service)
    undisturbed = ended(service, started(service, run))
    assert undisturbed["one_minimal"] is True
    work = service.post(good_runs(4))
    address = started(service, run)
    for kill in range(3):
        wait_until(
            lambda least=4 * kill: simulations(service, address) > least,  # type: ignore[misc]  # a default binds the number
            seconds=60.0,
            what="no simulation",
        )
        time.sleep(luck.uniform(0.0, 0.3))
        service.kill()
        service.start()
    found = ended(service, address)
    check(service, work)
    assert {name: found[name] for name in _SAME} == {name: undisturbed[name] for name in _SAME}
    actors = {actor["id"] for key in found["document"] if key.startswith(("ego_", "npc_"))
              for actor in found["document"][key]}  # fmt: skip
    assert actors == ONLY_NEEDED
    rows = service.query(
        "SELECT r.status, count(*) AS runs, count(DISTINCT r.document_sha256) AS documents "
        "FROM runs r JOIN batches b ON b.seq = r.batch_seq "
        f"WHERE b.id = '{found['batch_id']}' GROUP BY r.status"
    )
    (row,) = rows
    assert row["status"] == "finished"
    assert row["runs"] == found["simulations"]


@pytest.mark.faults
def test_workers_killed(service: Service, check: Judge, luck: random.Random, trial: int) -> None:
    """A run whose worker dies is done again, and the minimisation waits for it."""
    run = failing_run(service)
    work = service.post(good_runs(4))
    address = started(service, run)
    for _ in range(2):
        before = simulations(service, address)
        wait_until(
            lambda least=before: simulations(service, address) > least,  # type: ignore[misc]  # a default binds the number
            seconds=60.0,
            what="no simulation",
        )
        processes.send(luck.choice(service.workers()), signal.SIGKILL)
    found = ended(service, address)
    check(service, work)
    assert (found["state"], found["one_minimal"]) == ("finished", True)


def simulations(service: Service, address: str) -> int:
    with service.client() as client:
        found = get(client, address)
    # One that has ended is killed no more.
    return found["simulations"] if found["state"] in ("queued", "running") else 1 << 30
