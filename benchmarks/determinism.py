"""The same runs everywhere: trace hashes of mixed scenarios for K = 1, K = 2, another order, anew.

python -m benchmarks.determinism --count 200
"""

from __future__ import annotations

import argparse
import random
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.scenes import mixed_scenarios
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.worker.setup import WorkerSetup


def run_with(slots: int, specs: Sequence[RunSpec]) -> dict[str, RunReport]:
    """Runs specs on fresh worker processes."""
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalExecutor(slots=slots, setup=setup, folder=Path(folder)) as executor,
    ):
        return {report.run_id: report for report in run_all(executor, specs)}


def main() -> None:
    """Runs all specs four times and compares the hashes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    specs = [
        RunSpec(run_id=f"mixed-{number:03}", document=canonical_json(scenario))
        for number, scenario in enumerate(mixed_scenarios(options.count, options.seed))
    ]
    shuffled = random.Random(options.seed).sample(specs, len(specs))
    first = run_with(1, specs)
    print("K = 1:", dict(Counter(report.status.value for report in first.values())))
    hashes = {run_id: report.trace_sha256 for run_id, report in first.items()}
    print(len(set(hashes.values())), "different traces")
    for name, slots, order in (
        ("K = 2", 2, specs),
        ("K = 2, shuffled", 2, shuffled),
        ("K = 1, shuffled, fresh process", 1, shuffled),
    ):
        again = run_with(slots, order)
        different = [i for i, report in again.items() if report.trace_sha256 != hashes[i]]
        print(f"{name}: {len(again) - len(different)} of {len(again)} the same", *different[:5])


if __name__ == "__main__":
    main()
