"""The executor of a Ray cluster: the slots of all its nodes share a queue."""

from __future__ import annotations

import importlib.util
import threading
import time
from collections import deque
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from types import TracebackType

import structlog

from drivora_service.errors import ConfigurationError
from drivora_service.execution.executor import Limits
from drivora_service.execution.ray.cluster_fault import ClusterFault
from drivora_service.execution.ray.placement import Placement
from drivora_service.execution.ray.ray_connection import Connected, ConnectionLostError
from drivora_service.execution.ray.ray_messages import (
    ClusterSetup,
    FromCluster,
    Members,
    NodeJoined,
    NodeLost,
    NodeNews,
    NodeSetup,
    NodeWithdrew,
    NotConnected,
)
from drivora_service.execution.worker_starts import pause_s
from drivora_service.fault_log import FaultLog
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunSpec
from drivora_service.runs.slot_state import SlotState
from drivora_service.worker.loop import PERFORM, PREPARE, WARM_UP, WorkerTask

_WITHDRAW_S = 5.0
"""Seconds within which nodes return what they have not started."""

_CLOSE_S = 30.0
"""Seconds within which the nodes end their workers."""

_log = structlog.get_logger(__name__)


class RayExecutor:
    """Runs attempts on worker processes of a Ray cluster. Safe to use from several threads.

    Ray is used in a process of its own only, since a driver of Ray that loses its cluster may hang
    or end its process.
    """

    def __init__(
        self,
        *,
        address: str,
        setup: object,
        folder: Path,
        node_folder: Path | None = None,
        slots_per_node: int | None = None,
        limits: Limits = Limits(),  # noqa: B008 # frozen
        perform: str = PERFORM,
        warm_up: str = WARM_UP,
        prepare: str = PREPARE,
    ) -> None:
        """Starts to connect with the cluster; does not wait until it has nodes.

        Args:
            address: Address of the cluster, HOST:PORT, or ``auto`` for that of this machine.
            setup: Configuration of every worker; must be valid on the nodes.
            folder: For the log of the connection; made if it does not exist.
            node_folder: Folder that all nodes share, for the logs of their workers; ``None``: each
                node uses a temporary folder of its own.
            slots_per_node: Worker processes of a node; ``None``: its CPUs as Ray knows them. A
                node without CPUs has none.
            limits: Limits of a worker.
            perform: As of the executor of one machine.
            warm_up: As there.
            prepare: As there.

        Raises:
            ConfigurationError: Ray is not installed.
        """
        if importlib.util.find_spec("ray") is None:
            raise ConfigurationError(
                "the executor `ray` needs the extra `cluster`: pip install 'drivora[cluster]'"
            )
        folder.mkdir(parents=True, exist_ok=True)
        self._setup = ClusterSetup(
            address=address,
            slots_per_node=slots_per_node,
            log=folder / "ray.log",
            node=NodeSetup(
                task=WorkerTask(perform=perform, warm_up=warm_up, prepare=prepare, setup=setup),
                limits=limits,
                folder=node_folder,
                version=version("drivora"),
            ),
        )
        lock = threading.RLock()
        self._work = threading.Condition(lock)
        self._over = threading.Condition(lock)
        self._wanted = 1
        self._placement = Placement()
        self._ended: deque[AttemptEnd] = deque()
        self._woken = False
        self._closed = False
        self._connected: Connected | None = None
        self._members: Members | None = None
        self._cluster_fault = ClusterFault(address)
        self._fault = ""
        self._faults = FaultLog(_log)
        self._closing = threading.Event()
        self._threads = [
            threading.Thread(target=target, name=name, daemon=True)
            for name, target in (("ray-cluster", self._follow), ("ray-orders", self._give_orders))
        ]
        for thread in self._threads:
            thread.start()

    @property
    def capacity(self) -> int:
        """Number of slots of all nodes; at least 1, for runs can wait for the first node."""
        with self._work:
            return max(self._placement.slots, 1)

    @property
    def fault(self) -> str:
        """The reason that no worker can be started and what to do, "" without a fault."""
        return self._fault

    def submit(self, spec: RunSpec) -> None:
        """Queues an attempt, which starts when a slot of any node is free; first in, first out."""
        with self._work:
            if self._closed:
                raise RuntimeError("the executor is closed")
            self._placement.submit(spec)
            self._work.notify()

    def cancel(self, run_id: str) -> None:
        """Ends an attempt; its status is ``cancelled``, or that of its end just before."""
        with self._work:
            self._add_ends(self._placement.cancel(run_id))
            self._work.notify()

    def withdraw(self) -> tuple[str, ...]:
        """Removes every spec that no slot has started; returns the ids of their runs.

        Specs of a node that does not answer in time stay; they go to other nodes if it is lost.
        """
        with self._work:
            # What nodes return stays here until all have answered.
            self._placement.is_held = True
            self._placement.withdraw()
            if self._placement.is_withdrawing:
                self._work.notify_all()
                self._over.wait_for(
                    lambda: self._closed or not self._placement.is_withdrawing, _WITHDRAW_S
                )
            self._placement.is_held = False
            return self._placement.take_waiting()

    def wait(self, timeout: float | None = None, *, count: int = 1) -> tuple[AttemptEnd, ...]:
        """Returns the attempts that have ended since the last call.

        Waits for ``count`` of them, until :meth:`wake` or for ``timeout`` seconds.
        """
        with self._over:
            self._wanted = count
            self._over.wait_for(
                lambda: len(self._ended) >= count or self._woken or self._closed, timeout
            )
            self._wanted = 1
            self._woken = False
            ended = tuple(self._ended)
            self._ended.clear()
        return ended

    def wake(self) -> None:
        """Makes the current or next :meth:`wait` return at once."""
        with self._work:
            self._woken = True
            self._over.notify_all()

    def slots(self) -> tuple[SlotState, ...]:
        """Returns the state of each slot, as its node reported it last, a second ago or less."""
        with self._work:
            return self._placement.states

    def close(self) -> None:
        """Ends every attempt and every worker process of the nodes; nothing is left behind."""
        with self._work:
            self._closed = True
            self._closing.set()
            self._work.notify_all()
            self._over.notify_all()
        for thread in self._threads:
            thread.join()

    def _give_orders(self) -> None:
        """Tells the nodes what to do, as much as possible at once."""
        while True:
            with self._work:
                orders = self._placement.orders()
                while not orders:
                    if self._closed:
                        return
                    self._work.wait()
                    orders = self._placement.orders()
                connected = self._connected
            # Without the lock, for it may block; nodes without a connection have been lost.
            if connected is not None:
                connected.send(orders)

    def _follow(self) -> None:
        """Keeps the connection, and makes it again after it was lost."""
        failures = 0
        while not self._closing.is_set():
            reason = f"the Ray cluster at {self._setup.address} cannot be reached"
            try:
                with Connected(self._setup) as connected:
                    with self._work:
                        self._connected, self._members = connected, None
                        self._cluster_fault = ClusterFault(self._setup.address)
                    while not self._closing.is_set():
                        message = connected.receive()
                        if message is not None:
                            with self._work:
                                self._take(message)
                            failures = 0
                    connected.close(_CLOSE_S)
            except ConnectionLostError as error:
                reason = str(error)
            except Exception as error:
                # The system is short of processes or memory, which passes.
                reason = f"{reason}: {type(error).__name__}: {error}"
            with self._work:
                self._connected, self._members = None, None
                if self._closing.is_set():
                    return
                self._add_ends(self._placement.lose_all(reason))
                self._set_fault(reason)
            failures += 1
            self._faults.error("ray_cluster_lost", reason=reason)
            self._closing.wait(pause_s(failures))

    def _take(self, message: FromCluster) -> None:
        """Takes a message of the cluster; the lock is held."""
        placement = self._placement
        match message:
            case NodeJoined():
                placement.join(message.node, message.slots)
                _log.info("node_joined", node=message.node, slots=message.slots)
            case NodeNews():
                self._add_ends(placement.note(message.node, message.news))
            case NodeWithdrew():
                self._add_ends(placement.put_back(message.node, message.run_ids))
                self._over.notify_all()
            case NodeLost():
                self._add_ends(placement.lose(message.node, message.reason))
                self._over.notify_all()
                self._faults.error("node_lost", node=message.node, reason=message.reason)
            case Members():
                self._members = message
                self._faults.over("ray_cluster_lost", "ray_cluster_connected")
            case NotConnected():
                raise ConnectionLostError(
                    f"the Ray cluster at {self._setup.address} {message.reason}"
                )
        if self._members is not None:
            faults = placement.faults
            self._set_fault(self._cluster_fault.look(self._members, faults, time.monotonic()))
        self._work.notify_all()

    def _set_fault(self, fault: str) -> None:
        begins = bool(fault) and not self._fault
        self._fault = fault
        if begins:
            self._woken = True
            self._over.notify_all()

    def _add_ends(self, ends: Sequence[AttemptEnd]) -> None:
        self._ended += ends
        if len(self._ended) >= self._wanted:
            self._over.notify_all()

    def __enter__(self) -> RayExecutor:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
