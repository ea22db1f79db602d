"""The memory of a service during one long campaign of tiny simulations.

A real server with two workers runs one campaign of random search. Its simulations last for one
simulated second and ten steps, so that what the server and the engine keep of each shows soonest.
Resident memory, the memory that is a process's own, and the size of the database are read after
each hundredth of the campaign; the results are written each time, so that a campaign that is
interrupted has some.

    python -m benchmarks.campaign_memory --simulations 100000 \\
        --out benchmarks/results/campaign_memory.md
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import psutil

_MIB = 1 << 20
_START_S = 300.0
_LOOK_S = 2.0
_SETTLED = 0.1
"""Share of the campaign after which memory is to be flat: caches are full by then."""
_PID = re.compile(r"^process (\d+) runs campaign", re.MULTILINE)
_ENDED = ("finished", "failed", "cancelled", "paused")

SCENARIO: dict[str, Any] = {
    "version": "1.0",
    "frame": "sumo",
    "ego_vehicles": [
        {
            "id": "ego_0",
            "model": "vehicle.lincoln.mkz_2017",
            "route": [{"x": 199.9, "y": 205.4}, {"x": 135.0, "y": 286.1}],
            "initial_speed": 5.0,
            "agent": {"name": "idm"},
        }
    ],
    "map_region": {"town": "tee-town"},
    "seed": 1,
    "max_sim_time": 1.0,
    "step_length": 0.1,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """A service after some simulations of its campaign.

    Attributes:
        simulations: That are stored.
        seconds: Since the campaign was posted.
        server_mib: Resident memory of the server.
        server_own_mib: The part of it that no other process shares.
        engine_mib: Resident memory of the engine.
        engine_own_mib: The part of it that no other process shares.
        database_mib: Size of the database with its log of changes.
    """

    simulations: int
    seconds: float
    server_mib: float
    server_own_mib: float
    engine_mib: float
    engine_own_mib: float
    database_mib: float


FITTED = ("server_mib", "server_own_mib", "engine_mib", "engine_own_mib", "database_mib")


@contextlib.contextmanager
def service(folder: Path) -> Iterator[tuple[int, str]]:
    """Yields the process id of a server with two workers, and its address."""
    data = folder / "data"
    data.mkdir()
    command = [sys.executable, "-m", "drivora_service.cli", "serve", "--data-dir", str(data)]
    with (folder / "service.log").open("wb") as log:
        process = subprocess.Popen(
            [*command, "--workers", "2", "--port", "0"], stdout=log, stderr=log, env=os.environ
        )
    try:
        yield process.pid, _wait_until_ready(process, data / "service.json")
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(60.0)
        except subprocess.TimeoutExpired:
            process.kill()


def _wait_until_ready(process: subprocess.Popen[bytes], announced: Path) -> str:
    deadline = time.monotonic() + _START_S
    while process.poll() is None and time.monotonic() < deadline:
        with contextlib.suppress(OSError, ValueError, httpx.HTTPError):
            url: str = json.loads(announced.read_text())["url"]
            if httpx.get(f"{url}/readyz").is_success:
                return url
        time.sleep(0.2)
    raise SystemExit("error: the service did not start")


def campaign(simulations: int, tester: str) -> dict[str, Any]:
    """Returns the document of the campaign."""
    return {
        "name": f"{simulations} tiny simulations",
        "tester": {"name": tester},
        "scenario": SCENARIO,
        "space": {"vehicles": 0, "walkers": 0},
        # None of them collides: memory for failures is not what is measured.
        "oracles": ["collision"],
        "budget": {"simulations": simulations},
        "seed": 1,
    }


def samples(
    folder: Path, simulations: int, *, tester: str, most_s: float
) -> Iterator[tuple[Sample, str]]:
    """Runs a campaign; yields the service after each hundredth, and the state of the campaign.

    Args:
        folder: For the data of the service.
        simulations: Budget of the campaign.
        tester: Its method.
        most_s: Seconds after which the campaign is left.
    """
    with service(folder) as (pid, url), httpx.Client(base_url=url, timeout=60.0) as client:
        answer = client.post("/api/v1/campaigns", json=campaign(simulations, tester))
        if answer.status_code != 202:
            raise SystemExit(f"error: {answer.text}")
        campaign_id = answer.json()["id"]
        begun, due = time.monotonic(), 0
        while True:
            record = client.get(f"/api/v1/campaigns/{campaign_id}").json()
            done, seconds = record["counts"]["evaluations"], time.monotonic() - begun
            is_over = record["state"] in _ENDED or seconds > most_s
            engine = _engine(folder / "data", campaign_id)
            if (done >= due and engine is not None) or is_over:
                due = done + max(1, simulations // 100)
                yield _sample(folder / "data", pid, engine, done, seconds), record["state"]
            if is_over:
                return
            time.sleep(_LOOK_S)


def _engine(data: Path, campaign_id: str) -> psutil.Process | None:
    """Returns the process of a campaign, if it has begun."""
    with contextlib.suppress(OSError, psutil.Error):
        found = _PID.findall((data / "campaigns" / campaign_id / "engine.log").read_text())
        if found:
            return psutil.Process(int(found[-1]))
    return None


def _sample(
    data: Path, server: int, engine: psutil.Process | None, done: int, seconds: float
) -> Sample:
    of_server, of_engine = _memory(psutil.Process(server)), _memory(engine)
    return Sample(
        simulations=done,
        seconds=round(seconds, 1),
        server_mib=of_server[0],
        server_own_mib=of_server[1],
        engine_mib=of_engine[0],
        engine_own_mib=of_engine[1],
        database_mib=sum(path.stat().st_size for path in data.glob("drivora.sqlite3*")) / _MIB,
    )


def _memory(process: psutil.Process | None) -> tuple[float, float]:
    """Returns the resident memory of a process and its own part, MiB; NaN without a process."""
    with contextlib.suppress(psutil.Error):
        if process is not None:
            found = process.memory_full_info()
            return found.rss / _MIB, found.uss / _MIB
    return float("nan"), float("nan")


def report(measured: Sequence[Sample], state: str, wanted: int, command: str) -> str:
    """Writes the results in Markdown."""
    last = measured[-1]
    settled = [one for one in measured if one.simulations >= _SETTLED * wanted]
    lines = [
        "# Memory in a long campaign",
        "",
        f"{last.simulations:,} of {wanted:,} tiny simulations in one campaign of random search, "
        f"with two workers, in {last.seconds / 60:.0f} minutes (`{command}`); the campaign was "
        f"{state} at the end.",
        "",
        f"Growth and spread are those after the first {_SETTLED:.0%} of the campaign, when caches "
        "are full; the spread is the largest value over the smallest, minus 1.",
        "",
        "| | first | after a tenth | last | most | spread | growth a simulation, bytes |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [_row(name, measured, settled) for name in FITTED]
    lines += ["", "| simulations | minutes | server MiB | engine MiB | database MiB |"]
    lines += ["|---|---|---|---|---|"]
    lines += [
        f"| {one.simulations:,} | {one.seconds / 60:.1f} | {one.server_mib:.1f} | "
        f"{one.engine_mib:.1f} | {one.database_mib:.0f} |"
        for one in measured[:: max(1, len(measured) // 20)]
    ]
    return "\n".join([*lines, ""])


def _row(name: str, measured: Sequence[Sample], settled: Sequence[Sample]) -> str:
    """Writes the row of one quantity."""
    values = np.array([getattr(one, name) for one in settled])
    at = np.array([one.simulations for one in settled], dtype=np.float64)
    known = np.isfinite(values)
    values, at = values[known], at[known]
    every = [value for one in measured if np.isfinite(value := getattr(one, name))]
    words = name.replace("_mib", " MiB").replace("_own", ", own").replace("_", " ")
    if len(values) < 3:
        return f"| {words} | {every[0]:.1f} | | {every[-1]:.1f} | {max(every):.1f} | | |"
    growth = float(np.polyfit(at, values, 1)[0]) * _MIB
    return (
        f"| {words} | {every[0]:.1f} | {values[0]:.1f} | {values[-1]:.1f} | {max(every):.1f} | "
        f"{values.max() / values.min() - 1:.1%} | {growth:+.0f} |"
    )


def main() -> None:
    """Measures, and writes the results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--simulations", type=int, default=100_000)
    parser.add_argument("--tester", default="random", help="method of the campaign")
    parser.add_argument("--most-s", type=float, default=float("inf"), help="seconds at most")
    parser.add_argument("--out", type=Path, help="file for the results in Markdown")
    options = parser.parse_args()
    command = f"python -m benchmarks.campaign_memory --simulations {options.simulations}"
    if options.tester != "random":
        command += f" --tester {options.tester}"
    measured: list[Sample] = []
    with tempfile.TemporaryDirectory() as folder:
        for one, state in samples(
            Path(folder), options.simulations, tester=options.tester, most_s=options.most_s
        ):
            measured.append(one)
            print(one, flush=True)
            if options.out is not None:
                options.out.write_text(report(measured, state, options.simulations, command))
    if options.out is None:
        print(report(measured, state, options.simulations, command))


if __name__ == "__main__":
    main()
