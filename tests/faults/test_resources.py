"""Descriptors, processes and memory run short temporarily; PID 1 reaps no orphans."""

from __future__ import annotations

import contextlib
import os
import resource
import shutil
import signal
import socket
import sys
import time
from collections.abc import Callable, Iterator, Sequence

import pytest

from tests.faults import processes
from tests.faults.agents.spreading import CHILD_S
from tests.faults.conftest import Judge
from tests.faults.processes import wait_until
from tests.faults.service_under_test import Service
from tests.faults.test_clients import connect
from tests.faults.work import among, good_runs

DESCRIPTORS = 96
CROWD = 200
"""Connections of clients, more than there are descriptors."""

Fault = Callable[[Service], contextlib.AbstractContextManager[None]]


@contextlib.contextmanager
def limited(service: Service, kind: int, value: int, *, of: Sequence[int] = ()) -> Iterator[None]:
    """Limits what processes may use, all of the service's unless told, and lifts the limit again.

    Processes that were started meanwhile have inherited the limit, so that it is lifted for all.
    """
    before = resource.prlimit(service.pid, kind)
    for pid in of or [process.pid for process in processes.tree(service.pid)]:
        resource.prlimit(pid, kind, (value, before[1]))
    try:
        yield
    finally:
        # Twice: a process may have been started between the look and the end of its parent's limit.
        for _ in range(2):
            for process in processes.tree(service.pid):
                with contextlib.suppress(ProcessLookupError):
                    resource.prlimit(process.pid, kind, before)


@contextlib.contextmanager
def no_descriptors_for_the_server(service: Service) -> Iterator[None]:
    server = processes.tree(service.pid)[0]
    with limited(service, resource.RLIMIT_NOFILE, server.num_fds(), of=[server.pid]):
        yield


@contextlib.contextmanager
def no_memory_for_workers(service: Service) -> Iterator[None]:
    """Workers that start get no memory for their set-up; those that run are killed."""
    source = service.fork_server()
    few = source.memory_info().vms + (4 << 20)
    with limited(service, resource.RLIMIT_AS, few, of=[source.pid]):
        for worker in service.workers():
            processes.send(worker, signal.SIGKILL)
        yield


@contextlib.contextmanager
def files_of_workers_may_not_grow(service: Service) -> Iterator[None]:
    some = [process.pid for process in (service.fork_server(), *service.workers())]
    with limited(service, resource.RLIMIT_FSIZE, 0, of=some):
        yield


@pytest.mark.parametrize(
    "fault", [no_descriptors_for_the_server, no_memory_for_workers, files_of_workers_may_not_grow]
)
def test_runs_short(service: Service, check: Judge, fault: Fault, trial: int) -> None:
    work = service.post(good_runs(16))
    service.wait_until_ended(work, 3)
    with fault(service):
        time.sleep(5.0)
    check(service, work)


def test_more_clients_than_descriptors(own_service: Service, check: Judge, trial: int) -> None:
    """The server has few from the start; the crowd waits or is refused, and then goes."""
    service = own_service
    service.prefix = ("prlimit", f"--nofile={DESCRIPTORS}:{DESCRIPTORS}")
    service.start()
    work = service.post(good_runs(12))
    crowd: list[socket.socket] = []
    try:
        for _ in range(CROWD):
            with contextlib.suppress(OSError):
                crowd.append(connect(service))
        time.sleep(4.0)
    finally:
        for connection in crowd:
            connection.close()
    wait_until(service.is_ready, seconds=20.0, what="the service does not answer again")
    check(service, work)
    told = service.log.read_text(errors="replace").count("\n")
    assert told < 200, f"{told} lines: {service.log_tail()}"


INIT = "import subprocess, sys, time; subprocess.Popen(sys.argv[1:]); time.sleep(10 ** 6)"
"""A first process that starts a server and reaps nothing."""


def test_a_first_process_that_does_not_reap(own_service: Service, check: Judge, trial: int) -> None:
    service = own_service
    if os.getuid() != 0 or shutil.which("unshare") is None:
        pytest.skip("needs root and unshare for a namespace of processes")
    service.prefix = (
        *("unshare", "--pid", "--fork", "--kill-child", "--mount-proc"),
        *(sys.executable, "-c", INIT),
    )
    service.start()
    work = service.post(among(good_runs(8), ["child-hanger", "daemoniser"] * 2, seed=trial))
    check(service, work)
    wait_until(
        lambda: not processes.with_argument(str(CHILD_S)),
        seconds=10.0,
        what="a child of a hung agent is left",
    )
