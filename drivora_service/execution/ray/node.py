"""One node of the cluster: its slots, within an actor of Ray."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

from drivora_service.errors import ConfigurationError
from drivora_service.execution.local import LocalExecutor
from drivora_service.execution.ray.ray_messages import News, NodeSetup, Orders
from drivora_service.networks.catalogue import shipped_networks
from drivora_service.worker.setup import WorkerSetup

_TOGETHER_S = 0.2
"""Seconds for which ends are collected; the pace of a node holds runs for several times as long."""


class Node:
    """The slots of a node: those of the executor of one machine.

    Its methods are called over the network, by several threads: each call does much at once.
    """

    def __init__(self, name: str, slots: int, setup: NodeSetup) -> None:
        """Starts the slots; does not wait until their workers are ready.

        Args:
            name: Name of the node, which the names of its slots begin with.
            slots: Number of slots.
            setup: Configuration of every node.

        Raises:
            ConfigurationError: The node has another version of Drivora, or cannot start workers.
        """
        if (found := version("drivora")) != setup.version:
            raise ConfigurationError(
                f"the node has Drivora {found}, and the service has {setup.version}; install the "
                "same version on all nodes"
            )
        _forget_main_module()
        self._name, self._slots = name, slots
        # Approximate, as two threads change it; it only decides how long ends are collected.
        self._held = 0
        self._temporary: tempfile.TemporaryDirectory[str] | None = None
        if setup.folder is None:
            self._temporary = tempfile.TemporaryDirectory(prefix="drivora-")
            folder = Path(self._temporary.name)
        else:
            folder = setup.folder / name
        task = setup.task
        self._executor = LocalExecutor(
            slots=slots,
            setup=_setup_here(task.setup),
            folder=folder,
            limits=setup.limits,
            perform=task.perform,
            warm_up=task.warm_up,
            prepare=task.prepare,
        )

    def carry_out(self, orders: Sequence[Orders]) -> tuple[str, ...]:
        """Carries out orders; returns the ids of the runs that were withdrawn."""
        withdrawn: list[str] = []
        for one in orders:
            for spec in one.submit:
                self._executor.submit(spec)
            self._held += len(one.submit)
            for run_id in one.cancel:
                self._executor.cancel(run_id)
            if one.withdraw:
                withdrawn += self._executor.withdraw()
                self._held -= len(withdrawn)
        return tuple(withdrawn)

    def news(self, timeout_s: float) -> News:
        """Waits for the end of an attempt, for ``timeout_s`` seconds at most; returns the news.

        While there are runs for all slots, ends are collected for a moment: a call costs the
        processors of node and service some milliseconds, as long as a short run in part.
        """
        enough = self._held - 2 * self._slots
        if enough > 1:
            ends = self._executor.wait(min(timeout_s, _TOGETHER_S), count=enough)
        else:
            ends = self._executor.wait(timeout_s)
        self._held -= len(ends)
        return News(
            ends=tuple(replace(end, worker=self._cluster_name(end.worker)) for end in ends),
            slots=tuple(
                replace(slot, name=self._cluster_name(slot.name)) for slot in self._executor.slots()
            ),
            fault=self._executor.fault,
        )

    def close(self) -> None:
        """Ends every attempt and every worker process of the node."""
        self._executor.close()
        if self._temporary is not None:
            self._temporary.cleanup()

    def _cluster_name(self, slot: str) -> str:
        """Returns the name of a slot among those of the cluster; "" for none."""
        return f"{self._name}/{slot}" if slot else ""


def _forget_main_module() -> None:
    """Keeps the fork server from importing Ray's own main module, as it does with any program's."""
    vars(sys.modules["__main__"]).pop("__file__", None)
    # Ray starts its processes in a folder of temporary files, which may be removed.
    os.chdir("/")


def _setup_here(setup: object) -> object:
    """Returns the set-up of a worker of this node, whose installation may be in another folder."""
    if isinstance(setup, WorkerSetup):
        return replace(setup, shipped_networks=shipped_networks())
    return setup
