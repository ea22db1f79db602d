"""Descriptors, processes and memory run short and come back; nothing buries the dead."""

from __future__ import annotations

import contextlib
import resource
import time
from collections.abc import Callable, Iterator, Sequence

import pytest

from tests.faults import processes
from tests.faults.conftest import Judge
from tests.faults.service_under_test import Service
from tests.faults.work import good_runs

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
        for process in processes.tree(service.pid):
            with contextlib.suppress(ProcessLookupError):
                resource.prlimit(process.pid, kind, before)


@contextlib.contextmanager
def no_descriptors_for_the_server(service: Service) -> Iterator[None]:
    server = processes.tree(service.pid)[0]
    with limited(service, resource.RLIMIT_NOFILE, server.num_fds(), of=[server.pid]):
        yield


@pytest.mark.parametrize("fault", [no_descriptors_for_the_server])
def test_runs_short(service: Service, check: Judge, fault: Fault, trial: int) -> None:
    work = service.post(good_runs(24))
    service.wait_until_ended(work, 3)
    with fault(service):
        time.sleep(5.0)
    check(service, work)
