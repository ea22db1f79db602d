"""The effect of K workers and of the service: K = 2 against K = 1, service against executor.

The runs: one ego (`idm`), ten reactive NPCs, 60 s, on tee-town, traces written. What two cores give
is measured beside it, with libsumo alone: one process and two that replay the placements of such
runs. All of it takes turns, round after round, so that a machine that changes its speed changes
it for all; workers, server and replaying processes are warm before the clock starts.

    python -m benchmarks.throughput --runs 500 --rounds 3
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import count, cycle, islice
from multiprocessing.connection import Connection
from pathlib import Path

import httpx

from benchmarks.run_cost import record, replay_tape
from benchmarks.scenes import usual_scenes
from drivora_service.cli.application.service_process import run_service
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.runs.run_report import RunSpec, RunStatus
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import Scenario
from drivora_service.worker.parent_death import die_with_parent
from drivora_service.worker.setup import WorkerSetup

_WARM_UP = 8
_POLL_S = 0.25

Seconds = float
Measured = Callable[[Sequence[Scenario]], Seconds]


@contextmanager
def warm_executor(slots: int, folder: Path) -> Iterator[Measured]:
    """Returns a function that runs scenes on the executor alone."""
    setup = WorkerSetup(shipped_networks=shipped_networks())
    numbers = count()
    folder.mkdir()

    def measured(scenes: Sequence[Scenario]) -> Seconds:
        specs = [
            RunSpec(
                run_id=f"run{number}",
                document=canonical_json(scene),
                trace_path=str(folder / f"{number}.parquet"),
            )
            for number, scene in zip(numbers, scenes, strict=False)
        ]
        begun = time.perf_counter()
        reports = list(run_all(executor, specs))
        seconds = time.perf_counter() - begun
        assert all(report.status is RunStatus.FINISHED for report in reports)
        return seconds

    with LocalExecutor(slots=slots, setup=setup, folder=folder) as executor:
        yield measured


@contextmanager
def warm_service(slots: int, folder: Path) -> Iterator[Measured]:
    """Returns a function that posts scenes to a real server and waits for their last run."""
    with (
        run_service(folder, workers=slots) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=300.0) as client,
    ):

        def measured(scenes: Sequence[Scenario]) -> Seconds:
            lines = [json.dumps(json.loads(document_text(to_document(s)))) for s in scenes]
            begun = time.perf_counter()
            answer = client.post(
                "/batches",
                content="\n".join(lines),
                headers={"Content-Type": "application/x-ndjson"},
            )
            answer.raise_for_status()
            batch = answer.headers["Location"].rsplit("/", 1)[-1]
            while not client.get(f"/batches/{batch}").raise_for_status().json()["done"]:
                time.sleep(_POLL_S)
            return time.perf_counter() - begun

        yield measured


@contextmanager
def warm_libsumo(processes: int) -> Iterator[Measured]:
    """Returns a function that replays runs in libsumo alone, as many as there are scenes."""
    spawn = multiprocessing.get_context("spawn")
    pipes = []
    for _ in range(processes):
        ours, theirs = spawn.Pipe()
        spawn.Process(target=_replay, args=(theirs,), daemon=True).start()
        pipes.append(ours)
    for pipe in pipes:
        pipe.recv()

    def measured(scenes: Sequence[Scenario]) -> Seconds:
        begun = time.perf_counter()
        for pipe in pipes:
            pipe.send(len(scenes) // processes)
        for pipe in pipes:
            pipe.recv()
        return time.perf_counter() - begun

    yield measured
    for pipe in pipes:
        pipe.send(0)


def _replay(pipe: Connection) -> None:
    die_with_parent()
    networks = NetworkCatalogue(shipped_networks())
    tapes = []
    for scene in usual_scenes(_WARM_UP, seed=1):
        road = networks.get(scene.map_region.town)
        tapes.append((record(scene, road), road.path))
    pipe.send(None)
    while times := pipe.recv():
        for tape, network in islice(cycle(tapes), times):
            replay_tape(tape, network)
        pipe.send(None)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=500, help="posted to the service a round")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    scenes = usual_scenes(options.runs, seed=1)
    # A fifth is enough for two workers against one: their batches differ in nothing else.
    some = scenes[: max(options.runs // 5 // 2 * 2, _WARM_UP)]
    ours, bare, overhead = [], [], []
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        one = stack.enter_context(warm_executor(1, folder / "one"))
        two = stack.enter_context(warm_executor(2, folder / "two"))
        bare_one = stack.enter_context(warm_libsumo(1))
        bare_two = stack.enter_context(warm_libsumo(2))
        service = stack.enter_context(warm_service(2, folder / "service"))
        for measured in (one, two, service):
            measured(scenes[:_WARM_UP])
        for _ in range(options.rounds):
            alone, pair = one(some), two(some)
            bare_alone, bare_pair = bare_one(some), bare_two(some)
            executed, served = two(scenes), service(scenes)
            ours.append(alone / pair)
            bare.append(bare_alone / bare_pair)
            overhead.append(served / executed)
            print(
                f"{len(some)} runs: K=1 {alone:.2f} s, K=2 {pair:.2f} s, x {ours[-1]:.3f}, "
                f"libsumo alone {bare_alone:.2f} s, {bare_pair:.2f} s, x {bare[-1]:.3f};  "
                f"{len(scenes)} runs, K=2: executor {executed:.2f} s, service {served:.2f} s, "
                f"x {overhead[-1]:.3f}",
                flush=True,
            )
    print(f"K = 2 / K = 1: {statistics.median(ours):.3f}")
    print(f"the same with libsumo alone: {statistics.median(bare):.3f}")
    print(f"service / executor: {statistics.median(overhead):.3f}")


if __name__ == "__main__":
    main()
