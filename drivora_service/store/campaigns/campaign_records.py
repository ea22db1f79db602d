"""Values of campaigns that the store reads and writes, apart from its rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any

from pydantic import computed_field

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, strongest
from drivora_service.runs.run_report import RunReport
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_warnings import CampaignWarning, campaign_warnings
from drivora_service.store.campaigns.seed_run_records import SeedRun


class CampaignState(StrEnum):
    """The state of a campaign in its life cycle."""

    QUEUED = "queued"
    RUNNING = "running"
    PAUSED = "paused"
    FINISHED = "finished"
    FAILED = "failed"
    """It stopped at an error, which the message states; it may be resumed."""
    CANCELLED = "cancelled"
    INTERRUPTED = "interrupted"
    """The process of the command that ran it was killed; it may be resumed. Stored as running."""

    @property
    def is_over(self) -> bool:
        """Whether its state cannot change any more."""
        return self in (CampaignState.FINISHED, CampaignState.CANCELLED)


class CampaignRequest(StrEnum):
    """A pending request to a running campaign."""

    NONE = ""
    PAUSE = "pause"
    CANCEL = "cancel"


class Confirmation(StrEnum):
    """Whether an identical run repeated a failure."""

    OPEN = "open"
    """Not tried yet."""
    CONFIRMED = "confirmed"
    """The same trace, step by step."""
    FLAKY = "flaky"
    """Another trace, or none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyCell(Shape):
    """The place of a campaign in its study.

    Attributes:
        scenario: Name of the seed scenario in the study.
        agent: Name of the ADS, with its parameters, in the study.
        method: Name of the testing method, with its parameters, in the study.
        repetition: From 1.
    """

    scenario: str
    agent: str
    method: str
    repetition: int


@dataclass(frozen=True, slots=True, kw_only=True)
class NewCampaign:
    """A campaign to be stored.

    Attributes:
        document: The campaign as JSON text; see ``campaigns.document.campaign_documents``.
        tester: Name of the tester, for lists.
        agent: Name of the ADS, for lists.
        configuration: The ADS with its parameters; ``None``: not known, the name stands for it.
        town: Name of the road network, for lists.
        network_sha256: Hash of the network's file.
        budget: Simulations.
        versions: Versions of the software that determines the search, by name.
        study_id: Id of its study; "" if it is of none.
        cell: Its place in the study.
    """

    name: str
    document: str
    tester: str
    agent: str
    town: str
    network_sha256: str
    budget: int
    versions: Mapping[str, str] = field(default_factory=dict)
    study_id: str = ""
    cell: StudyCell | None = None
    configuration: AgentConfiguration | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignCounts(Shape):
    """Counts of a campaign's evaluations so far.

    Attributes:
        evaluations: Candidates, simulated or not.
        judged: Candidates that were simulated and judged.
        invalid: Candidates that were no valid scenario; not simulated.
        failed: Candidates without a result of their run.
        violating: Candidates with at least one failure.
        at_fault: Candidates with a failure for which an ego is known to be responsible.
        avoidable: Candidates with a failure that a careful and competent driver avoids; null if
            the campaign was judged before this was recorded.
        unavoidable: Candidates at fault in violations that this driver avoids none of, whether the
            campaign counts them or not.
        undetermined: Candidates with violations of undetermined fault only, likewise.
        preventable: Candidates with violations at the fault of others only, one that this driver
            avoids, likewise; null if the campaign was judged before this was recorded.
        agent_failed: Those without a result in which the ADS itself failed; null if the campaign
            began before this was recorded.
        not_at_fault: Candidates with violations at the fault of others only, none that this driver
            is known to avoid, whether the campaign counts them or not; null likewise.
    """

    evaluations: int = 0
    judged: int = 0
    invalid: int = 0
    failed: int = 0
    violating: int = 0
    at_fault: int = 0
    avoidable: int | None = 0
    unavoidable: int | None = 0
    undetermined: int | None = 0
    preventable: int | None = 0
    agent_failed: int | None = 0
    not_at_fault: int | None = 0

    @property
    def simulations(self) -> int:
        """Candidates that count against the budget."""
        return self.judged + self.failed

    @property
    def apart(self) -> tuple[tuple[int, str], ...]:
        """Candidates by the strongest of their violations, but for the avoidable ones; not zero."""
        degrees = (
            (self.unavoidable, "at fault, but not avoidable"),
            (self.undetermined, "of undetermined fault"),
            (self.preventable, "not at fault, but avoidable"),
            (self.not_at_fault, "not at fault"),
        )
        return tuple((number, words) for number, words in degrees if number)


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignToRun:
    """A campaign that is queued for a process of the service, or has one."""

    id: str
    request: CampaignRequest


@dataclass(frozen=True, slots=True, kw_only=True)
class BestScore(Shape):
    """The least value of an objective so far.

    Attributes:
        evaluation: Number of the first evaluation with it, from 0.
    """

    value: float
    evaluation: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignSummary(Shape):
    """A campaign in a list, with its progress.

    Attributes:
        message: Why it failed; empty otherwise.
        request: Pending request to a running campaign.
        configuration: The ADS with the parameters that differ from its defaults, such as
            `idm · reaction_time 1.0`.
        configuration_id: Short id of the ADS with all its parameters; empty if not recorded.
        budget: Simulations that it may make.
        active_s: Seconds of work, pauses left out.
        updated_at: When its tester was last told an evaluation, or its state changed.
        batch_id: Batch of its runs; empty if no service runs it.
        study_id: Id of its study; empty if it is of none.
        cell: Its place in the study; null if it is of none.
        revision: Count of all changes at its newest one, those of its evaluations included.
        seed_runs: The runs of its seed scenarios as they are, outside the budget; of many the
            first. Empty until they have ended, and if they were not made.
    """

    id: str
    name: str
    state: CampaignState
    message: str
    request: CampaignRequest
    tester: str
    agent: str
    configuration: str
    configuration_id: str
    town: str
    budget: int
    counts: CampaignCounts
    active_s: float
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    updated_at: datetime
    batch_id: str = ""
    study_id: str = ""
    cell: StudyCell | None = None
    revision: int = 0
    seed_runs: tuple[SeedRun, ...] = ()

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def simulations(self) -> int:
        """Simulations so far."""
        return self.counts.simulations

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def warnings(self) -> tuple[CampaignWarning, ...]:
        """Warnings that it says little: a seed fails, or all or none of its simulations do."""
        is_finished = self.state is CampaignState.FINISHED
        return campaign_warnings(self.counts, self.seed_runs, is_finished=is_finished)

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def rate(self) -> float | None:
        """Simulations a second of work; null before there is one."""
        return self.counts.simulations / self.active_s if self.active_s > 0.0 else None

    @computed_field  # type: ignore[prop-decorator] # as pydantic documents it
    @property
    def left_s(self) -> float | None:
        """Seconds until the budget is spent, at that rate."""
        return (self.budget - self.counts.simulations) / self.rate if self.rate else None


@dataclass(frozen=True, slots=True, kw_only=True)
class CampaignRecord(CampaignSummary):
    """A campaign with what defines it.

    Attributes:
        best: Best scores by the objectives of its tester's feedback.
        document: As posted, with defaults filled in.
        network_sha256: Hash of the road network's file.
        versions: Versions of the software that determines the search, by name.
    """

    best: Mapping[str, BestScore] = field(default_factory=dict)
    document: Mapping[str, Any]
    network_sha256: str
    versions: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedFindings(Shape):
    """What a campaign has found from one of its seed scenarios.

    Attributes:
        name: Its name in the campaign; empty if there is only one.
        town: Its road network.
        evaluations: Candidates, simulated or not.
        simulations: Candidates that count against the budget.
        violating: Candidates with at least one failure.
        at_fault: Candidates with a failure for which an ego is known to be responsible.
        avoidable: Candidates with a failure that a careful and competent driver avoids.
        kinds: Kinds of failures.
        first_failure: Number of the first evaluation with a failure, from 0; null without one.
        first_avoidable: Number of the first one with a failure that a careful and competent driver
            avoids; null without one.
    """

    name: str
    town: str
    evaluations: int
    simulations: int
    violating: int
    at_fault: int
    avoidable: int
    kinds: int
    first_failure: int | None
    first_avoidable: int | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EvaluationRecord:
    """A candidate and its result.

    Attributes:
        number: In the order of asking, from 0.
        proposal: The proposal with its repaired values.
        status: See ``search.tester``.
        document_sha256: Hash of the canonical scenario; "" if there is none.
        report: Report of its run; of an invalid candidate, its problems.
        violations: Violations that count as failures, in the order of their times.
        failure_kinds: Kind of each violation, see ``campaigns.search.failure_kinds``.
        search_s: Processor seconds of the tester's work since the evaluation before.
        prepare_s: Processor seconds of repairing, decoding and checking, in the worker.
        asked_sha256: Hash of the proposed values before their repair; "" if it was not recorded.
        seed_number: Place of its seed scenario in the campaign, from 0.
        strongest: The strongest accountability of an ego over the violations that the campaign
            looks at, failures or not; ``None``: over its failures.
    """

    number: int
    proposal: Proposal
    status: EvaluationStatus
    document_sha256: str
    report: RunReport
    violations: tuple[Verdict, ...] = ()
    failure_kinds: tuple[str, ...] = ()
    search_s: float = 0.0
    prepare_s: float = 0.0
    asked_sha256: str = ""
    seed_number: int = 0
    strongest: Accountability | None = None

    @property
    def at_fault(self) -> bool:
        """Whether an ego is known to be responsible for any violation."""
        return any(verdict.at_fault for verdict in self.violations)

    @property
    def accountability(self) -> Accountability | None:
        """The strongest accountability of an ego for a violation; ``None`` without a violation."""
        return self.strongest or strongest(self.violations)


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationSummary(Shape):
    """A candidate in a list, with its result.

    Attributes:
        number: In the order of asking, from 0.
        origin: How it was made: initial, mutation, crossover and the like.
        parents: Evaluations from which it was made.
        seed_number: Place of its seed scenario in the campaign, from 0.
        scenario_sha256: Empty if it is no valid scenario.
        violations: Number of failures.
        at_fault_violations: Those for which an ego is responsible.
        accountability: The strongest of its violations, failures or not; null without one, or if
            it was judged before this was recorded.
        failure_kinds: Kind of each failure.
        objectives: Objectives of the tester's feedback, to be minimised; null: not measurable.
        cause: Why it has no result, as in `error`; empty if it has one.
        told_at: When the tester was told.
    """

    number: int
    generation: int
    origin: str
    parents: tuple[int, ...]
    seed_number: int
    status: EvaluationStatus
    scenario_sha256: str
    violations: int
    at_fault_violations: int
    accountability: Accountability | None
    failure_kinds: tuple[str, ...]
    objectives: Mapping[str, float | None]
    cause: str
    sim_time_s: float
    wall_time_s: float
    told_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationFilter:
    """A filter of evaluations; ``None`` does not restrict."""

    status: EvaluationStatus | None = None
    violating: bool | None = None
    generation: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureFilter:
    """A filter of failures; defaults do not restrict."""

    kind: str = ""
    oracle: str = ""
    at_fault: bool | None = None
    accountability: Accountability | None = None
    confirmation: Confirmation | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureKind(Shape):
    """Failures of one kind. All numbers but `violations` count simulations.

    Attributes:
        kind: Oracle, place, and relation of the other actor to the ego.
        failures: Simulations with a failure of this kind, each once.
        violations: Violations of this kind in them.
        at_fault: Those with an ego at fault.
        avoidable: Those at an ego's fault that could be avoided.
        confirmed: Those that an identical run confirmed.
        flaky: Those that it did not.
        first: Number of the first evaluation with it, from 0.
        groups: Groups of similar ones; null until they are grouped.
    """

    kind: str
    failures: int
    violations: int
    at_fault: int
    avoidable: int
    confirmed: int
    flaky: int
    first: int
    groups: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure(Shape):
    """A failure of a campaign.

    Attributes:
        evaluation: Number of the evaluation.
        place: Place among the failures of that evaluation, from 0.
        kind: Oracle, place, and relation of the other actor to the ego.
        confirmation: Whether an identical run confirmed it.
        group: Number of the group of similar failures, within its oracle's; null until grouped.
        trace: Name of the file with the trace of the identical run; empty until then.
    """

    evaluation: int
    place: int
    kind: str
    confirmation: Confirmation = Confirmation.OPEN
    group: int | None = None
    verdict: Verdict
    trace: str = ""
