"""Runs: what came of a job."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.api.schemas.jobs import Failure, JobSummary, failure_of, job_summary
from drivora_service.oracles.verdict import Answer, Outcome, Severity, Verdict
from drivora_service.runs.report import RunReport
from drivora_service.scenario.model import AgentChoice
from drivora_service.store.records import AttemptRecord, JobRecord


class VerdictView(Schema):
    """What an oracle says about an ego."""

    oracle: str
    ego: str
    outcome: Outcome
    message: str
    severity: Severity = Field(description="Of the rule; an observation is no failure by itself.")
    at_fault: bool | None = Field(
        description="null where the rule knows no fault, or cannot tell (`undetermined`)."
    )
    undetermined: bool = Field(description="The rule knows fault and cannot tell it here.")
    avoidable: Answer | None = Field(
        description="Whether a careful and competent driver (UNECE R157) would have avoided it; "
        "null where the rule does not ask."
    )
    physically_avoidable: Answer | None = Field(
        description="Whether full grip without delay would have avoided it; null where the rule "
        "does not ask."
    )
    time: float | None = Field(description="Seconds at which the violation began.")
    step: int | None
    location: tuple[float, float] | None = Field(description="x, y in metres at that time.")
    counterpart: str = Field(description="The other actor involved; may be empty.")
    evidence: dict[str, Any] = Field(description="Measured values, SI units.")


class Attempt(Schema):
    """One try of a worker at a run."""

    number: int
    worker: str
    outcome: str = Field(description="Empty while it goes on.")
    cause: str
    signal: str = Field(description="Signal that ended the worker process, such as SIGSEGV.")
    log: str


class AgentView(Schema):
    """The agent that drove an ego."""

    name: str
    parameters: dict[str, Any] = Field(description="Values of all, the defaults among them.")


class Run(JobSummary):
    """A run and, once it has ended, everything that was found out about it."""

    error: Failure | None
    verdicts: tuple[VerdictView, ...]
    metrics: dict[str, float | None] = Field(description="null: not measurable.")
    scores: dict[str, float | None] = Field(description="Objectives to minimise.")
    step_cost_us: float | None = Field(description="Mean wall microseconds a step.")
    agent_cost_us: dict[str, float] = Field(
        description="What each ego's agent took of that, by the ego's id; the rest is the "
        "simulation's. Egos that SUMO drives are left out."
    )
    agents: dict[str, AgentView] = Field(
        description="By ego; empty for runs of versions that did not record it."
    )
    privileged: tuple[str, ...] = Field(
        description="Ids of the egos that saw more than the perception model lets through."
    )
    versions: dict[str, Any]
    tries: tuple[Attempt, ...]
    observations_url: str = Field(description="Empty where nothing was recorded.")
    scenario_url: str


def verdict_view(verdict: Verdict) -> VerdictView:
    """Gives a verdict as the API shows it."""
    return VerdictView(
        oracle=verdict.oracle,
        ego=verdict.ego,
        outcome=verdict.outcome,
        message=verdict.message,
        severity=verdict.severity,
        at_fault=verdict.at_fault,
        undetermined=verdict.undetermined,
        avoidable=verdict.avoidable,
        physically_avoidable=verdict.physically_avoidable,
        time=verdict.time,
        step=verdict.step,
        location=verdict.location,
        counterpart=verdict.counterpart,
        evidence=dict(verdict.evidence),
    )


def agent_views(agents: Mapping[str, AgentChoice]) -> dict[str, AgentView]:
    """Returns the agents of a report as the API shows them."""
    return {
        ego: AgentView(name=agent.name, parameters=dict(agent.parameters))
        for ego, agent in agents.items()
    }


def run_of(
    record: JobRecord, report: RunReport | None, attempts: tuple[AttemptRecord, ...], base: str
) -> Run:
    """Gives a run as its own address ``base`` shows it."""
    return Run(
        **job_summary(record).model_dump(),
        error=failure_of(report),
        verdicts=tuple(verdict_view(v) for v in report.verdicts) if report else (),
        metrics=dict(report.metrics) if report else {},
        scores=dict(report.scores) if report else {},
        step_cost_us=report.step_cost_us if report and report.steps else None,
        agent_cost_us=dict(report.agent_cost_us) if report else {},
        agents=agent_views(report.agents) if report else {},
        privileged=report.privileged if report else (),
        versions=dict(report.versions) if report else {},
        tries=tuple(
            Attempt(
                number=attempt.number,
                worker=attempt.worker,
                outcome=attempt.outcome,
                cause=attempt.cause,
                signal=attempt.signal,
                log=attempt.log,
            )
            for attempt in attempts
        ),
        observations_url=f"{base}/observations" if record.trace_sha256 else "",
        scenario_url=f"{base}/scenario",
    )
