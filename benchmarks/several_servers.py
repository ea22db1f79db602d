"""Several servers on one database, killed at random: is every run judged exactly once?

    DRIVORA_DATABASE_URL=postgresql+psycopg://… \\
        python -m benchmarks.several_servers --runs 10000 --out FILE

Servers with one data folder serve an empty database of PostgreSQL. Batches of short
runs and a campaign are posted to any of them. Again and again one of those that perform runs is
killed with SIGKILL, and started anew a while later; one is always left. With ``--hang-every``, one
is also stopped now and then for longer than the others wait for it, while its workers go on, and
continued. What is counted at the end is read from the tables themselves: how many runs ended, how
many have a report and how many ended attempts that count, and whether all runs of one scenario have
the same trace.
Each trace is read, and its hash compared with that of its run.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol

import httpx
from sqlalchemy import create_engine, text

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.observations.trace_files.trace_hash import trace_sha256
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.seed_generation import generate_seeds
from drivora_service.store.database import open_database
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.store.upkeep.store_verification import verify

_START_S, _POLL_S = 180.0, 0.5
_SCENARIOS = 20
_OVER = ("finished", "cancelled", "failed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What is done.

    Attributes:
        runs: Runs that are posted.
        batch: Runs of a batch.
        simulations: Budget of the campaign.
        servers: Servers.
        workers: Workers of each.
        kill_every_s: Mean of the seconds between two kills.
        most_kills: Kills after which there are no more; ``None``: they go on to the end.
        down_s: Seconds for which a killed server is away.
        hang_every_s: Mean of the seconds between two stops of a server that goes on; 0: none.
        hang_s: Seconds for which it is stopped.
        seed: Seed of the moments and of the servers that are killed.
    """

    runs: int
    batch: int = 500
    simulations: int = 200
    servers: int = 3
    workers: int = 1
    kill_every_s: float = 20.0
    most_kills: int | None = None
    down_s: float = 10.0
    hang_every_s: float = 0.0
    hang_s: float = 40.0
    seed: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What the tables say at the end.

    Attributes:
        kills: Servers that were killed.
        hangs: Servers that were stopped for a while.
        refused: Starts of servers that ended because a stopped one kept them from writing.
        seconds: Wall time.
        runs: Runs that were posted.
        finished: Those that ended as finished.
        without_report: Ended runs without a report.
        judged_twice: Runs with more than one attempt that ended as finished.
        interrupted: Attempts that a kill ended.
        different_traces: Scenarios of which two runs differ in their trace.
        contradictions: What `drivora store verify --hashes` finds.
        campaign: State of the campaign.
        evaluations: Its evaluations.
        evaluation_numbers: Different numbers of its evaluations.
    """

    kills: int
    hangs: int
    refused: int
    seconds: float
    runs: int
    finished: int
    without_report: int
    judged_twice: int
    interrupted: int
    different_traces: int
    contradictions: int
    campaign: str
    evaluations: int
    evaluation_numbers: int

    @property
    def is_clean(self) -> bool:
        """Whether everything was judged, and nothing twice."""
        return (
            self.finished == self.runs
            and not (self.without_report or self.judged_twice)
            and not (self.different_traces or self.contradictions)
            and self.campaign == "finished"
            and self.evaluations == self.evaluation_numbers
        )


class Process(Protocol):
    """A process that was started; `subprocess.Popen` has these methods."""

    def poll(self) -> int | None:
        """Returns its exit code, if it has ended."""

    def wait(self, timeout: float | None = None) -> int:
        """Waits for its end, and returns its exit code."""

    def send_signal(self, number: int, /) -> None:
        """Sends it a signal."""


Begin = Callable[[Sequence[str], Mapping[str, str], Path], Process]
"""Starts ``drivora`` with arguments and an environment, and appends what it prints to a file."""


def begin_command(arguments: Sequence[str], environment: Mapping[str, str], log: Path) -> Process:
    """Starts ``drivora`` as a shell does."""
    with log.open("ab") as output:
        return subprocess.Popen(
            [sys.executable, "-m", "drivora_service.cli", *arguments],
            stdout=output,
            stderr=output,
            env=environment,
        )


@dataclass(slots=True)
class Server:
    """A server that may be killed and started again, at the same address, or stopped."""

    folder: Path
    name: str
    workers: int
    begin: Begin = begin_command
    port: int = field(default_factory=lambda: _free_port())
    process: Process | None = None
    killed_at: float = 0.0
    continues_at: float | None = None
    was_ready: bool = False

    @property
    def address(self) -> str:
        """Address of its API."""
        return f"http://127.0.0.1:{self.port}/api/v1"

    @property
    def is_alive(self) -> bool:
        """Whether it was started, and not killed."""
        return self.process is not None

    @property
    def has_ended(self) -> bool:
        """Whether it has ended by itself."""
        return self.process is not None and self.process.poll() is not None

    @property
    def works(self) -> bool:
        """Whether it is alive, and not stopped."""
        return self.is_alive and self.continues_at is None

    def hang(self, seconds: float) -> None:
        """Stops it for so long; its workers go on."""
        if self.process is not None:
            self.process.send_signal(signal.SIGSTOP)
            self.continues_at = time.monotonic() + seconds

    def go_on(self) -> None:
        """Continues it after a stop."""
        if self.process is not None and self.continues_at is not None:
            self.process.send_signal(signal.SIGCONT)
        self.continues_at = None

    def start(self) -> None:
        """Starts it."""
        self.was_ready = False
        options = ["--data-dir", str(self.folder), "--workers", str(self.workers)]
        self.process = self.begin(
            ["serve", *options, "--host", "127.0.0.1", "--port", str(self.port)],
            {**os.environ, "DRIVORA_DRAIN_S": "0"},
            self.folder / f"{self.name}.log",
        )

    def is_ready(self) -> bool:
        """Returns whether it answers, and can work.

        Raises:
            RuntimeError: It has ended by itself after it was ready.
        """
        if self.has_ended and self.was_ready:
            log = (self.folder / f"{self.name}.log").read_text(errors="replace")
            raise RuntimeError(f"server {self.name} has ended:\n{log[-2000:]}")
        with contextlib.suppress(httpx.HTTPError):
            answer = httpx.get(f"http://127.0.0.1:{self.port}/readyz", timeout=10.0)
            self.was_ready |= answer.is_success
            return answer.is_success
        return False

    def is_busy(self) -> bool:
        """Returns whether one of its workers performs a run."""
        with contextlib.suppress(httpx.HTTPError):
            found = httpx.get(f"{self.address}/workers", timeout=10.0).raise_for_status().json()
            return any(slot["is_own"] and slot["state"] == "running" for slot in found["slots"])
        return False

    def end(self, signal_number: int) -> None:
        """Sends a signal and waits for the end."""
        self.go_on()
        if self.process is not None:
            self.process.send_signal(signal_number)
            # One on a busy machine finishes the requests that it has, and its workers.
            self.process.wait(300.0)
            self.process, self.killed_at = None, time.monotonic()


class Fleet:
    """The servers, of which one is killed or stopped now and then."""

    def __init__(self, folder: Path, plan: Plan, begin: Begin) -> None:
        """Starts all of them, and waits until they are ready."""
        self._plan, self._random = plan, random.Random(plan.seed)
        names = [f"server-{number}" for number in range(plan.servers)]
        self.servers = [Server(folder, name, plan.workers, begin) for name in names]
        self.kills = self.hangs = self.refused = 0
        for server in self.servers:
            server.start()
        deadline = time.monotonic() + _START_S
        while not all(server.is_ready() for server in self.servers):
            if time.monotonic() > deadline:
                raise RuntimeError("the servers are not ready in time")
            time.sleep(_POLL_S)
        self._kill_at = self._next(plan.kill_every_s)
        self._hang_at = self._next(plan.hang_every_s or math.inf)

    def turn(self) -> None:
        """Kills or stops a server if it is time, unless no other one works, and starts others."""
        now = time.monotonic()
        for server in self.servers:
            if not server.is_alive and now >= server.killed_at + self._plan.down_s:
                server.start()
            elif server.has_ended and not server.was_ready and self.hangs:
                # As a service manager does.
                self.refused += 1
                server.start()
            if server.continues_at is not None and now >= server.continues_at:
                server.go_on()
        if now < min(self._kill_at, self._hang_at):
            return
        ready = [server for server in self.servers if server.works and server.is_ready()]
        if len(ready) < 2:
            return
        # The end of one that performs nothing, as of one that has just started, shows little.
        chosen = self._random.choice([one for one in ready if one.is_busy()] or ready)
        if now >= self._kill_at:
            chosen.end(signal.SIGKILL)
            self.kills += 1
            most = self._plan.most_kills
            is_last = most is not None and self.kills >= most
            self._kill_at = self._next(math.inf if is_last else self._plan.kill_every_s)
        else:
            chosen.hang(self._plan.hang_s)
            self.hangs += 1
            self._hang_at = self._next(self._plan.hang_every_s)

    def request(self, method: str, path: str, **options: Any) -> dict[str, Any]:
        """Asks any server that answers; what is posted needs a key, as it may be posted twice."""
        deadline = time.monotonic() + _START_S
        while time.monotonic() < deadline:
            server = self._random.choice(self.servers)
            if server.works:
                with contextlib.suppress(httpx.TransportError):
                    answer = httpx.request(method, server.address + path, timeout=60.0, **options)
                    if answer.status_code not in (409, 503):
                        found: dict[str, Any] = answer.raise_for_status().json()
                        return found
            self.turn()
            time.sleep(_POLL_S)
        raise RuntimeError(f"no server has answered {method} {path}")

    def stop(self) -> None:
        """Ends all servers."""
        for server in self.servers:
            server.end(signal.SIGINT)

    def _next(self, mean_s: float) -> float:
        return time.monotonic() + self._random.uniform(0.5, 1.5) * mean_s


def measure(url: str, folder: Path, plan: Plan, begin: Begin = begin_command) -> Outcome:
    """Serves, kills and counts.

    Args:
        url: Address of an empty database of PostgreSQL.
        folder: Data folder of all servers.
        plan: What is done.
        begin: Begins the servers.
    """
    begun = time.monotonic()
    os.environ["DRIVORA_DATABASE_URL"] = url
    fleet = Fleet(folder, plan, begin)
    try:
        campaign = fleet.request(
            "POST",
            "/campaigns",
            json=_campaign(plan.simulations),
            headers={"Idempotency-Key": "campaign"},
        )
        batches = [
            fleet.request(
                "POST",
                "/batches",
                content=lines,
                headers={
                    "Content-Type": "application/x-ndjson",
                    "Idempotency-Key": f"batch {number}",
                },
            )["batch"]["id"]
            for number, lines in enumerate(_batches(plan))
        ]
        while not (_is_over(fleet, campaign["id"]) and _are_done(fleet, batches)):
            fleet.turn()
            time.sleep(_POLL_S)
    finally:
        fleet.stop()
    seconds = time.monotonic() - begun
    return _count(url, plan, campaign["id"], fleet, seconds, _count_contradictions(url, folder))


def _count_contradictions(url: str, folder: Path) -> int:
    database = open_database(url)
    try:
        traces = TraceFolder(folder / "traces")
        found = verify(database, traces, hash_trace=lambda path: trace_sha256(read_trace(path)))
        return len(list(found))
    finally:
        database.close()


def _is_over(fleet: Fleet, campaign_id: str) -> bool:
    return fleet.request("GET", f"/campaigns/{campaign_id}")["state"] in _OVER


def _are_done(fleet: Fleet, batches: list[str]) -> bool:
    """Returns whether all batches have ended; forgets those that have."""
    while batches:
        counts = fleet.request("GET", f"/batches/{batches[0]}")["counts"]
        if counts.get("queued", 0) + counts.get("running", 0):
            return False
        del batches[0]
    return True


def _campaign(simulations: int) -> dict[str, Any]:
    return {
        "name": "several servers",
        "tester": {"name": "avfuzzer"},
        "agent": {"name": "idm"},
        "scenario": SCENARIO,
        "space": {"vehicles": 2, "walkers": 1},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": simulations},
        "seed": 3,
    }


def _batches(plan: Plan) -> Iterator[str]:
    """Yields the lines of batches of short drives."""
    network = NetworkCatalogue(shipped_networks()).get("tee-town")
    seeds = generate_seeds(
        network, count=_SCENARIOS, min_length=60, max_length=150, seed=4, agent="idm"
    )
    lines = [json.dumps(json.loads(document_text(seed))) for seed in seeds]
    for first in range(0, plan.runs, plan.batch):
        numbers = range(first, min(first + plan.batch, plan.runs))
        yield "\n".join(lines[number % _SCENARIOS] for number in numbers)


def _count(
    url: str, plan: Plan, campaign_id: str, fleet: Fleet, seconds: float, contradictions: int
) -> Outcome:
    engine = create_engine(url)
    with engine.connect() as connection:

        def number(query: str) -> int:
            return int(connection.scalar(text(query), {"campaign": campaign_id}) or 0)

        posted = (
            "runs JOIN batches ON batches.seq = runs.batch_seq "
            "WHERE batches.id NOT IN (SELECT batch_id FROM campaigns)"
        )
        of_campaign = "campaigns JOIN evaluations ON campaign_seq = campaigns.seq"
        outcome = Outcome(
            kills=fleet.kills,
            hangs=fleet.hangs,
            refused=fleet.refused,
            seconds=round(seconds, 1),
            runs=plan.runs,
            finished=number(f"SELECT count(*) FROM {posted} AND runs.status = 'finished'"),
            without_report=number(
                f"SELECT count(*) FROM {posted} "
                "AND NOT EXISTS (SELECT FROM reports WHERE run_seq = runs.seq)"
            ),
            judged_twice=number(
                "SELECT count(*) FROM (SELECT run_seq FROM attempts WHERE outcome = 'finished' "
                "GROUP BY run_seq HAVING count(*) > 1) AS twice"
            ),
            interrupted=number("SELECT count(*) FROM attempts WHERE outcome = 'interrupted'"),
            different_traces=number(
                f"SELECT count(*) FROM (SELECT document_sha256 FROM {posted} "
                "GROUP BY document_sha256 HAVING count(DISTINCT trace_sha256) > 1) AS different"
            ),
            contradictions=contradictions,
            campaign=str(
                connection.scalar(
                    text("SELECT state FROM campaigns WHERE id = :campaign"),
                    {"campaign": campaign_id},
                )
            ),
            evaluations=number(f"SELECT count(*) FROM {of_campaign} WHERE id = :campaign"),
            evaluation_numbers=number(
                f"SELECT count(DISTINCT number) FROM {of_campaign} WHERE id = :campaign"
            ),
        )
    engine.dispose()
    return outcome


def _free_port() -> int:
    with socket.socket() as made:
        made.bind(("127.0.0.1", 0))
        port: int = made.getsockname()[1]
    return port


def main(arguments: Sequence[str]) -> None:
    """Serves, kills, counts, and prints what was counted; exit code 1 if it is not clean."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--simulations", type=int, default=500)
    parser.add_argument("--workers", type=int, default=1, help="of each server")
    parser.add_argument("--kill-every", type=float, default=30.0, help="seconds, the mean")
    parser.add_argument("--hang-every", type=float, default=0.0, help="seconds; 0: no server hangs")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="file of the result, as JSON")
    options = parser.parse_args(arguments)
    url = os.environ.get("DRIVORA_DATABASE_URL", "")
    if not url.startswith("postgres"):
        parser.error("set DRIVORA_DATABASE_URL to an empty database of PostgreSQL")
    plan = Plan(
        runs=options.runs,
        simulations=options.simulations,
        workers=options.workers,
        kill_every_s=options.kill_every,
        hang_every_s=options.hang_every,
        seed=options.seed,
    )
    with tempfile.TemporaryDirectory(prefix="drivora-servers-") as folder:
        outcome = measure(url, Path(folder), plan)
    told = json.dumps({**asdict(plan), **asdict(outcome)}, indent=1)
    print(told)
    if options.out is not None:
        options.out.write_text(told + "\n")
    sys.exit(0 if outcome.is_clean else 1)


if __name__ == "__main__":
    main(sys.argv[1:])
