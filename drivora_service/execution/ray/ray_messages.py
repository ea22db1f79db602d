"""What the executor, the process that is connected with the cluster, and the nodes exchange."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from drivora_service.execution.executor import Limits
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.run_report import RunSpec
from drivora_service.runs.slot_state import SlotState
from drivora_service.worker.loop import WorkerTask


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeSetup:
    """The configuration of every node.

    Attributes:
        task: Task of the workers.
        limits: Limits of a worker.
        folder: Folder that all nodes share, in which each makes one for the logs of its workers;
            ``None``: each uses a temporary folder of its own.
        version: Version of Drivora that a node must have.
    """

    task: WorkerTask
    limits: Limits
    folder: Path | None
    version: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ClusterSetup:
    """The configuration of the process that is connected with the cluster.

    Attributes:
        address: Address of the cluster, HOST:PORT, or ``auto`` for that of this machine.
        slots_per_node: Slots of each node that has CPUs; ``None``: as many as these.
        log: File for what the process prints.
        node: Configuration of every node.
    """

    address: str
    slots_per_node: int | None
    log: Path
    node: NodeSetup


@dataclass(frozen=True, slots=True, kw_only=True)
class Orders:
    """Orders for one node, which are carried out in the order of the attributes.

    Attributes:
        submit: Attempts to queue.
        cancel: Ids of the runs whose attempts are to be ended.
        withdraw: Whether to return what was not started.
    """

    submit: tuple[RunSpec, ...] = ()
    cancel: tuple[str, ...] = ()
    withdraw: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class News:
    """What a node reports.

    Attributes:
        ends: Attempts that have ended since the last news.
        slots: State of each slot.
        fault: The reason that no worker of the node can be started, "" without a fault.
    """

    ends: tuple[AttemptEnd, ...]
    slots: tuple[SlotState, ...]
    fault: str


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeJoined:
    """A node is ready for runs."""

    node: str
    slots: int


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeNews:
    """A node has reported."""

    node: str
    news: News


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeWithdrew:
    """A node has returned the runs that it had not started, first in, first out."""

    node: str
    run_ids: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeLost:
    """A node is gone, with all that it had not reported."""

    node: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Members:
    """The nodes of the cluster; sent once a second as long as the cluster answers.

    Attributes:
        alive: Names of the nodes that have or will have slots.
        unusable: Those of them on which Drivora cannot be started, with the reasons.
    """

    alive: tuple[str, ...]
    unusable: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class NotConnected:
    """The cluster cannot be used; the process ends.

    Attributes:
        reason: What was found and what to do, as the rest of a sentence about the cluster.
    """

    reason: str


FromCluster = NodeJoined | NodeNews | NodeWithdrew | NodeLost | Members | NotConnected
"""Messages of the process that is connected with the cluster."""

ToCluster = Mapping[str, Orders] | None
"""Messages to it: orders by the names of nodes, or ``None`` to end."""
