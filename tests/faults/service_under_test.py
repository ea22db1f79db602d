"""A real service in a process, seen from outside: HTTP, SQL, /proc, exit codes, files."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import psutil

from tests.faults import processes
from tests.faults.work import Run

WORKERS = 2
AGENT_DEADLINE_S = 3.0
MEMORY_LIMIT_MB = 700
START_S = 240.0
LIMITS = {
    "DRIVORA_AGENT_DEADLINE_S": f"{AGENT_DEADLINE_S:g}",
    "DRIVORA_MEMORY_LIMIT_MB": str(MEMORY_LIMIT_MB),
    "DRIVORA_WALL_TIME_LIMIT_S": "30",
}
ROOT = Path(__file__).resolve().parents[2]
AGENTS = Path(__file__).with_name("agents")
DISTRIBUTION = "faulty_agents-1.0.dist-info"
_PLUGIN = re.compile(r'^(\w+) = plugin\("([\w-]+)"', re.MULTILINE)


def install_agents(site: Path) -> None:
    """Makes the agents of these tests a distribution that Python finds on its path."""
    names = []
    for module in sorted(AGENTS.glob("*.py")):
        for name, agent in _PLUGIN.findall(module.read_text()):
            names.append(f"{agent} = tests.faults.agents.{module.stem}:{name}")
    info = site / DISTRIBUTION
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: faulty-agents\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("\n".join(["[drivora_service.agents]", *names, ""]))


@dataclass(eq=False)
class Service:
    """One data folder and the server that serves it, if one does.

    Attributes:
        folder: Holds the data folder, and the distribution with the agents.
        variables: Environment variables of the server besides the usual.
        prefix: Command and options that start the server's command.
        starts: Servers that were started.
    """

    folder: Path
    variables: Mapping[str, str] = field(default_factory=dict)
    prefix: Sequence[str] = ()
    starts: int = 0
    process: subprocess.Popen[bytes] | None = None
    url: str = ""

    @property
    def data(self) -> Path:
        """The data folder."""
        return self.folder / "data"

    @property
    def site(self) -> Path:
        """The folder of the agents' code; every process of the service has it as PYTHONPATH."""
        return self.folder / "site"

    @property
    def evidence(self) -> Path:
        """Folder for the evidence of hostile agents."""
        return self.site / "evidence"

    @property
    def log(self) -> Path:
        """The output of all servers of this folder."""
        return self.folder / "service.log"

    @property
    def pid(self) -> int:
        """The server's process id, whatever command and namespace it was started in."""
        assert self.process is not None
        return processes.server(self.process.pid)

    def start(self) -> None:
        """Starts a server and waits until it is ready."""
        self.launch()
        self.wait_until_ready()

    def launch(self) -> None:
        """Starts a server, and waits for nothing."""
        self.data.mkdir(parents=True, exist_ok=True)
        if not self.site.exists():
            install_agents(self.site)
            self.evidence.mkdir()
        (self.data / "service.json").unlink(missing_ok=True)
        command = [*self.prefix, sys.executable, "-m", "drivora_service.cli", "serve"]
        options = ["--data-dir", str(self.data), "--workers", str(WORKERS), "--port", "0"]
        environment = (
            os.environ | LIMITS | {"PYTHONPATH": f"{self.site}:{ROOT}"} | dict(self.variables)
        )
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                [*command, *options], stdout=log, stderr=log, env=environment, cwd=self.folder
            )
        self.starts += 1

    def wait_until_ready(self, *, seconds: float = START_S) -> None:
        """Waits until the server is ready for work.

        Raises:
            AssertionError: It is not in time, or has ended.
        """

        def ready() -> bool:
            code = self.process.poll() if self.process else None
            assert code is None, f"the server ended with {code}: {self.log_tail()}"
            return self.is_ready()

        processes.wait_until(ready, seconds=seconds, what=f"not ready; {self.readiness()}")

    def is_ready(self) -> bool:
        """Whether /readyz answers 200."""
        with contextlib.suppress(OSError, ValueError, KeyError, httpx.HTTPError):
            self.url = json.loads((self.data / "service.json").read_text())["url"]
            return httpx.get(f"{self.url}/readyz", timeout=10.0).is_success
        return False

    def readiness(self) -> str:
        """Returns what /readyz answers, for messages."""
        with contextlib.suppress(httpx.HTTPError, httpx.UnsupportedProtocol):
            return httpx.get(f"{self.url}/readyz", timeout=10.0).text
        return f"no answer; {self.log_tail()}"

    def log_tail(self) -> str:
        """Returns the last lines that the servers printed."""
        return self.log.read_text(errors="replace")[-2000:] if self.log.exists() else ""

    @contextlib.contextmanager
    def client(self, *, timeout: float = 60.0) -> Iterator[httpx.Client]:
        """Returns a client of the API."""
        with httpx.Client(base_url=f"{self.url}/api/v1", timeout=timeout) as client:
            yield client

    def post(self, runs: Sequence[Run], *, timeout: float = 60.0) -> Work:
        """Posts a batch; every run of it must be accepted."""
        with self.client(timeout=timeout) as client:
            answer = client.post(
                "/batches",
                content="\n".join(run.document for run in runs),
                headers={"Content-Type": "application/x-ndjson"},
            )
        submitted = answer.raise_for_status().json()
        assert submitted["accepted"] == len(runs), submitted
        ids = [item["job_id"] for item in submitted["items"]]
        return Work(batch=submitted["batch"]["id"], runs=dict(zip(ids, runs, strict=True)))

    def query(self, statement: str, *values: object) -> list[dict[str, Any]]:
        """Reads the database itself."""
        path = self.data / "drivora.sqlite3"
        with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as connection:
            connection.row_factory = sqlite3.Row
            return [dict(row) for row in connection.execute(statement, values)]

    def statuses(self, work: Work) -> dict[str, str]:
        """Returns the status of each run of some work, from the database."""
        rows = self.query(
            "SELECT r.id, r.status FROM runs r JOIN batches b ON b.seq = r.batch_seq "
            "WHERE b.id = ?",
            work.batch,
        )
        return {row["id"]: row["status"] for row in rows}

    def ended(self, work: Work) -> int:
        """Counts the runs that have ended."""
        waiting = ("queued", "running")
        return sum(status not in waiting for status in self.statuses(work).values())

    def wait_until_ended(self, work: Work, count: int, *, seconds: float = 100.0) -> None:
        """Waits until so many runs have ended."""
        what = f"fewer than {count} of {len(work.runs)} runs have ended"
        processes.wait_until(lambda: self.ended(work) >= count, seconds=seconds, what=what)

    def fork_server(self) -> psutil.Process:
        """Returns the fork server, waiting for it if need be.

        One that was killed by an earlier test is replaced only when a worker has to be started.
        """
        if processes.fork_server(self.pid) is None:
            for worker in self.workers()[:1]:
                processes.send(worker, signal.SIGKILL)
        processes.wait_until(
            lambda: processes.fork_server(self.pid), seconds=30, what="there is no fork server"
        )
        found = processes.fork_server(self.pid)
        assert found is not None
        return found

    def workers(self) -> tuple[psutil.Process, ...]:
        """Returns the worker processes, waiting until all are there."""
        processes.wait_until(
            lambda: len(processes.workers(self.data / "workers")) == WORKERS,
            seconds=60,
            what="not all workers are there",
        )
        return processes.workers(self.data / "workers")

    def kill(self) -> None:
        """Kills the server and waits until it is gone."""
        self.signal(signal.SIGKILL)
        assert self.process is not None
        self.process.wait(30.0)

    def signal(self, number: signal.Signals) -> None:
        """Sends a signal to the server itself, whatever command started it."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, number)

    def stop(self) -> None:
        """Ends the server, and whatever is left of its processes."""
        if self.process is not None:
            self.process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(20.0)
        for process in self.leftovers():
            processes.send(process, signal.SIGKILL)
        if self.process is not None:
            self.process.wait(20.0)
            self.process = None

    def leftovers(self) -> list[psutil.Process]:
        """Returns the processes that were started by servers of this folder and still live."""
        return processes.with_variable("PYTHONPATH", f"{self.site}:{ROOT}")

    def latency(self, path: str) -> float:
        """Returns the seconds that an answer takes, whatever its status."""
        begun = time.monotonic()
        httpx.get(f"{self.url}{path}", timeout=30.0)
        return time.monotonic() - begun


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """A batch that was accepted.

    Attributes:
        batch: Its id.
        runs: What was asked for, by the id that the service gave it.
    """

    batch: str
    runs: Mapping[str, Run]

    def ids(self, agent: str) -> list[str]:
        """Returns the ids of the runs of one agent."""
        return [run_id for run_id, run in self.runs.items() if run.agent == agent]
