"""What the service needs a run beside the run itself."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchmarks.scenes import usual_scenes
from benchmarks.slots.executors import STEADY_S, local_executor, make_real_report
from benchmarks.slots.service import Point, measure
from benchmarks.slots.simulated_executor import SimulatedExecutor
from benchmarks.suite.measurement import Measurement, Plan, Round, Sample, sample
from benchmarks.suite.result import Better
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.scenario.canonical import canonical_json
from drivora_service.worker.setup import WorkerSetup

_RUN_S = 0.08


def _samples(case: str, point: Point) -> Iterator[Sample]:
    yield sample(case, "service", point.own_ms, "ms a run")
    yield sample(case, "throughput", point.rate, "runs/s", Better.HIGHER)
    yield sample(case, "efficiency", 100.0 * point.efficiency, "%", Better.HIGHER)


@contextmanager
def _open(plan: Plan) -> Iterator[Round]:
    documents = [canonical_json(scene) for scene in usual_scenes(50, seed=1)]
    report = make_real_report(documents[0])
    seconds = 4.0 if plan.short else 10.0
    setup = WorkerSetup(shipped_networks=shipped_networks())

    def once() -> Iterator[Sample]:
        for slots in (2,) if plan.short else (1, 2):
            with (
                tempfile.TemporaryDirectory(dir=plan.folder) as folder,
                local_executor(slots, setup, folder) as executor,
            ):
                point = measure(
                    executor,
                    documents,
                    Path(folder),
                    kind="real",
                    run_s=_RUN_S,
                    seconds=seconds,
                    warm_s=STEADY_S,
                )
            yield from _samples(f"K = {slots}, real workers", point)
        for slots in (64,) if plan.short else (8, 64, 256):
            simulated = SimulatedExecutor(slots=slots, run_s=_RUN_S, report=report)
            with tempfile.TemporaryDirectory(dir=plan.folder) as folder:
                point = measure(
                    simulated,
                    documents,
                    Path(folder),
                    kind="simulated",
                    run_s=_RUN_S,
                    seconds=seconds,
                    warm_s=STEADY_S,
                )
            simulated.close()
            yield from _samples(f"K = {slots}, simulated workers", point)

    yield once


SERVICE = Measurement(
    name="service",
    title="Overhead of the service",
    about="Processor time of the service's own process a run (dispatcher, queue, store, "
    "supervision of workers), and the share of the slots' time in which a worker performs a run. "
    "Real workers perform a run of 60 s with one ego and ten NPCs; simulated ones only wait 80 ms "
    "and answer with a real report. More points and a model: `python -m benchmarks.slots`.",
    open=_open,
)
