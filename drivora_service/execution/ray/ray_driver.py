"""The process that is connected with the cluster: a driver of Ray.

It has a link to each node, and passes messages on. It decides nothing about runs.
"""

from __future__ import annotations

import os
import socket
import sys
import threading
import time
from multiprocessing.connection import Connection
from typing import Any

from drivora_service.execution.ray.node_link import NodeLink
from drivora_service.execution.ray.preconditions import explain, require_local_node, require_token
from drivora_service.execution.ray.ray_messages import (
    ClusterSetup,
    FromCluster,
    Members,
    ToCluster,
)
from drivora_service.worker.parent_death import die_with_parent

_LOOK_S = 1.0
"""Seconds between two looks at the nodes of the cluster."""

_AGAIN_S = 15.0
"""Seconds after which a node that was lost or unusable and is alive is tried again."""

_CLOSE_S = 15.0
_REACH_S = 10.0

_ENVIRONMENT = {"RAY_USAGE_STATS_ENABLED": "0"}


def drive(setup: ClusterSetup, pipe: Connection) -> None:
    """Connects with the cluster and passes messages on, until the other end of the pipe closes.

    Args:
        setup: Configuration of the executor.
        pipe: The connection with the executor.
    """
    die_with_parent()
    # The service handles an interrupt typed at a terminal.
    os.setsid()
    _print_to(setup)
    os.environ.update(_ENVIRONMENT)
    is_reached = False
    try:
        reach(setup.address)
        is_reached = setup.address != "auto"
        require_token()
        require_local_node(setup.address)
        import ray

        ray.init(
            address=setup.address,
            log_to_driver=False,
            configure_logging=False,
        )
    except Exception as error:
        pipe.send(explain(error, setup.address, is_reached=is_reached))
        return
    _Driver(setup, pipe).serve()


def reach(address: str) -> None:
    """Checks that an address answers, for Ray itself waits for a minute.

    Raises:
        ValueError: It is no address.
        OSError: Nothing answers there.
    """
    if address == "auto":
        return
    host, separator, port = address.rpartition(":")
    if not (host and separator and port.isdigit()) or "/" in host:
        raise ValueError(f"{address!r} is no address; write HOST:PORT, or auto")
    socket.create_connection((host.strip("[]"), int(port)), timeout=_REACH_S).close()


def _print_to(setup: ClusterSetup) -> None:
    log = os.open(setup.log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)


class _Driver:
    """Keeps a link to each node that is alive."""

    def __init__(self, setup: ClusterSetup, pipe: Connection) -> None:
        self._setup, self._pipe = setup, pipe
        self._sending = threading.Lock()
        self._links: dict[str, NodeLink] = {}
        self._again: dict[str, float] = {}
        self._unusable: dict[str, str] = {}
        self._orders = threading.Thread(target=self._receive, name="orders", daemon=True)
        self._closing = threading.Event()

    def serve(self) -> None:
        """Looks at the nodes until the executor closes the connection."""
        self._orders.start()
        while not self._closing.is_set():
            self._look()
            self._closing.wait(_LOOK_S)
        links = list(self._links.values())
        enders = [threading.Thread(target=link.close, args=(_CLOSE_S,)) for link in links]
        for ender in enders:
            ender.start()
        for ender in enders:
            ender.join(_CLOSE_S)
        import ray

        ray.shutdown()
        sys.stdout.flush()
        # Threads that wait for lost nodes do not keep the process.
        os._exit(0)

    def _look(self) -> None:
        import ray

        alive: list[str] = []
        for node in ray.nodes():
            slots = self._slots_of(node)
            if not (node["Alive"] and slots):
                continue
            name = _name_of(node)
            alive.append(name)
            self._keep_link(name, node["NodeID"], slots)
        for name in self._links.keys() - alive:
            self._links.pop(name).lose("it has left the cluster")
        unusable = {name: reason for name, reason in self._unusable.items() if name in alive}
        self._send(Members(alive=tuple(alive), unusable=unusable))

    def _keep_link(self, name: str, node_id: str, slots: int) -> None:
        """Makes a link to a node that has none; one that was lost is made again after a while."""
        link = self._links.get(name)
        if link is not None and link.is_lost:
            self._again[name] = time.monotonic() + _AGAIN_S
            if link.unusable:
                self._unusable[name] = link.unusable
            del self._links[name]
        elif link is not None and link.has_joined:
            self._unusable.pop(name, None)
        if name not in self._links and time.monotonic() >= self._again.get(name, 0.0):
            self._links[name] = NodeLink(name, node_id, slots, self._setup.node, send=self._send)

    def _slots_of(self, node: dict[str, Any]) -> int:
        """Returns the number of slots of a node; a node without CPUs is to perform no runs."""
        cpus = int(node["Resources"].get("CPU", 0))
        wanted = self._setup.slots_per_node
        return cpus if wanted is None or not cpus else wanted

    def _receive(self) -> None:
        try:
            while True:
                orders: ToCluster = self._pipe.recv()
                if orders is None:
                    break
                for name, one in orders.items():
                    # Without a link the node was lost, which the executor knows or learns soon.
                    if (link := self._links.get(name)) is not None:
                        link.give(one)
        except (EOFError, OSError):
            pass
        self._closing.set()

    def _send(self, message: FromCluster) -> None:
        with self._sending:
            try:
                self._pipe.send(message)
            except OSError:
                self._closing.set()


def _name_of(node: dict[str, Any]) -> str:
    """Returns a name that is unique in the cluster, also for several nodes of one machine."""
    return f"{node['NodeManagerHostname'][:60]}-{node['NodeID'][:8]}"
