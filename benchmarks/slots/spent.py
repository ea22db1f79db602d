"""The processor time of the processes that hand out runs."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass

import psutil

from benchmarks.slots.simulated_executor import SimulatedExecutor
from drivora_service.execution.executor import Executor
from drivora_service.execution.ray.ray_executor import RayExecutor

_CLUSTER = "tests.execution.ray_cluster"
_DRIVER = "from multiprocessing.spawn import spawn_main"
_NODE = ("ray::Node", "ray::Node.")
"""Ray gives an actor the name of its class, with that of a method while it is called."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spent:
    """Processor time, seconds.

    Attributes:
        own_s: Of this process, without that of simulating slots: the owner.
        driver_s: Of the process that is connected with a Ray cluster; 0 without one.
        nodes_s: Of the actors of its nodes, which supervise their workers.
        ray_s: Of the other processes of Ray, on all nodes.
    """

    own_s: float
    driver_s: float = 0.0
    nodes_s: float = 0.0
    ray_s: float = 0.0

    def since(self, earlier: Spent) -> Spent:
        """Returns what was spent after an earlier time."""
        return Spent(
            own_s=self.own_s - earlier.own_s,
            driver_s=self.driver_s - earlier.driver_s,
            nodes_s=self.nodes_s - earlier.nodes_s,
            ray_s=self.ray_s - earlier.ray_s,
        )


def measure_spent(executor: Executor) -> Spent:
    """Returns the processor time until now of the processes of an executor."""
    if isinstance(executor, RayExecutor):
        return _measure_spent_on_cluster()
    simulated_s = executor.own_s if isinstance(executor, SimulatedExecutor) else 0.0
    return Spent(own_s=time.process_time() - simulated_s)


def _measure_spent_on_cluster() -> Spent:
    """Returns the processor time of the processes of a cluster that this process has started."""
    drivers, nodes, others = [], [], []
    for child in psutil.Process().children():
        if _CLUSTER in child.cmdline():
            for process in child.children(recursive=True):
                if _is_node(process):
                    nodes.append(process)
                elif not _is_of_a_node(process):
                    others.append(process)
        elif any(_DRIVER in word for word in child.cmdline()):
            drivers.append(child)
    return Spent(
        own_s=time.process_time(),
        driver_s=_seconds(drivers),
        nodes_s=_seconds(nodes),
        ray_s=_seconds(others),
    )


def _is_node(process: psutil.Process) -> bool:
    (first, *_) = process.cmdline() or [""]
    return first == _NODE[0] or first.startswith(_NODE[1])


def _is_of_a_node(process: psutil.Process) -> bool:
    """Returns whether the actor of a node has started a process: workers, and their keepers."""
    return any(map(_is_node, process.parents()))


def _seconds(processes: Iterable[psutil.Process]) -> float:
    return sum(process.cpu_times().user + process.cpu_times().system for process in processes)
