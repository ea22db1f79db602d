"""Executors to measure with, and a report for workers that only wait."""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks.slots.sleeping_worker import Sleep
from drivora_service.execution.local import LocalExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.report import RunReport, RunSpec
from drivora_service.worker.setup import WorkerSetup

STEADY_S = 3.0
"""Seconds for which runs go on before they are measured."""


def local_executor(slots: int, setup: object, folder: str) -> LocalExecutor:
    """Returns an executor whose workers are real, or wait if the set-up is a :class:`Sleep`."""
    if isinstance(setup, Sleep):
        return LocalExecutor(
            slots=slots,
            setup=setup,
            folder=Path(folder) / "w",
            perform="benchmarks.slots.sleeping_worker:perform",
            prepare="benchmarks.slots.sleeping_worker:prepare",
            warm_up="benchmarks.slots.sleeping_worker:warm_up",
        )
    return LocalExecutor(slots=slots, setup=setup, folder=Path(folder) / "w")


def real_report(document: str) -> RunReport:
    """Returns the report of a real run."""
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with tempfile.TemporaryDirectory() as folder, local_executor(1, setup, folder) as executor:
        executor.submit(RunSpec(run_id="the-run-of-the-report", document=document))
        (end,) = executor.wait()
    return end.report
