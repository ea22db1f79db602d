"""The link to one node: its actor, and two threads that call it."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable
from typing import Any

from drivora_service.execution.ray.node import Node
from drivora_service.execution.ray.ray_messages import (
    FromCluster,
    NodeJoined,
    NodeLost,
    NodeNews,
    NodeSetup,
    NodeWithdrew,
    Orders,
)

_NEWS_S = 0.5
"""Seconds for which a call waits for an end of an attempt: a call takes a millisecond or two."""

_THREADS = 3
"""Calls of a node at once: orders, news, and its end."""

_SHARE = 0.001
"""Part of a CPU that the actor of a node takes of Ray's account: the node does not count as idle,
and the executors of several services may share it."""


class NodeLink:
    """The connection with the slots of a node: passes orders to it and its news back.

    Attributes:
        is_lost: Whether the node, or its actor, is gone.
        has_joined: Whether its slots were started.
        unusable: The reason that they could not be started, or "".
    """

    def __init__(
        self,
        name: str,
        node_id: str,
        slots: int,
        setup: NodeSetup,
        *,
        send: Callable[[FromCluster], None],
    ) -> None:
        """Asks the node to start the slots; does not wait for them.

        Args:
            name: Name of the node.
            node_id: Its id in the cluster.
            slots: Number of its slots.
            setup: Configuration of every node.
            send: Takes messages for the executor; called from several threads.
        """
        self._name, self._slots, self._send = name, slots, send
        self.is_lost = False
        self.has_joined = False
        self.unusable = ""
        self._closing = False
        self._losing = threading.Lock()
        self._orders: queue.SimpleQueue[Orders] = queue.SimpleQueue()
        self._actor = _actor(name, node_id, slots, setup)
        for target in (self._follow, self._give):
            threading.Thread(target=target, name=name, daemon=True).start()

    def give(self, orders: Orders) -> None:
        """Passes orders on, all of them in their order."""
        self._orders.put(orders)

    def close(self, timeout_s: float) -> None:
        """Ends the slots, and waits for it ``timeout_s`` seconds at most."""
        import ray

        self._closing = True
        with contextlib.suppress(ray.exceptions.RayError):
            ray.get(self._actor.close.remote(), timeout=timeout_s)
        with contextlib.suppress(ray.exceptions.RayError):
            ray.kill(self._actor)

    def _follow(self) -> None:
        """Passes the news of the node on."""
        import ray

        try:
            # The first news come as soon as the slots are there.
            news = ray.get(self._actor.news.remote(0.0))
            self.has_joined = True
            self._send(NodeJoined(node=self._name, slots=self._slots))
            while not self.is_lost:
                self._send(NodeNews(node=self._name, news=news))
                news = ray.get(self._actor.news.remote(_NEWS_S))
        except Exception as error:
            self._lose(error)

    def _give(self) -> None:
        """Sends the node its orders; all that wait go in one call."""
        import ray

        try:
            while not self.is_lost:
                orders = [self._orders.get()]
                while not self._orders.empty():
                    orders.append(self._orders.get())
                withdrawn = ray.get(self._actor.carry_out.remote(orders))
                if any(one.withdraw for one in orders):
                    self._send(NodeWithdrew(node=self._name, run_ids=tuple(withdrawn)))
        except Exception as error:
            self._lose(error)

    def lose(self, reason: str) -> None:
        """Marks the node as lost and sends why, unless it is lost already."""
        self._lose(RuntimeError(reason))

    def _lose(self, error: Exception) -> None:
        import ray

        with self._losing:
            if self.is_lost or self._closing:
                return
            # Also where only a call failed: what the node knows is uncertain then.
            with contextlib.suppress(Exception):
                ray.kill(self._actor)
            if self.has_joined:
                self._send(NodeLost(node=self._name, reason=_reason(error)))
            else:
                self.unusable = f"Drivora cannot be started: {_reason(error)}"
            self.is_lost = True


def _actor(name: str, node_id: str, slots: int, setup: NodeSetup) -> Any:
    """Starts the actor of a node, which ends with this process."""
    import ray
    from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

    remote: Any = ray.remote(Node)
    return remote.options(
        scheduling_strategy=NodeAffinitySchedulingStrategy(node_id, soft=False),
        max_concurrency=_THREADS,
        max_restarts=0,
        num_cpus=_SHARE,
    ).remote(name, slots, setup)


def _reason(error: Exception) -> str:
    """Returns the cause of an error in a line; those of Ray hold tracebacks of the node."""
    cause = getattr(error, "cause", None)
    text = str(cause if isinstance(cause, Exception) else error).strip()
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else type(error).__name__
