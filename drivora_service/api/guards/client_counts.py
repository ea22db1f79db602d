"""Counts of clients that leave and of those that are cut off, for ``/metrics``."""

from __future__ import annotations

from typing import Literal

from prometheus_client import CollectorRegistry, Counter

During = Literal["request", "answer", "events"]
Reason = Literal["connections", "head", "body", "bodies", "answer", "answers"]


class ClientCounts:
    """What happened to connections.

    Attributes:
        registry: Holds the counts for ``/metrics``.
    """

    def __init__(self) -> None:
        self.registry = CollectorRegistry(auto_describe=False)
        self._left = Counter(
            "drivora_clients_left",
            "Clients that closed the connection in the middle of a request or an answer",
            labelnames=("during",),
            registry=self.registry,
        )
        self._cut_off = Counter(
            "drivora_clients_cut_off",
            "Connections and requests that the service ended, as they were too many or too slow",
            labelnames=("reason",),
            registry=self.registry,
        )
        for during in ("request", "answer", "events"):
            self._left.labels(during)
        for reason in ("connections", "head", "body", "bodies", "answer", "answers"):
            self._cut_off.labels(reason)

    def leave(self, during: During) -> None:
        """Counts a client that has left.

        Args:
            during: The body of a ``request``, an ``answer``, or a stream of ``events``, which ends
                in no other way.
        """
        self._left.labels(during).inc()

    def cut_off(self, reason: Reason) -> None:
        """Counts what the service ended.

        Args:
            reason: A client had too many ``connections``; a ``head`` or ``body`` came too slowly;
                too many ``bodies`` or ``answers`` waited for their client at once; an ``answer``
                was not taken.
        """
        self._cut_off.labels(reason).inc()
