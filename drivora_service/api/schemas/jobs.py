"""Jobs: a scenario that was posted, and where its run is in its life."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field

from drivora_service.api.schemas.base import Schema
from drivora_service.oracles.accountability import Accountability
from drivora_service.runs.report import RunReport, RunStatus
from drivora_service.store.records import JobRecord


class Failure(Schema):
    """Why a run was not judged."""

    cause: str = Field(description="Short stable name.")
    message: str = Field(description="For people.")
    log: str = Field(default="", description="Last lines of the worker's or the agent's log.")


class JobSummary(Schema):
    """A job in a list. Its run has the same id."""

    id: str
    status: RunStatus
    cause: str = Field(description="Why the run was not judged; empty otherwise.")
    label: str = Field(description="Name for people.")
    batch_id: str = Field(description="Empty for a job that was posted alone.")
    item: int = Field(description="Place in the batch.")
    town: str
    agent: str
    seed: int | None = Field(description="Seed in place of the document's.")
    scenario_sha256: str
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    cancel_requested: bool
    attempts: int = Field(description="How often a worker took the run.")
    violations: int | None = Field(description="Broken rules; null unless finished.")
    at_fault_violations: int | None = Field(description="Those an ego is responsible for.")
    observations: int | None = Field(
        description="Broken rules that count only where a campaign or gate names them."
    )
    accountability: Accountability | None = Field(
        description="The strongest of its violations; null without one."
    )
    steps: int | None
    sim_time_s: float | None
    wall_time_s: float | None
    trace_sha256: str = Field(description="Empty where nothing was recorded.")


class Job(JobSummary):
    """A job, with the reason if its run failed."""

    error: Failure | None = Field(default=None, description="Why the run was not judged.")
    run_url: str = Field(description="Where the run's result is.")


def job_summary(record: JobRecord) -> JobSummary:
    """Gives a job as lists show it."""
    return JobSummary(**_fields(record))


def job_of(record: JobRecord, report: RunReport | None, run_url: str) -> Job:
    """Gives a job as its own address shows it."""
    return Job(**_fields(record), error=failure_of(report), run_url=run_url)


def failure_of(report: RunReport | None) -> Failure | None:
    """Gives why a run was not judged, if it was not."""
    if report is None or report.failure is None:
        return None
    failure = report.failure
    return Failure(cause=failure.cause, message=failure.message, log=failure.log)


def _fields(record: JobRecord) -> dict[str, object]:
    return {
        "id": record.id,
        "status": record.status,
        "cause": record.cause,
        "label": record.label,
        "batch_id": record.batch_id,
        "item": record.item,
        "town": record.town,
        "agent": record.agent,
        "seed": record.seed_override,
        "scenario_sha256": record.scenario_sha256,
        "created_at": record.created_at,
        "started_at": record.started_at,
        "ended_at": record.ended_at,
        "cancel_requested": record.cancel_requested,
        "attempts": record.attempts,
        "violations": record.violations,
        "at_fault_violations": record.at_fault_violations,
        "observations": record.observations,
        "accountability": record.accountability,
        "steps": record.steps,
        "sim_time_s": record.sim_time_s,
        "wall_time_s": record.wall_time_s,
        "trace_sha256": record.trace_sha256,
    }
