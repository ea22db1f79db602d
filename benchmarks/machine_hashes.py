"""The same runs on every machine: trace hashes of mixed scenarios of several ADSs, to be compared.

python -m benchmarks.machine_hashes --count 50 > here.txt    then the same elsewhere, and diff
"""

from __future__ import annotations

import argparse
import hashlib
import platform
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

from benchmarks.scenes import mixed_scenarios
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.spec_running import run_all
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.runs.run_report import RunSpec
from drivora_service.scenario.canonical import canonical_json
from drivora_service.worker.setup import WorkerSetup

_AGENTS = ("idm", "idm-mobil", "pdm-closed", "plant-lite")


def main() -> None:
    """Prints a line a run and a hash of all lines; describes the machine on standard error."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=50, help="scenarios, each for every agent")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--agents", nargs="+", default=_AGENTS)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    scenarios = [
        canonical_json(scenario) for scenario in mixed_scenarios(options.count, options.seed)
    ]
    specs = [
        RunSpec(run_id=f"{agent} {number:03}", document=document, agent=agent)
        for agent in options.agents
        for number, document in enumerate(scenarios)
    ]
    setup = WorkerSetup(shipped_networks=shipped_networks())
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalExecutor(slots=options.workers, setup=setup, folder=Path(folder)) as executor,
    ):
        lines = sorted(
            f"{report.run_id} {report.status.value} {report.trace_sha256}"
            for report in run_all(executor, specs)
        )
    packages = ", ".join(f"{name} {version(name)}" for name in ("libsumo", "numpy", "numba"))
    libc = " ".join(platform.libc_ver())
    print(f"Python {platform.python_version()}, {libc}, {packages}", file=sys.stderr)
    print("\n".join(lines))
    digest = hashlib.sha256("\n".join(lines).encode()).hexdigest()
    print(f"all {len(lines)}: {digest}")


if __name__ == "__main__":
    main()
