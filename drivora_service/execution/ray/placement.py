"""Which node performs which run, and what becomes of the runs of a node that is lost."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime

from drivora_service.execution.deaths import WORKER_LOST, report_loss
from drivora_service.execution.pace import Pace
from drivora_service.execution.ray.ray_messages import News, Orders
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import NOT_BEGUN, cancelled_report
from drivora_service.runs.run_report import RunSpec
from drivora_service.runs.slot_state import SlotState

_AHEAD = 2
"""Runs that a node holds beyond those of its pace, so that no slot of a small node waits for the
network between two runs."""


@dataclass(slots=True)
class _Node:
    """A node with its runs.

    Attributes:
        slots: Number of its slots.
        states: Their last known state.
        fault: The reason that no worker of the node can be started, or "".
        pace: How many runs it is given ahead: more if they are short, so that a call over the
            network does much at once.
        runs: Runs that it holds, in the order in which it got them, each with the time.
        cancel: Runs that it is to be told to cancel.
        withdraw: Whether it is to be told to return what it has not started.
        withdrawing: Whether an answer to an order to withdraw is pending.
    """

    slots: int
    states: tuple[SlotState, ...] = ()
    fault: str = ""
    pace: Pace = field(default_factory=Pace)
    runs: dict[str, tuple[RunSpec, datetime]] = field(default_factory=dict)
    cancel: list[str] = field(default_factory=list)
    withdraw: bool = False
    withdrawing: bool = False

    @property
    def room(self) -> int:
        """Number of runs that it may be given."""
        if self.fault or self.withdrawing or self.withdraw:
            return 0
        return self.pace.target_in_flight(self.slots) + _AHEAD - len(self.runs)

    @property
    def load(self) -> float:
        """Runs by slot."""
        return len(self.runs) / self.slots


class Placement:
    """The runs of an executor on the nodes of a cluster. Not thread-safe; without input or output.

    A run is given to the node with the fewest runs by slot, in the order of submission. Few runs
    wait on the nodes: the others wait here, and go to nodes that join.

    Attributes:
        is_held: Whether no run is given to a node at present.
    """

    def __init__(self) -> None:
        """Creates a placement without nodes and runs."""
        self.is_held = False
        self._nodes: dict[str, _Node] = {}
        self._waiting: deque[RunSpec] = deque()
        self._cancelled: set[str] = set()

    @property
    def slots(self) -> int:
        """Number of slots of all nodes."""
        return sum(node.slots for node in self._nodes.values())

    @property
    def states(self) -> tuple[SlotState, ...]:
        """Last known state of each slot."""
        return tuple(state for node in self._nodes.values() for state in node.states)

    @property
    def faults(self) -> Mapping[str, str]:
        """The fault of each node, "" without one."""
        return {name: node.fault for name, node in self._nodes.items()}

    @property
    def is_withdrawing(self) -> bool:
        """Whether a node has not answered an order to withdraw."""
        return any(node.withdraw or node.withdrawing for node in self._nodes.values())

    def join(self, name: str, slots: int) -> None:
        """Adds a node."""
        self._nodes[name] = _Node(slots=slots)

    def submit(self, spec: RunSpec) -> None:
        """Queues a run."""
        self._waiting.append(spec)

    def cancel(self, run_id: str) -> tuple[AttemptEnd, ...]:
        """Cancels a run; returns its end if it was on no node."""
        for node in self._nodes.values():
            if run_id in node.runs:
                self._cancelled.add(run_id)
                node.cancel.append(run_id)
                return ()
        for spec in self._waiting:
            if spec.run_id == run_id:
                self._waiting.remove(spec)
                return (_make_cancelled_end(run_id),)
        return ()

    def withdraw(self) -> None:
        """Orders every node to return what it has not started."""
        for node in self._nodes.values():
            if node.runs and not node.withdrawing:
                node.withdraw = True

    def take_waiting(self) -> tuple[str, ...]:
        """Removes the runs that are on no node; returns their ids."""
        run_ids = tuple(spec.run_id for spec in self._waiting)
        self._waiting.clear()
        return run_ids

    def put_back(self, name: str, run_ids: Iterable[str]) -> tuple[AttemptEnd, ...]:
        """Takes runs that a node has not started back, to the front of the queue.

        Returns:
            The ends of those that were cancelled meanwhile.
        """
        node = self._nodes.get(name)
        if node is None:
            return ()
        node.withdrawing = False
        taken = [node.runs.pop(run_id)[0] for run_id in run_ids if run_id in node.runs]
        return self._requeue(taken)

    def note(self, name: str, news: News) -> tuple[AttemptEnd, ...]:
        """Takes the news of a node; returns the ends in it that are of its runs."""
        node = self._nodes.get(name)
        if node is None:
            # Its runs were taken for lost.
            return ()
        node.states, node.fault = news.slots, news.fault
        ends = tuple(end for end in news.ends if node.runs.pop(end.report.run_id, None))
        self._cancelled.difference_update(end.report.run_id for end in ends)
        for end in ends:
            node.pace.note((end.ended - end.started).total_seconds())
        if node.fault and node.runs and not node.withdrawing:
            # Another node may start them.
            node.withdraw = True
        return ends

    def lose(self, name: str, reason: str) -> tuple[AttemptEnd, ...]:
        """Removes a node; returns the ends of the attempts that were there.

        It may have been performing its oldest ones, as many as it has slots, for a node starts its
        runs in order. The others are not known to have begun, which costs their runs nothing. They
        are other attempts from now on: a node that was only cut off may begin them yet.
        """
        node = self._nodes.pop(name, None)
        if node is None:
            return ()
        message = f"the node {name} was lost: {reason}"
        ends = tuple(
            self._make_lost_end(
                node, name, run_id, WORKER_LOST if place < node.slots else NOT_BEGUN, message
            )
            for place, run_id in enumerate(node.runs)
        )
        self._cancelled.difference_update(end.report.run_id for end in ends)
        return ends

    def lose_all(self, reason: str) -> tuple[AttemptEnd, ...]:
        """Removes all nodes, as :meth:`lose` does."""
        return tuple(end for name in list(self._nodes) for end in self.lose(name, reason))

    def orders(self) -> dict[str, Orders]:
        """Places waiting runs; returns what the nodes are to be told, each order once."""
        given = self._place()
        orders: dict[str, Orders] = {}
        for name, node in self._nodes.items():
            submit = tuple(given.get(name, ()))
            if submit or node.cancel or node.withdraw:
                orders[name] = Orders(
                    submit=submit, cancel=tuple(node.cancel), withdraw=node.withdraw
                )
                node.withdrawing |= node.withdraw
                node.cancel, node.withdraw = [], False
        return orders

    def _place(self) -> dict[str, list[RunSpec]]:
        given: dict[str, list[RunSpec]] = {}
        now = datetime.now(UTC)
        while self._waiting and not self.is_held:
            free = [name for name, node in self._nodes.items() if node.room > 0]
            if not free:
                break
            name = min(free, key=lambda name: self._nodes[name].load)
            spec = self._waiting.popleft()
            self._nodes[name].runs[spec.run_id] = (spec, now)
            given.setdefault(name, []).append(spec)
        return given

    def _requeue(self, specs: list[RunSpec]) -> tuple[AttemptEnd, ...]:
        cancelled = [spec.run_id for spec in specs if spec.run_id in self._cancelled]
        self._cancelled.difference_update(cancelled)
        self._waiting.extendleft(spec for spec in reversed(specs) if spec.run_id not in cancelled)
        return tuple(map(_make_cancelled_end, cancelled))

    def _make_lost_end(
        self, node: _Node, name: str, run_id: str, cause: str, message: str
    ) -> AttemptEnd:
        slot = next((slot for slot in node.states if slot.run_id == run_id), None)
        since = node.runs[run_id][1]
        report = report_loss(run_id, message, "", cause=cause)
        return AttemptEnd(
            report=cancelled_report(run_id) if run_id in self._cancelled else report,
            worker=name if slot is None else slot.name,
            started=since if slot is None or slot.since is None else slot.since,
            ended=datetime.now(UTC),
        )


def _make_cancelled_end(run_id: str) -> AttemptEnd:
    now = datetime.now(UTC)
    return AttemptEnd(report=cancelled_report(run_id), worker="", started=now, ended=now)
