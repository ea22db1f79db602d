"""What the store gives and takes: plain values, never rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import IntEnum, StrEnum
from typing import Generic, TypeVar

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.oracles.accountability import Accountability
from drivora_service.oracles.verdict import Outcome
from drivora_service.runs.report import RunReport, RunStatus
from drivora_service.runs.slot_state import SlotState

Item = TypeVar("Item")


class Priority(IntEnum):
    """Whose runs go first; the lower the number, the sooner."""

    INTERACTIVE = 0
    CI = 1
    CAMPAIGN = 2


class BatchState(StrEnum):
    """Whether a batch's queued runs are handed out."""

    OPEN = "open"
    PAUSED = "paused"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True, kw_only=True)
class NewRun:
    """A run to be queued, or one that is over before it began.

    Attributes:
        document: Canonical JSON text; for a document that cannot be used, the text as it came.
        scenario_sha256: Hash of the document.
        town: Name of the network, for filters.
        agent: Name of the ADS that drives, for filters; several are joined by a comma.
        agent_override: Agent name that overrides the document's, or "".
        seed_override: Seed that overrides the document's.
        label: Name for people, such as the file it came from.
        item: Place in the batch; -1: the place in the call.
        report: The end of a run that is not to be run, such as ``invalid``; its ``run_id`` is
            replaced by the new one.
        feedback: What is to be measured besides, for a tester.
        keeps_trace: Whether the worker writes a trace.
        run_id: Names the run; "": an id is made.
    """

    document: str
    scenario_sha256: str
    town: str
    agent: str
    agent_override: str = ""
    seed_override: int | None = None
    label: str = ""
    item: int = -1
    report: RunReport | None = None
    feedback: FeedbackChoice | None = None
    keeps_trace: bool = True
    run_id: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class JobRecord:
    """A job and its run; both have the same id.

    Attributes:
        revision: Grows with every change; good for an ``ETag``.
        batch_id: "" for a job that was posted alone.
        cause: Why the run was not judged, as in ``RunFailure.cause``, or "".
        violations: Broken rules; ``None`` unless finished.
        at_fault_violations: Broken rules for which an ego is responsible.
        observations: Broken rules that count only where they are named, not among ``violations``.
        accountability: The strongest of its violations; ``None`` without one, unless finished, or
            judged before it was told.
    """

    id: str
    revision: int
    batch_id: str
    item: int
    label: str
    scenario_sha256: str
    town: str
    agent: str
    agent_override: str
    seed_override: int | None
    status: RunStatus
    cause: str
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    cancel_requested: bool
    attempts: int
    violations: int | None
    at_fault_violations: int | None
    observations: int | None
    accountability: Accountability | None
    steps: int | None
    sim_time_s: float | None
    wall_time_s: float | None
    trace_sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AttemptRecord:
    """One try at a run; ``ended_at`` is ``None`` while it goes on."""

    number: int
    worker: str
    claimed_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    outcome: str
    cause: str
    signal: str
    log: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchRecord:
    """Runs that were asked for together.

    Attributes:
        counts: Runs by status; statuses that no run has are left out.
        violated_runs: Finished runs with at least one broken rule.
    """

    id: str
    name: str
    priority: Priority
    state: BatchState
    created_at: datetime
    size: int
    counts: Mapping[RunStatus, int] = field(default_factory=dict)
    violated_runs: int = 0

    @property
    def is_done(self) -> bool:
        """Whether every run has ended."""
        return sum(n for status, n in self.counts.items() if status.is_final) >= self.size


@dataclass(frozen=True, slots=True, kw_only=True)
class JobFilter:
    """Which jobs are wanted; what is left out does not restrict.

    Attributes:
        batch_id: Of this batch.
        statuses: In any of these states.
        agent: Driven by this agent.
        town: On this network.
        oracle: About which this oracle said ``outcome``.
        outcome: See ``oracle``.
        at_fault: See ``oracle``; ``None`` for either.
        accountability: Of which it is the strongest of the run's violations.
        violated: With, or without, any broken rule.
        scenario_sha256: Of this scenario.
    """

    batch_id: str = ""
    statuses: frozenset[RunStatus] = frozenset()
    agent: str = ""
    town: str = ""
    oracle: str = ""
    outcome: Outcome = Outcome.VIOLATED
    at_fault: bool | None = None
    accountability: Accountability | None = None
    violated: bool | None = None
    scenario_sha256: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Page(Generic[Item]):
    """Some items and the token that asks for the next ones, or "" at the end."""

    items: tuple[Item, ...]
    next_token: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class QuarantineRecord:
    """A scenario that is known to crash the simulator, and the run that showed it."""

    key: str
    scenario_sha256: str
    run_id: str
    cause: str
    signal: str
    message: str
    log: str
    created_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnerRecord:
    """A server process and its slots."""

    id: str
    host: str
    pid: int
    started_at: datetime
    heartbeat_at: datetime
    slots: tuple[SlotState, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reservation:
    """Answer to an idempotency key.

    Attributes:
        fresh: Whether the caller is the first and shall do the work.
        fingerprint: Of the body of the first request.
        reference: What the first request was answered with; ``None`` while it is being done.
    """

    fresh: bool
    fingerprint: str
    reference: str | None
