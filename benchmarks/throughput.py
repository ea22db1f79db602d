"""What K workers and the service add: K = 2 against K = 1, the service against the executor.

The runs: one ego (`idm`), ten reactive NPCs, 60 s, on tee-town, traces written. Each measurement is
taken in turn with its counterpart; the workers are warm before the clock starts.

    python -m benchmarks.throughput --runs 500 --repeat 3
"""

from __future__ import annotations

import argparse
import json
import statistics
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import httpx

from benchmarks.scenes import usual_scenes
from drivora_service.cli.service_process import running_service
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.running import run_all
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.report import RunSpec, RunStatus
from drivora_service.runs.worker_setup import WorkerSetup
from drivora_service.scenario.canonical import canonical_json
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.model import Scenario

_WARM_UP = 8


def bare(scenes: Sequence[Scenario], slots: int) -> float:
    """Runs scenes on the executor alone; gives wall seconds."""
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def specs(chosen: Sequence[Scenario], prefix: str) -> list[RunSpec]:
            return [
                RunSpec(
                    run_id=f"{prefix}{n}",
                    document=canonical_json(scene),
                    trace_path=str(folder / f"{prefix}{n}.parquet"),
                )
                for n, scene in enumerate(chosen)
            ]

        with LocalExecutor(slots=slots, setup=setup, folder=folder) as executor:
            list(run_all(executor, specs(scenes[:_WARM_UP], "warm")))
            begun = time.perf_counter()
            reports = list(run_all(executor, specs(scenes, "run")))
            seconds = time.perf_counter() - begun
    assert all(report.status is RunStatus.FINISHED for report in reports)
    return seconds


def served(scenes: Sequence[Scenario], slots: int) -> float:
    """Posts scenes to a real server; gives wall seconds from the post to the last run's end."""
    with (
        tempfile.TemporaryDirectory() as name,
        running_service(Path(name), workers=slots) as url,
        httpx.Client(base_url=f"{url}/api/v1", timeout=300.0) as client,
    ):
        _post_and_wait(client, scenes[:_WARM_UP])
        return _post_and_wait(client, scenes)


def _post_and_wait(client: httpx.Client, scenes: Sequence[Scenario]) -> float:
    lines = [json.dumps(json.loads(document_text(to_document(scene)))) for scene in scenes]
    begun = time.perf_counter()
    answer = client.post(
        "/batches",
        content="\n".join(lines),
        headers={"Content-Type": "application/x-ndjson"},
    )
    answer.raise_for_status()
    batch = answer.headers["Location"].rsplit("/", 1)[-1]
    while True:
        found = client.get(f"/batches/{batch}").raise_for_status().json()
        if found["done"]:
            return time.perf_counter() - begun
        time.sleep(0.5)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    scenes = usual_scenes(options.runs, seed=1)
    some = scenes[: max(options.runs // 4, _WARM_UP)]
    scaling, overhead = [], []
    for _ in range(options.repeat):
        one, two = bare(some, 1), bare(some, 2)
        alone, service = bare(scenes, 2), served(scenes, 2)
        scaling.append(one / two)
        overhead.append(service / alone)
        print(
            f"{len(some)} runs: K=1 {one:.2f} s, K=2 {two:.2f} s, x {one / two:.3f};  "
            f"{len(scenes)} runs, K=2: executor {alone:.2f} s, service {service:.2f} s, "
            f"x {service / alone:.3f}"
        )
    print(f"K = 2 / K = 1: {statistics.median(scaling):.3f}")
    print(f"service / executor: {statistics.median(overhead):.3f}")


if __name__ == "__main__":
    main()
