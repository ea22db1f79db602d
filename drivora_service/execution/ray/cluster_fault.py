"""When a cluster is of no use, and why."""

from __future__ import annotations

from collections.abc import Mapping

from drivora_service.execution.ray.ray_messages import Members

_NO_NODE_S = 10.0
"""Seconds without a node after which that is a fault; another may be joining."""


class ClusterFault:
    """Finds out whether a connected cluster can start workers, from the lists of its nodes."""

    def __init__(self, address: str) -> None:
        """Creates the judge of a cluster, without a fault.

        Args:
            address: Address of the cluster, for messages.
        """
        self._address = address
        self._empty_since: float | None = None
        self._fault = ""

    def look(self, members: Members, faults: Mapping[str, str], now: float) -> str:
        """Returns the fault of a cluster, "" without one.

        Args:
            members: The nodes of the cluster.
            faults: Faults of those that have joined, "" without one.
            now: Seconds of a monotonic clock.
        """
        if members.alive:
            self._empty_since = None
            known = {**faults, **members.unusable}
            faulty = [name for name in members.alive if known.get(name)]
            all_are = len(faulty) == len(members.alive)
            self._fault = f"on the node {faulty[0]}: {known[faulty[0]]}" if all_are else ""
        elif self._empty_since is None:
            self._empty_since = now
        elif now - self._empty_since > _NO_NODE_S:
            self._fault = (
                f"no node of the Ray cluster at {self._address} is alive that has CPUs; start one "
                "with `ray start`"
            )
        return self._fault
