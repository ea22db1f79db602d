"""From rows to records of jobs."""

from __future__ import annotations

from sqlalchemy import Select, select

from drivora_service.oracles.accountability import Accountability
from drivora_service.runs.report import RunStatus
from drivora_service.store.batches import SINGLE_JOBS
from drivora_service.store.records import JobRecord
from drivora_service.store.tables import BatchRow, RunRow

JobQuery = Select[RunRow, str]


def job_query() -> JobQuery:
    """Selects runs with the id of their batch."""
    return select(RunRow, BatchRow.id).join(BatchRow, BatchRow.seq == RunRow.batch_seq)


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
