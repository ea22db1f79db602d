"""How fast the web page shows and filters the list of runs, in the browser of its tests.

A real service on a filled store (see ``benchmarks.million_runs fill``), a new browser window with
an empty cache each round.

    python -m benchmarks.million_runs fill --runs 100000 --database FOLDER/drivora.sqlite3
    python -m benchmarks.page --data-dir FOLDER --out benchmarks/results/page.md
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
from collections.abc import Sequence
from pathlib import Path

import httpx

from drivora_service.cli.application.service_process import run_service
from drivora_service.dashboard.build import node_program

WEB = Path(__file__).parents[1] / "drivora_service" / "dashboard" / "web"
"""Folder of the page's sources, with the scripts that the browser's measurements are."""
_AIMS_MS = {"first": 1000.0, "filter": 300.0}
_TITLES = {
    "first": "first rows painted, from the begin of the navigation",
    "filter": "filtered rows painted, from the click on “with an ego at fault”",
}


def measure(url: str, rounds: int) -> dict[str, list[float]]:
    """Returns the milliseconds of each round, by what was measured."""
    done = subprocess.run(
        [str(node_program()), "browser/measure.ts", url, str(rounds)],
        cwd=WEB,
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    found: dict[str, list[float]] = json.loads(done.stdout)
    return found


def page(times: dict[str, Sequence[float]], *, runs: int, load: float) -> str:
    """Returns the results as a page of Markdown."""
    lines = [
        f"# The list of runs in the browser, with {runs:,} runs in the store",
        "",
        "`python -m benchmarks.page`: a real service with one worker, Chromium without a graphics "
        f"card, a new window with an empty cache each round; {os.cpu_count()} cores for all of "
        f"them, load average {load:.1f} before the first round. Milliseconds.",
        "",
        "| | rounds | median | smallest | largest | aim |",
        "|---|---|---|---|---|---|",
    ]
    for name, title in _TITLES.items():
        values = times[name]
        lines.append(
            f"| {title} | {len(values)} | {statistics.median(values):.0f} | {min(values):.0f} "
            f"| {max(values):.0f} | {_AIMS_MS[name]:.0f} |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measures, and writes the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data-dir", type=Path, required=True)
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    load = os.getloadavg()[0]
    with run_service(given.data_dir, workers=1) as url:
        counts = httpx.get(f"{url}/api/v1/runs:counts", timeout=60).raise_for_status().json()
        measure(url, 1)  # The service and the browser have loaded what they need.
        written = page(dict(measure(url, given.rounds)), runs=counts["total"], load=load)
    if given.out:
        given.out.write_text(written)
    print(written)


if __name__ == "__main__":
    main()
