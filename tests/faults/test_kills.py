"""Processes of the service are killed in the middle of a batch."""

from __future__ import annotations

import json
import random
import shutil
import signal
import time
from collections.abc import Callable
from typing import Any

import psutil
import pytest

from tests.campaign_engines import engine_pid
from tests.faults import processes
from tests.faults.conftest import Judge
from tests.faults.processes import wait_until
from tests.faults.service_under_test import ROOT, Service
from tests.faults.work import SLOW, Run, campaign, good_runs

Fault = Callable[[Service, random.Random], None]


def a_worker(service: Service, luck: random.Random) -> None:
    processes.send(luck.choice(service.workers()), signal.SIGKILL)


def all_workers(service: Service, luck: random.Random) -> None:
    for worker in service.workers():
        processes.send(worker, signal.SIGKILL)


def a_keeper(service: Service, luck: random.Random) -> None:
    service.workers()
    processes.send(luck.choice(processes.keepers(service.data / "workers")), signal.SIGKILL)


def the_fork_server(service: Service, luck: random.Random) -> None:
    processes.send(service.fork_server(), signal.SIGKILL)


def fork_server_and_workers(service: Service, luck: random.Random) -> None:
    found = service.workers()
    processes.send(service.fork_server(), signal.SIGKILL)
    for worker in found:
        processes.send(worker, signal.SIGKILL)


def the_server(service: Service, luck: random.Random) -> None:
    children = processes.tree(service.pid)[1:]
    service.kill()
    _, left = psutil.wait_procs(children, timeout=10.0)
    assert left == [], "processes have outlived their server"
    service.start()


@pytest.mark.parametrize(
    "kill", [a_worker, all_workers, a_keeper, the_fork_server, fork_server_and_workers, the_server]
)
def test_killed(
    service: Service, check: Judge, luck: random.Random, kill: Fault, trial: int
) -> None:
    work = service.post(good_runs(16))
    service.wait_until_ended(work, luck.randrange(2, 7))
    time.sleep(luck.uniform(0.0, 0.3))
    kill(service, luck)
    check(service, work)


def test_workers_killed_at_random_moments(
    service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    """Two deaths of a run's workers are few enough that it must be finished, three are not."""
    work = service.post(good_runs(24))
    for _ in range(5):
        time.sleep(luck.uniform(0.2, 1.2))
        wait_until(
            lambda: not _runs_with_two_deaths(service),
            seconds=60.0,
            what="a run whose workers have died twice has not ended",
        )
        a_worker(service, luck)
    check(service, work)


def _runs_with_two_deaths(service: Service) -> list[dict[str, Any]]:
    """Returns the runs that have not ended, and that one more death of a worker would end."""
    return service.query(
        "SELECT r.id FROM runs r JOIN attempts x ON x.run_seq = r.seq "
        "WHERE r.status IN ('queued', 'running') AND x.ended_at IS NOT NULL "
        "GROUP BY r.id HAVING count(*) >= 2"
    )


def test_a_run_in_flight_at_three_deaths_of_the_server_goes_last(
    own_service: Service, check: Judge, trial: int
) -> None:
    """Runs that may be the reason of the deaths wait; the others are finished first."""
    service = own_service
    service.start()
    work = service.post([*good_runs(2, agent=SLOW), *good_runs(10)])
    suspects = work.ids(SLOW)
    for _ in range(3):
        wait_until(
            lambda: all(service.statuses(work)[run] == "running" for run in suspects),
            seconds=60.0,
            what="the slow runs are not in flight",
        )
        time.sleep(0.3)
        service.kill()
        service.start()
    check(service, work)
    rows = service.query(
        "SELECT r.id, count(x.number) AS deaths FROM runs r LEFT JOIN attempts x "
        "ON x.run_seq = r.seq AND x.outcome = 'interrupted' GROUP BY r.id ORDER BY r.ended_at"
    )
    order = [(row["id"], row["deaths"] >= 3) for row in rows if row["id"] in work.runs]
    assert {run for run, late in order if late} >= set(suspects)
    assert [late for _, late in order] == sorted(late for _, late in order), order


def test_the_engine_of_a_campaign_killed(
    service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    simulations = 20
    with service.client() as client:
        answer = client.post("/campaigns", json=campaign(simulations)).raise_for_status()
        address = f"/campaigns/{answer.json()['id']}"

        def state() -> dict[str, Any]:
            found: dict[str, Any] = client.get(address).raise_for_status().json()
            return found

        work = service.post(good_runs(6))
        wait_until(lambda: state()["simulations"] >= 3, seconds=60.0, what="no simulation")
        time.sleep(luck.uniform(0.0, 0.5))
        engine = engine_pid(service.data / "campaigns" / answer.json()["id"])
        psutil.Process(engine).kill()
        wait_until(
            lambda: state()["state"] not in ("queued", "running"),
            seconds=90.0,
            what="the campaign does not end",
        )
        last = state()
        batch = client.get(f"/batches/{last['batch_id']}").json()
    check(service, work)
    assert (last["state"], last["simulations"]) == ("finished", simulations), last
    # The run of the seed is one more.
    assert batch["counts"] == {"finished": 1 + simulations + last["counts"]["violating"]}


def test_an_ads_process_killed(own_service: Service, check: Judge, trial: int) -> None:
    """The kill comes from outside: the run is not the ADS's failure."""
    service = own_service
    folder = service.data / "agents" / "external-agent"
    shutil.copytree(ROOT / "deploy" / "external-agent", folder)
    service.start()
    slow = [Run(agent="external-agent", kind=n, seed=n) for n in range(8)]
    work = service.post([*slow, *good_runs(12)])
    script = str(folder / "agent.py")
    wait_until(
        lambda: processes.with_argument(script) and service.ended(work) >= 2,
        seconds=60.0,
        what="no ADS has driven",
    )
    for process in processes.with_argument(script):
        processes.send(process, signal.SIGKILL)
    check(service, work)
    statuses = service.statuses(work)
    assert {statuses[run] for run in work.ids("external-agent")} == {"finished"}, json.dumps(
        service.query("SELECT id, status, cause FROM runs")
    )
