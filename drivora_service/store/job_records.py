"""From rows to records of jobs, and the query behind a filter."""

from __future__ import annotations

from sqlalchemy import ColumnElement, Select, exists, select

from drivora_service.oracles.accountability import Accountability
from drivora_service.runs.report import RunStatus
from drivora_service.store.batches import SINGLE_JOBS
from drivora_service.store.records import JobFilter, JobRecord
from drivora_service.store.tables import BatchRow, RunRow, VerdictRow

JobQuery = Select[RunRow, str]


def job_query() -> JobQuery:
    """Selects runs with the id of their batch."""
    return select(RunRow, BatchRow.id).join(BatchRow, BatchRow.seq == RunRow.batch_seq)


def filtered(query: JobQuery, wanted: JobFilter) -> JobQuery:
    """Restricts a query of :func:`job_query`."""
    if wanted.batch_id:
        # A constant for the planner, so that it walks the batch's own index.
        seq = select(BatchRow.seq).where(BatchRow.id == wanted.batch_id).scalar_subquery()
        query = query.where(RunRow.batch_seq == seq)
    if wanted.statuses:
        query = query.where(RunRow.status.in_(sorted(wanted.statuses)))
    if wanted.agent:
        query = query.where(RunRow.agent == wanted.agent)
    if wanted.town:
        query = query.where(RunRow.town == wanted.town)
    if wanted.scenario_sha256:
        query = query.where(RunRow.document_sha256 == wanted.scenario_sha256)
    if wanted.violated is not None:
        query = query.where(RunRow.violations > 0 if wanted.violated else RunRow.violations == 0)
    if wanted.accountability is not None:
        query = query.where(RunRow.accountability == wanted.accountability)
    if wanted.oracle:
        query = query.where(_has_verdict(wanted))
    return query


def to_record(row: RunRow, batch_id: str) -> JobRecord:
    """Makes the record of a row."""
    return JobRecord(
        id=row.id,
        revision=row.revision,
        batch_id="" if batch_id == SINGLE_JOBS else batch_id,
        item=row.item,
        label=row.label,
        scenario_sha256=row.document_sha256,
        town=row.town,
        agent=row.agent,
        agent_override=row.agent_override,
        seed_override=row.seed_override,
        status=RunStatus(row.status),
        cause=row.cause,
        created_at=row.created_at,
        started_at=row.started_at,
        ended_at=row.ended_at,
        cancel_requested=row.cancel_requested,
        attempts=row.attempts,
        violations=row.violations,
        at_fault_violations=row.at_fault_violations,
        observations=row.observations,
        accountability=None if row.accountability is None else Accountability(row.accountability),
        steps=row.steps,
        sim_time_s=row.sim_time_s,
        wall_time_s=row.wall_time_s,
        trace_sha256=row.trace_sha256,
    )


def _has_verdict(wanted: JobFilter) -> ColumnElement[bool]:
    said = exists().where(
        VerdictRow.run_seq == RunRow.seq,
        VerdictRow.oracle == wanted.oracle,
        VerdictRow.outcome == wanted.outcome,
    )
    return said if wanted.at_fault is None else said.where(VerdictRow.at_fault == wanted.at_fault)
