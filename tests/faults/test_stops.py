"""Processes of the service stand still for longer than an agent may take, and go on."""

from __future__ import annotations

import random
import signal
import time

from tests.faults import processes
from tests.faults.conftest import Judge
from tests.faults.service_under_test import AGENT_DEADLINE_S, Service
from tests.faults.work import SLOW, good_runs

STANDSTILL_S = AGENT_DEADLINE_S + 2.0


def test_a_stopped_worker_is_not_a_hung_agent(
    service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    work = service.post([*good_runs(2, agent=SLOW), *good_runs(10)])
    service.wait_until_ended(work, 1)
    with processes.stopped(luck.choice(service.workers()), seconds=STANDSTILL_S):
        pass
    check(service, work)


def test_the_fork_server_stopped_while_workers_die(
    service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    work = service.post(good_runs(16))
    service.wait_until_ended(work, 2)
    worker = luck.choice(service.workers())
    with processes.stopped(service.fork_server(), seconds=STANDSTILL_S):
        processes.send(worker, signal.SIGKILL)
    check(service, work)


def test_a_stopped_server_blames_no_agent(
    service: Service, check: Judge, luck: random.Random, trial: int
) -> None:
    work = service.post([*good_runs(2, agent=SLOW), *good_runs(12)])
    time.sleep(luck.uniform(0.5, 2.0))
    with processes.stopped(processes.tree(service.pid)[0], seconds=STANDSTILL_S):
        pass
    check(service, work)
