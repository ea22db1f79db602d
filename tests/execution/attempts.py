"""Attempts of the tests' own tasks on an executor."""

from __future__ import annotations

import time

from drivora_service.execution.executor import Executor, Limits
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunFailure, RunReport, RunSpec, RunStatus

TASKS = "tests.execution.worker_tasks:perform"
LIMITS = Limits(agent_deadline_s=0.8, wall_time_s=20.0, memory_bytes=600 << 20)


def run(executor: Executor, document: str) -> AttemptEnd:
    executor.submit(RunSpec(run_id="run", document=document))
    return wait_for(executor, 1)[0]


def wait_for(executor: Executor, count: int) -> list[AttemptEnd]:
    ends: list[AttemptEnd] = []
    limit = time.monotonic() + 60
    while len(ends) < count and time.monotonic() < limit:
        ends += executor.wait(1.0)
    assert len(ends) == count
    return ends


def failure_of(report: RunReport) -> RunFailure:
    assert report.failure is not None
    return report.failure


def assert_usable(executor: Executor) -> None:
    assert run(executor, "sleep 0").report.status is RunStatus.FINISHED


def pid_of(executor: Executor, run_id: str) -> int:
    """Waits until a run is running and returns its process."""
    limit = time.monotonic() + 60
    while time.monotonic() < limit:
        for slot in executor.slots():
            if slot.run_id == run_id and slot.phase == "simulating" and slot.pid is not None:
                return slot.pid
        time.sleep(0.02)
    raise AssertionError(f"{run_id} was never seen running")
