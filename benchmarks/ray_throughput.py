"""The effect of a Ray cluster: the same runs on its nodes and on the executor of this machine.

The runs: one ego (`idm`), ten reactive NPCs, 60 s, on tee-town, traces written; two workers on
each side, whose runs are submitted as a campaign submits its own; with `--study`, as the three
campaigns of a study do that share two workers. The cluster is on this machine,
too: two nodes of one worker each, and a head node without. The sides take turns, and begin in
turns, so that a machine that changes its speed changes it for both; workers are warm before the
clock starts.

    python -m benchmarks.ray_throughput --runs 100 --rounds 20
    python -m benchmarks.ray_throughput --runs 99 --rounds 20 --study
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from itertools import count
from pathlib import Path

from benchmarks.scenes import usual_scenes
from drivora_service.campaigns.document.campaign import DEFAULT_LOOKAHEAD
from drivora_service.campaigns.evaluation.local_evaluator import LocalEvaluator
from drivora_service.campaigns.evaluation.shared_pool import SharedPool
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.execution.executor import Executor
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.ray.ray_executor import RayExecutor
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.worker.setup import WorkerSetup
from tests.execution.ray_cluster import ray_cluster

_WORKERS = 2
_WARM_UP = 8


def submit_all(executor: Executor, specs: Sequence[RunSpec]) -> list[RunStatus]:
    """Runs all as one campaign whose runs do not wait for each other."""
    return ask(LocalEvaluator(executor), specs, at_once=len(specs))


def submit_as_study(executor: Executor, specs: Sequence[RunSpec]) -> list[RunStatus]:
    """Runs all as the campaigns of a study, of which one more than workers is under way."""
    campaigns = _WORKERS + 1
    with SharedPool(executor) as pool, ThreadPoolExecutor(campaigns) as threads:
        asked = [
            threads.submit(ask, pool.evaluator(), specs[n::campaigns], at_once=DEFAULT_LOOKAHEAD)
            for n in range(campaigns)
        ]
        return [status for one in asked for status in one.result()]


def ask(evaluator: Evaluator, specs: Sequence[RunSpec], *, at_once: int) -> list[RunStatus]:
    """Has runs evaluated, some at once; returns their statuses."""
    waiting, statuses = list(enumerate(specs)), []
    evaluator.submit(waiting[:at_once])
    del waiting[:at_once]
    while answers := evaluator.wait():
        statuses += [answer.report.status for answer in answers]
        evaluator.submit(waiting[: len(answers)])
        del waiting[: len(answers)]
    return statuses


def run(
    submit: Callable[[Executor, Sequence[RunSpec]], list[RunStatus]],
    executor: Executor,
    documents: Sequence[str],
    folder: Path,
    names: Iterator[int],
) -> float:
    """Runs documents; returns the seconds that it took."""
    specs = [
        RunSpec(run_id=f"run{n}", document=text, trace_path=str(folder / f"{n}.parquet"))
        for n, text in zip(names, documents, strict=False)
    ]
    begun = time.perf_counter()
    statuses = submit(executor, specs)
    seconds = time.perf_counter() - begun
    assert statuses == [RunStatus.FINISHED] * len(documents)
    return seconds


def wait_for_slots(executor: Executor) -> None:
    """Waits until all slots are there."""
    while len(executor.slots()) < _WORKERS:
        if executor.fault:
            raise SystemExit(executor.fault)
        time.sleep(0.1)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=100, help="of each side in a round")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--study", action="store_true", help="submit as campaigns of a study")
    options = parser.parse_args()
    submit = submit_as_study if options.study else submit_all
    documents = [canonical_json(scene) for scene in usual_scenes(options.runs, seed=1)]
    setup, names = WorkerSetup(shipped_networks=shipped_networks()), count()
    ratios = []
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        cluster = stack.enter_context(ray_cluster(*[1] * _WORKERS))
        local: Executor = stack.enter_context(
            closing(LocalExecutor(slots=_WORKERS, setup=setup, folder=folder))
        )
        ray: Executor = stack.enter_context(
            closing(RayExecutor(address=cluster.address, setup=setup, folder=folder / "ray"))
        )
        for executor in (local, ray):
            wait_for_slots(executor)
            run(submit, executor, documents[:_WARM_UP], folder, names)
        for number in range(options.rounds):
            order = (local, ray) if number % 2 == 0 else (ray, local)
            seconds = {
                executor: run(submit, executor, documents, folder, names) for executor in order
            }
            ratios.append(seconds[local] / seconds[ray])
            print(
                f"{len(documents)} runs, K={_WORKERS}: this machine {seconds[local]:.2f} s, "
                f"Ray {seconds[ray]:.2f} s, throughput Ray / this machine {ratios[-1]:.3f}",
                flush=True,
            )
    print(
        f"throughput Ray / this machine: {statistics.median(ratios):.3f} "
        f"({min(ratios):.3f} to {max(ratios):.3f})"
    )


if __name__ == "__main__":
    main()
