"""Writing the end of a run: the row, the report and the verdicts, exactly once."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import delete
from sqlalchemy.orm import Session

from drivora_service.oracles.accountability import accountability, strongest
from drivora_service.oracles.verdict import Outcome, Severity
from drivora_service.runs.encoding import report_to_json
from drivora_service.runs.lifecycle import RunState
from drivora_service.runs.report import RunReport, RunStatus
from drivora_service.store.facets import facet_key, facet_of
from drivora_service.store.tables import ReportRow, RunRow, VerdictRow


def run_state(row: RunRow) -> RunState:
    """Returns a row's state in the life cycle."""
    return RunState(
        status=RunStatus(row.status),
        infrastructure_failures=row.infrastructure_failures,
        crashes=row.crashes,
        interruptions=row.interruptions,
        cancel_requested=row.cancel_requested,
    )


def set_run_state(row: RunRow, state: RunState, *, revision: int) -> None:
    """Writes a row's state in the life cycle."""
    row.status = state.status
    row.infrastructure_failures = state.infrastructure_failures
    row.crashes = state.crashes
    row.interruptions = state.interruptions
    row.cancel_requested = state.cancel_requested
    row.revision = revision


def reset_run(session: Session, row: RunRow) -> None:
    """Resets an ended run to its state before the first attempt; its attempts stay on record."""
    session.execute(delete(ReportRow).where(ReportRow.run_seq == row.seq))
    session.execute(delete(VerdictRow).where(VerdictRow.run_seq == row.seq))
    row.cause = row.trace_sha256 = ""
    row.started_at = row.ended_at = row.not_before = None
    row.violations = row.at_fault_violations = row.observations = None
    row.accountability = None
    row.steps = row.sim_time_s = row.wall_time_s = None
    row.infrastructure_failures = row.crashes = row.interruptions = 0
    row.cancel_requested = False


def write_report(session: Session, row: RunRow, report: RunReport, *, ended: datetime) -> None:
    """Writes the report of a run that has just ended."""
    row.ended_at = ended
    row.cause = report.failure.cause if report.failure is not None else ""
    row.trace_sha256 = report.trace_sha256 if row.keeps_trace else ""
    if report.status is RunStatus.FINISHED:
        broken = [v for v in report.verdicts if v.outcome is Outcome.VIOLATED]
        violations = [v for v in broken if v.severity is not Severity.OBSERVATION]
        row.violations = len(violations)
        row.at_fault_violations = sum(1 for v in violations if v.at_fault)
        row.observations = len(broken) - len(violations)
        row.accountability = strongest(violations)
        row.steps = report.steps
        row.sim_time_s = report.sim_time_s
        row.wall_time_s = report.wall_time_s
    facet = facet_key(facet_of(row))
    session.add(ReportRow(run_seq=row.seq, body=report_to_json(report)))
    session.add_all(
        VerdictRow(
            run_seq=row.seq,
            oracle=verdict.oracle,
            ego=verdict.ego,
            outcome=verdict.outcome,
            severity=verdict.severity,
            at_fault=verdict.at_fault,
            accountability=accountability(verdict) if verdict.outcome is Outcome.VIOLATED else None,
            time=verdict.time,
            counterpart=verdict.counterpart,
            batch_seq=row.batch_seq,
            facet=facet,
        )
        for verdict in report.verdicts
        if verdict.outcome is not Outcome.PASSED
    )
