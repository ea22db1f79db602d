"""Executors to measure with, and a report for workers that only wait."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchmarks.slots.sleeping_worker import Sleep
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.ray.ray_executor import RayExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.worker.setup import WorkerSetup
from tests.execution.ray_cluster import ray_cluster

STEADY_S = 3.0
"""Seconds for which runs go on before they are measured."""

_SLEEPING = "benchmarks.slots.sleeping_worker"
_PERFORM, _PREPARE, _WARM_UP = (f"{_SLEEPING}:{name}" for name in ("perform", "prepare", "warm_up"))


def local_executor(slots: int, setup: object, folder: str) -> LocalExecutor:
    """Returns an executor whose workers are real, or wait if the set-up is a :class:`Sleep`."""
    if isinstance(setup, Sleep):
        return LocalExecutor(
            slots=slots,
            setup=setup,
            folder=Path(folder) / "w",
            perform=_PERFORM,
            prepare=_PREPARE,
            warm_up=_WARM_UP,
        )
    return LocalExecutor(slots=slots, setup=setup, folder=Path(folder) / "w")


@contextmanager
def cluster_executor(slots: int, nodes: int, sleep: Sleep, folder: str) -> Iterator[RayExecutor]:
    """Yields an executor whose workers wait, on the nodes of a Ray cluster on this machine."""
    with (
        ray_cluster(*[slots // nodes] * nodes) as cluster,
        RayExecutor(
            address=cluster.address,
            setup=sleep,
            folder=Path(folder) / "w",
            perform=_PERFORM,
            prepare=_PREPARE,
            warm_up=_WARM_UP,
        ) as executor,
    ):
        while len(executor.slots()) < slots:
            if executor.fault:
                raise SystemExit(executor.fault)
            time.sleep(0.1)
        yield executor


def make_real_report(document: str) -> RunReport:
    """Returns the report of a real run."""
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with tempfile.TemporaryDirectory() as folder, local_executor(1, setup, folder) as executor:
        executor.submit(RunSpec(run_id="the-run-of-the-report", document=document))
        (end,) = executor.wait()
    return end.report
