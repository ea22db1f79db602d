"""Agents that die, hang, spread over the machine, or turn against the worker that they run in."""

from __future__ import annotations

import shutil
import threading

import pytest

from tests.faults import processes
from tests.faults.agents.spreading import CHILD_S, DAEMON_S
from tests.faults.conftest import Judge
from tests.faults.processes import wait_until
from tests.faults.service_under_test import Service, Work
from tests.faults.work import among, good_runs

LOGS_BYTES = 64 << 20
"""Greatest size of all logs of workers while an agent prints, bytes."""

HUNG = {("agent_failed", "agent_hung")}
NOT_FINISHED = {
    (status, cause)
    for status, causes in {
        "agent_failed": ("signal", "agent_hung", "worker_exited", "worker_lost", "agent_killed"),
        "timed_out": ("wall_time_limit",),
        "infrastructure_failed": ("worker_lost", "worker_stopped"),
    }.items()
    for cause in causes
}
"""Possible ends of a run with an agent that imitates faults from outside."""

ENDS = {
    "hanger": HUNG,
    "burner": HUNG,
    "child-hanger": HUNG,
    "segfault": {("agent_failed", "signal")},
    "exiter": {("agent_failed", "worker_exited")},
    "self-killer": NOT_FINISHED,
    "self-stopper": NOT_FINISHED,
}


def ends(service: Service, work: Work, agent: str) -> set[tuple[str, str]]:
    rows = service.query("SELECT id, status, cause FROM runs")
    return {(row["status"], row["cause"]) for row in rows if row["id"] in work.ids(agent)}


@pytest.mark.parametrize("agent", ENDS)
def test_dies_or_hangs(service: Service, check: Judge, agent: str, trial: int) -> None:
    work = service.post(among(good_runs(6), [agent], seed=trial))
    check(service, work)
    found = ends(service, work, agent)
    assert found <= ENDS[agent], found
    leave_nothing(CHILD_S)


def leave_nothing(argument: int) -> None:
    """Waits until no process with an argument is left; it has ended with its run, or soon after."""
    wait_until(
        lambda: not processes.with_argument(str(argument)),
        seconds=10.0,
        what=f"a process of an agent (sleep {argument}) has survived its run",
    )


def test_what_leaves_its_session_ends_with_its_run(
    service: Service, check: Judge, trial: int
) -> None:
    work = service.post(among(good_runs(6), ["daemoniser"] * 2, seed=trial))
    check(service, work)
    leave_nothing(DAEMON_S)


def test_memory_of_children_counts(service: Service, check: Judge, trial: int) -> None:
    work = service.post(among(good_runs(6), ["child-eater"], seed=trial))
    check(service, work)
    assert ends(service, work, "child-eater") == {("agent_failed", "memory_limit")}


def test_a_flood_of_lines_is_bounded_on_disk(service: Service, check: Judge, trial: int) -> None:
    folder = service.data / "workers"
    largest, over = [0], threading.Event()

    def measure() -> None:
        while not over.wait(0.02):
            files = [path for path in folder.iterdir() if path.is_file()]
            largest.append(sum(path.stat().st_blocks * 512 for path in files))

    watcher = threading.Thread(target=measure)
    watcher.start()
    try:
        work = service.post(among(good_runs(6), ["flooder"] * 2, seed=trial))
        check(service, work)
    finally:
        over.set()
        watcher.join()
    assert max(largest) < LOGS_BYTES, f"the logs took {max(largest) >> 20} MiB"


@pytest.mark.parametrize(
    "agent",
    [
        "garbage",
        "half-message",
        "huge-message",
        "pickler",
        "forger",
        "truncater",
        "scribbler",
        "log-replacer",
    ],
)
def test_tampers_with_its_worker(service: Service, check: Judge, agent: str, trial: int) -> None:
    """Twice beside good runs; the second batch is done by workers that went through it."""
    shutil.rmtree(service.evidence, ignore_errors=True)
    service.evidence.mkdir()
    first = among(good_runs(6), [agent, agent], seed=trial)
    target = service.post(good_runs(1))
    (service.evidence / "target").write_text(next(iter(target.runs)))
    work = service.post(first)
    later = service.post(among(good_runs(4), ["segfault", "flooder"], seed=trial + 50))
    for each in (work, later, target):
        check(service, each)
    assert not (service.evidence / "unpickled").exists(), "the server unpickled an agent's bytes"
