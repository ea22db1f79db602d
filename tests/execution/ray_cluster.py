"""A real Ray cluster on this machine: each node has processes of its own.

It is in a process of its own, so that the tests themselves do not load Ray.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil

_ROOT = Path(__file__).resolve().parents[2]
_END_S = 60.0

ENVIRONMENT = {
    "RAY_USAGE_STATS_ENABLED": "0",
    # Else Ray lets its processes, and so the workers, give way to all others of the machine.
    "RAY_worker_niceness": "0",
    # The memory of this machine is used by others, too: no process is ended for it.
    "RAY_memory_monitor_refresh_ms": "0",
    # Of a machine that is busy with other tests.
    "RAY_raylet_start_wait_time_s": "180",
    # A node that was killed refuses connections, and is noticed in seconds; one that is only slow
    # has the whole time-out of each check.
    "RAY_health_check_initial_delay_ms": "1000",
    "RAY_health_check_period_ms": "200",
    "RAY_health_check_failure_threshold": "15",
    # For so long nodes look for a head that is gone before they end; usually a minute.
    "RAY_gcs_rpc_server_reconnect_timeout_s": "10",
}


SILENCE_S = 12.0
"""Seconds without news after which a test takes a cluster that it has ended for lost."""


class Cluster:
    """A cluster that runs.

    Attributes:
        address: Its address, once it has begun.
        nodes: Ids of the nodes that perform runs.
    """

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self.address = ""
        self.nodes: list[str] = []

    def begin(self) -> None:
        """Waits until the cluster has its first node."""
        self.address = self._read()

    def add(self, cpus: int) -> str:
        """Adds a node; returns its id."""
        self.nodes.append(self._ask(f"add {cpus}"))
        return self.nodes[-1]

    def kill(self, node: str) -> None:
        """Kills a node with all its processes."""
        self._ask(f"kill {node}")
        self.nodes.remove(node)

    def end(self) -> None:
        """Ends the cluster with all its nodes."""
        with contextlib.suppress(OSError, ValueError):
            self._process.communicate("", timeout=_END_S)
        self._process.kill()
        self._process.wait()

    def _ask(self, command: str) -> str:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{command}\n")
        self._process.stdin.flush()
        return self._read()

    def _read(self) -> str:
        assert self._process.stdout is not None
        answer = self._process.stdout.readline()
        assert answer.startswith("> "), answer
        return answer.removeprefix("> ").strip()


def until(holds: Callable[[], object], *, within_s: float = 180.0) -> None:
    """Waits until something holds on the cluster."""
    limit = time.monotonic() + within_s
    while not holds():
        assert time.monotonic() < limit
        time.sleep(0.05)


@contextmanager
def ray_cluster(*cpus: int) -> Iterator[Cluster]:
    """Yields a cluster of a head node without CPUs and of a node for each number of them."""
    # Sockets have short paths.
    with tempfile.TemporaryDirectory(prefix="ray-", ignore_cleanup_errors=True) as folder:
        process = subprocess.Popen(
            [sys.executable, "-m", "tests.execution.ray_cluster"],
            cwd=_ROOT,
            env={**os.environ, **ENVIRONMENT, "RAY_TMPDIR": folder, "PYTHONPATH": str(_ROOT)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        cluster = Cluster(process)
        try:
            cluster.begin()
            for number in cpus:
                cluster.add(number)
            yield cluster
        finally:
            cluster.end()


@contextmanager
def supervised_node(*options: str, folder: Path) -> Iterator[psutil.Process]:
    """Starts a node as an operator does, and again whenever it ends, as a supervisor does.

    Args:
        options: Options of ``ray start``.
        folder: A folder with a short path, in which the node has one for its temporary files: nodes
            that share one and start at the same time take the same sockets.

    Yields:
        The supervisor, which is killed with the node at the end.
    """
    start = [str(Path(sys.executable).parent / "ray"), "start", *options, "--block"]
    # Else all nodes of a machine have the folder of the head.
    start += ["--object-store-memory=80000000", f"--temp-dir={tempfile.mkdtemp(dir=folder)}"]
    with (folder / "ray-start.log").open("ab") as log:
        process = subprocess.Popen(
            ["sh", "-c", 'while true; do "$@"; sleep 1; done', "sh", *start],
            env={**os.environ, **ENVIRONMENT},
            stdout=log,
            stderr=subprocess.STDOUT,
        )
    supervisor = psutil.Process(process.pid)
    try:
        yield supervisor
    finally:
        # It starts nothing while its processes are listed.
        supervisor.suspend()
        kill_node(supervisor)
        process.kill()
        process.wait()


def kill_node(supervisor: psutil.Process) -> None:
    """Kills all processes of a node, which its supervisor then starts again."""
    for one in supervisor.children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            one.kill()


def main() -> None:
    """Starts a cluster, obeys commands, and ends it when there are no more."""
    from ray.cluster_utils import Cluster as RayCluster

    arguments = {"num_gpus": 0, "object_store_memory": 80 << 20, "include_dashboard": False}
    answers = os.fdopen(os.dup(1), "w")
    # What Ray prints is not shown.
    os.dup2(2, 1)
    cluster: Any = RayCluster(initialize_head=True, head_node_args={"num_cpus": 0, **arguments})
    nodes = {cluster.head_node.node_id: cluster.head_node}
    print(f"> {cluster.address}", file=answers, flush=True)
    for line in sys.stdin:
        command, argument = line.split()
        answer = "done"
        if command == "add":
            node = cluster.add_node(num_cpus=int(argument), **arguments)
            nodes[node.node_id] = node
            answer = str(node.node_id)
        else:
            cluster.remove_node(nodes.pop(argument), allow_graceful=False)
        print(f"> {answer}", file=answers, flush=True)
    cluster.shutdown()


if __name__ == "__main__":
    main()
