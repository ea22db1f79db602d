"""Values that the store reads and writes, apart from its rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any, Generic, TypeVar

from pydantic import computed_field

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import StatedDefinition, state_definition
from drivora_service.runs.candidate import CandidateSource
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.runs.slot_state import SlotState
from drivora_service.scenario.model import AgentChoice
from drivora_service.shapes import Shape

Item = TypeVar("Item")

LONGEST_LABEL = 200
"""Characters of the label of a run."""


class Priority(StrEnum):
    """The priority of runs: interactive first, then CI, then campaigns."""

    INTERACTIVE = "interactive"
    CI = "ci"
    CAMPAIGN = "campaign"

    @property
    def rank(self) -> int:
        """Its rank in the queue; the lower, the sooner."""
        return _RANKED.index(self)

    @classmethod
    def of_rank(cls, rank: int) -> Priority:
        """Returns the priority of a rank."""
        return _RANKED[rank]


_RANKED = tuple(Priority)


class BatchState(StrEnum):
    """Whether a batch's queued runs may start."""

    OPEN = "open"
    PAUSED = "paused"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """The options of a run that are not in its scenario; stored in columns of the same names.

    Attributes:
        agent_override: Agent name that overrides the document's, or "".
        seed_override: Seed that overrides the document's.
        definition: What counts as a failure of the run, as JSON; "": the default.
    """

    agent_override: str = ""
    seed_override: int | None = None
    definition: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewRun:
    """A run to be queued, or one that has ended without being started.

    Attributes:
        document: Canonical JSON text; for an invalid document, the text as received; for a
            candidate, the seed scenario of its space.
        scenario_sha256: Hash of the document.
        town: Name of the network, for filters.
        agent: Name of the ADS, for filters; several are joined by a comma.
        configuration: The ADS with its parameters; ``None``: not known, the name stands for it.
        options: Options of the client.
        label: Display name, such as the name of its file.
        item: Place in the batch; -1: the place in the call.
        report: Report of a run that is not started, such as ``invalid``; its ``run_id`` is
            replaced by the new one.
        feedback: Feedback that measures the run for a tester.
        keeps_trace: Whether the worker writes a trace.
        run_id: Id of the run; "": an id is made.
        candidate: Genes from which the worker makes the document.
    """

    document: str
    scenario_sha256: str
    town: str
    agent: str
    options: RunOptions = RunOptions()
    label: str = ""
    item: int = -1
    report: RunReport | None = None
    feedback: FeedbackChoice | None = None
    keeps_trace: bool = True
    run_id: str = ""
    configuration: AgentConfiguration | None = None
    candidate: CandidateSource | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary(Shape):
    """A job in a list, with the state of its run. Both have the same id.

    Attributes:
        cause: Why the run was not judged, as in `error`; empty otherwise.
        label: Display name.
        batch_id: Empty for a job that was posted singly.
        item: Place in the batch.
        configuration: The ADS with the parameters that differ from its defaults, such as
            `idm · reaction_time 1.0`; the name alone where a run's version did not record them.
        configuration_id: Short id of the ADS with the values of all its parameters, 8 hexadecimal
            digits; empty where they were not recorded.
        seed: Seed that overrides the document's.
        attempts: Number of attempts.
        violations: Violated oracles, without observations and what only follows from another
            violation; null unless finished.
        at_fault_violations: Those for which an ego is responsible.
        observations: Violated oracles that count only where a definition names them.
        failures: Violations that are failures by the definition of the run, see `definition` of
            its details; that the ADS itself failed is one. Null if the run says nothing about its
            ADS, or was judged before this was recorded.
        accountability: The strongest of its violations; null without one, unless finished, or
            where the run was judged before it was recorded.
        steps: Rows of the trace.
        sim_time_s: Simulated seconds.
        wall_time_s: Seconds that the run took in its worker.
        trace_sha256: Hash of the trace; empty where nothing was recorded.
        revision: Count of all changes at its newest one; see `GET /events`.
    """

    id: str
    status: RunStatus
    cause: str
    label: str
    batch_id: str
    item: int
    town: str
    agent: str
    configuration: str
    configuration_id: str
    seed: int | None
    scenario_sha256: str
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    cancel_requested: bool
    attempts: int
    violations: int | None
    at_fault_violations: int | None
    observations: int | None
    failures: int | None
    accountability: Accountability | None
    steps: int | None
    sim_time_s: float | None
    wall_time_s: float | None
    trace_sha256: str
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt(Shape):
    """One attempt of a worker at a run.

    Attributes:
        ended_at: null until it has ended.
        outcome: Empty until it has ended.
        signal: Signal that ended the worker process, such as SIGSEGV.
        log: Last lines of the worker's log.
    """

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
class RunRecord(RunSummary):
    """A run and, once it has ended, its results.

    Attributes:
        error: Why the run was not judged.
        metrics: Measured values by name; null: not measurable.
        scores: Objectives to minimise, by name; null: not measurable.
        step_cost_us: Mean wall microseconds a step, without reset and judging.
        agent_cost_us: Share of each ego's agent in that, by the ego's id; the rest is the
            simulation's. Egos that SUMO drives are left out.
        agents: Agent of each ego with the values of all its parameters; empty for runs of versions
            that did not record it.
        privileged: Ids of the egos that got more than the perception model lets through.
        versions: Versions of the software that took part, by name.
        tries: Every attempt at the run, first to last.
        campaign_id: Campaign of which it is a run; empty without one.
        evaluation: Number of the campaign's evaluation; null without a campaign.
        simulation_sha256: Hash of the trace, also where none was recorded or it was removed; empty
            unless the run was simulated to its end.
        definition: What counts as a failure of the run.
        failing_verdicts: Places in `verdicts` of its failures.
    """

    error: RunFailure | None = None
    verdicts: tuple[Verdict, ...] = ()
    metrics: Mapping[str, float | None] = field(default_factory=dict)
    scores: Mapping[str, float | None] = field(default_factory=dict)
    step_cost_us: float | None = None
    agent_cost_us: Mapping[str, float] = field(default_factory=dict)
    agents: Mapping[str, AgentChoice] = field(default_factory=dict)
    privileged: tuple[str, ...] = ()
    versions: Mapping[str, Any] = field(default_factory=dict)
    tries: tuple[Attempt, ...] = ()
    campaign_id: str = ""
    evaluation: int | None = None
    simulation_sha256: str = ""
    definition: StatedDefinition = field(default_factory=lambda: state_definition(()))
    failing_verdicts: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch(Shape):
    """Runs that were submitted together, and their progress.

    Attributes:
        size: Number of its runs.
        counts: Numbers of runs by status; statuses without runs are left out.
        violated_runs: Finished runs with at least one violated oracle.
        failing_runs: Runs with a failure, by their own definition.
        revision: Count of all changes at its newest one, those of its runs included.
    """

    id: str
    name: str
    priority: Priority
    state: BatchState
    created_at: datetime
    size: int
    counts: Mapping[RunStatus, int] = field(default_factory=dict)
    violated_runs: int = 0
    failing_runs: int = 0
    revision: int = 0

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def done(self) -> bool:
        """Whether every run has ended."""
        return sum(n for status, n in self.counts.items() if status.is_final) >= self.size


@dataclass(frozen=True, slots=True, kw_only=True)
class JobFilter:
    """A filter of jobs; defaults do not restrict.

    Attributes:
        batch_id: Batch of the job.
        statuses: Any of these statuses.
        agent: Agent of an ego.
        configuration_id: Id of the agents with their parameters.
        town: Name of the network.
        oracle: Oracle with a verdict of ``outcome``.
        outcome: See ``oracle``.
        at_fault: See ``oracle``; ``None`` for either. Without an oracle: whether an ego is at fault
            in any violation of the run.
        accountability: The strongest of the run's violations.
        violated: Whether any oracle was violated.
        failing: Whether the run has a failure by its own definition.
        scenario_sha256: Hash of the scenario.
        campaign_id: Campaign of the run, if a service runs or ran it.
        since: Submitted at this time or later.
        until: Submitted before this time.
    """

    batch_id: str = ""
    statuses: frozenset[RunStatus] = frozenset()
    agent: str = ""
    configuration_id: str = ""
    town: str = ""
    oracle: str = ""
    outcome: Outcome = Outcome.VIOLATED
    at_fault: bool | None = None
    accountability: Accountability | None = None
    violated: bool | None = None
    failing: bool | None = None
    scenario_sha256: str = ""
    campaign_id: str = ""
    since: datetime | None = None
    until: datetime | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Page(Shape, Generic[Item]):
    """One page of a list, and the token of the next.

    Attributes:
        next_page_token: Value of `page_token` for the next page; empty at the end.
    """

    items: tuple[Item, ...]
    next_page_token: str = ""


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
class QueueLoad(Shape):
    """The runs of a priority that have not ended.

    Attributes:
        queued: Runs that wait.
        paused: Runs that wait in paused batches.
        running: Runs that a process has taken.
    """

    priority: Priority
    queued: int
    paused: int
    running: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Reservation:
    """The reservation of an idempotency key.

    Attributes:
        fresh: Whether the caller is the first and must do the work.
        fingerprint: Fingerprint of the body of the first request.
        reference: Answer to the first request; ``None`` while it is being done.
    """

    fresh: bool
    fingerprint: str
    reference: str | None
