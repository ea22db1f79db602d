"""Throughput against the number of slots, and what the process that owns them costs a run.

Runs are queued before the clock starts; the dispatcher, the queue, the store and the slots work in
this process, whose processor time is measured. Workers are real for K = 1 and 2; for more slots
than this machine has cores they only wait as long as a run takes, in processes of their own
(``sleeping``) or without processes (``simulated``), and answer with a real report. A model is
fitted to the measured shares, and drawn with them.

With ``--campaign`` they are the runs of one campaign of random search, and the engine and its
journal work in this process instead.

With ``--cluster`` the workers are on the nodes of a Ray cluster on this machine, and only wait; the
process that is connected with the cluster and the actors of the nodes are measured, too.

    python -m benchmarks.slots --out benchmarks/results/slots.md --chart docs/images/slots
    python -m benchmarks.slots --campaign --out …
    python -m benchmarks.slots --cluster 8 64 --out …
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.scenes import usual_scenes
from benchmarks.slots import campaign, service
from benchmarks.slots.executors import STEADY_S, cluster_executor, local_executor, make_real_report
from benchmarks.slots.model import cluster_table, draw, fit, table
from benchmarks.slots.service import Point
from benchmarks.slots.simulated_executor import SimulatedExecutor
from benchmarks.slots.sleeping_worker import Sleep
from drivora_service.execution.executor import Executor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.scenario.canonical import canonical_json
from drivora_service.worker.setup import WorkerSetup

_SCENES = 200


def measure_points(options: argparse.Namespace) -> Iterator[Point]:
    """Measures."""
    documents = [canonical_json(scene) for scene in usual_scenes(_SCENES, seed=1)]
    run_s: float = options.run_ms / 1000.0
    report = make_real_report(documents[0])
    if options.cluster:
        sleep = Sleep(run_s=run_s, report=report)
        for slots in options.cluster:
            with (
                tempfile.TemporaryDirectory() as folder,
                cluster_executor(slots, options.nodes, sleep, folder) as executor,
            ):
                yield _measure_point(executor, documents, Path(folder), "cluster", options)
        return
    for slots in options.real:
        setup = WorkerSetup(shipped_networks=shipped_networks())
        with (
            tempfile.TemporaryDirectory() as folder,
            local_executor(slots, setup, folder) as executor,
        ):
            yield _measure_point(executor, documents, Path(folder), "real", options)
    for slots in options.sleeping:
        sleep = Sleep(run_s=run_s, report=report)
        with (
            tempfile.TemporaryDirectory() as folder,
            local_executor(slots, sleep, folder) as executor,
        ):
            yield _measure_point(executor, documents, Path(folder), "sleeping", options)
    for slots in options.simulated:
        simulated = SimulatedExecutor(slots=slots, run_s=run_s, report=report)
        with tempfile.TemporaryDirectory() as folder:
            yield _measure_point(simulated, documents, Path(folder), "simulated", options)
        simulated.close()


def _measure_point(
    executor: Executor,
    documents: Sequence[str],
    folder: Path,
    kind: str,
    options: argparse.Namespace,
) -> Point:
    run_s, seconds = options.run_ms / 1000.0, options.seconds
    if options.campaign:
        return campaign.measure(
            executor, folder, kind=kind, run_s=run_s, seconds=seconds, warm_s=STEADY_S
        )
    return service.measure(
        executor, documents, folder, kind=kind, run_s=run_s, seconds=seconds, warm_s=STEADY_S
    )


def main() -> None:
    """Measures, fits and writes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--campaign", action="store_true", help="a campaign, not the service")
    parser.add_argument("--real", type=int, nargs="*", default=[1, 2])
    parser.add_argument("--sleeping", type=int, nargs="*", default=[8, 64])
    parser.add_argument("--simulated", type=int, nargs="*", default=[8, 64, 256])
    parser.add_argument("--cluster", type=int, nargs="+", default=[], help="slots of all nodes")
    parser.add_argument("--nodes", type=int, default=2, help="of the cluster")
    parser.add_argument("--run-ms", type=float, default=80.0, help="of waited runs")
    parser.add_argument("--seconds", type=float, default=20.0, help="measured for each point")
    parser.add_argument("--out", type=Path, help="Markdown file for the table")
    parser.add_argument("--chart", type=Path, help="files for the curve, without their ending")
    options = parser.parse_args()
    measured = []
    for point in measure_points(options):
        measured.append(point)
        print(point, flush=True)
    model = fit(measured, options.run_ms / 1000.0)
    text = cluster_table(measured, model) if options.cluster else table(measured, model)
    print(text)
    if options.out:
        options.out.write_text(text)
    if options.chart:
        draw(measured, model, options.chart)


if __name__ == "__main__":
    main()
