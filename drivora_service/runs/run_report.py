"""The specification of a run and its report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from drivora_service.feedback.measurement import FeedbackChoice, Measurement
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.candidate import Candidate, CandidateSource
from drivora_service.scenario.model import AgentChoice
from drivora_service.shapes import Shape


class RunStatus(StrEnum):
    """The state of a run in its life cycle."""

    QUEUED = "queued"
    RUNNING = "running"
    FINISHED = "finished"
    INVALID = "invalid"
    AGENT_FAILED = "agent_failed"
    PLUGIN_FAILED = "plugin_failed"
    SIMULATOR_CRASHED = "simulator_crashed"
    TIMED_OUT = "timed_out"
    INFRASTRUCTURE_FAILED = "infrastructure_failed"
    CANCELLED = "cancelled"

    @property
    def is_final(self) -> bool:
        """Whether the status cannot change any more."""
        return self not in (RunStatus.QUEUED, RunStatus.RUNNING)


UNFINISHED = tuple(status for status in RunStatus if not status.is_final)
"""The statuses that can change."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSpec:
    """One episode to simulate.

    Attributes:
        run_id: Names the run and its files; letters, digits, dashes.
        document: The scenario document in canonical JSON text; "" if the worker makes it of a
            candidate.
        trace_path: Where the worker writes the trace; "" for none.
        attempt: Number of the attempt at this run, from 1 on.
        agent: Agent name that overrides the document's, or "".
        seed: Seed that overrides the document's, or ``None``.
        feedback: Feedback that measures the run for a tester; ``None`` for none.
        candidate: Genes from which the worker makes the document; ``None`` if there is one. Inside
            the worker, with the document, the repaired genes that it is made of.
        prepared: In a worker, what it has made of such a candidate, if an adversary acts during the
            run.
    """

    run_id: str
    document: str
    trace_path: str = ""
    attempt: int = 1
    agent: str = ""
    seed: int | None = None
    feedback: FeedbackChoice | None = None
    candidate: CandidateSource | None = None
    prepared: Candidate | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunFailure(Shape):
    """The reason that a run was not judged.

    Attributes:
        cause: Short stable name: ``agent_raised``, ``agent_hung``, ``agent_invalid_control``,
            ``oracle_raised``, ``feedback_raised``, ``simulator_error``, ``signal``,
            ``memory_limit``, ``wall_time_limit``, ``worker_lost``, ``invalid_document`` and their
            like.
        message: Explanation in words.
        log: The last lines of the worker's or agent's log.
    """

    cause: str
    message: str
    log: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunReport(Shape):
    """The result of a run; exists for every run that was started.

    Attributes:
        verdicts: Of all oracles and egos; empty unless finished.
        metrics: Measured values by name; ``None`` is "not measurable".
        scores: Feedback objectives by name, to be minimised; ``None`` is "not measurable".
        measurement: Measurement by the spec's feedback; ``None`` unless finished.
        trace_sha256: Hash of the trace, hexadecimal; "" unless the run was simulated to its end.
        egos_sha256: Hash of the motion of the egos and the ends of their parts, hexadecimal: equal
            for two runs that differ in nothing that any ego did; "" as above, and if it was not
            recorded.
        without_effect: Indices of the candidate's genes whose change, to whatever values, could not
            have changed the run of any ego; see ``worker.without_effect``.
        steps: Rows of the trace.
        sim_time_s: Simulated seconds.
        wall_time_s: Seconds from the start of the run to its report, in the worker.
        step_cost_us: Mean wall microseconds a step, without reset and judging.
        agent_cost_us: Part of that in the calls of each ego's agent, by the ego's id; a mean over
            the same steps, so that the rest is the simulation's. Egos that SUMO drives are left
            out.
        privileged: Ids of the egos that got more than the perception model lets through.
        agents: The agent of each ego by the ego's id, with the values of all its parameters, the
            defaults among them.
        versions: Versions of the software that took part, by name.
    """

    run_id: str
    status: RunStatus
    verdicts: tuple[Verdict, ...] = ()
    metrics: Mapping[str, float | None] = field(default_factory=dict)
    scores: Mapping[str, float | None] = field(default_factory=dict)
    measurement: Measurement | None = None
    trace_sha256: str = ""
    egos_sha256: str = ""
    without_effect: tuple[int, ...] = ()
    steps: int = 0
    sim_time_s: float = 0.0
    wall_time_s: float = 0.0
    step_cost_us: float = 0.0
    agent_cost_us: Mapping[str, float] = field(default_factory=dict)
    privileged: tuple[str, ...] = ()
    failure: RunFailure | None = None
    agents: Mapping[str, AgentChoice] = field(default_factory=dict)
    versions: Mapping[str, Any] = field(default_factory=dict)
