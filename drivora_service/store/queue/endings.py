"""Writing the end of a run: the row, the report and the verdicts, exactly once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import delete
from sqlalchemy.orm import Session

from drivora_service.oracles.verdict import Severity
from drivora_service.oracles.verdicts.accountability import strongest_of
from drivora_service.oracles.verdicts.failure_definition import (
    FailureDefinition,
    definition_from_json,
)
from drivora_service.runs.candidate import Candidate
from drivora_service.runs.lifecycle import RunState
from drivora_service.runs.report_encoding import report_to_json
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.store.failures.failure_writing import (
    forget_found,
    make_found_rows_of_run,
    write_found_in_runs,
)
from drivora_service.store.queue.queued_candidates import candidate_to_json
from drivora_service.store.runs.facets import facet_key, facet_of
from drivora_service.store.runs.notable_verdicts import (
    NotableVerdict,
    count_failures_of,
    notable_verdicts,
)
from drivora_service.store.runs.run_tables import ReportRow, RunRow, VerdictRow


def run_state(row: RunRow) -> RunState:
    """Returns a row's state in the life cycle."""
    return RunState(
        status=RunStatus(row.status),
        infrastructure_failures=row.infrastructure_failures,
        crashes=row.crashes,
        interruptions=row.interruptions,
        cancel_requested=row.cancel_requested,
    )


def set_run_state(row: RunRow, state: RunState) -> None:
    """Writes a row's state in the life cycle."""
    row.status = state.status
    row.infrastructure_failures = state.infrastructure_failures
    row.crashes = state.crashes
    row.interruptions = state.interruptions
    row.cancel_requested = state.cancel_requested


def reset_run(session: Session, row: RunRow) -> None:
    """Resets an ended run to its state before the first attempt; its attempts stay on record."""
    session.execute(delete(ReportRow).where(ReportRow.run_seq == row.seq))
    session.execute(delete(VerdictRow).where(VerdictRow.run_seq == row.seq))
    forget_found(session, row.seq)
    row.cause = row.trace_sha256 = ""
    row.started_at = row.ended_at = row.not_before = None
    row.violations = row.at_fault_violations = row.observations = row.failures = None
    row.accountability = None
    row.steps = row.sim_time_s = row.wall_time_s = None
    row.infrastructure_failures = row.crashes = row.interruptions = 0
    row.cancel_requested = False


def write_report(session: Session, row: RunRow, report: RunReport, *, ended: datetime) -> None:
    """Writes the report of one run that has just ended; ``store.queue.run_batches`` writes many."""
    definition = definition_from_json(row.definition)
    notable = notable_verdicts(report, definition)
    values = end_values(
        report, definition, keeps_trace=row.keeps_trace, ended=ended, notable=notable
    )
    for name, value in values.items():
        setattr(row, name, value)
    facet = facet_key(facet_of(row))
    session.add(ReportRow(**report_values(row.seq, report)))
    session.add_all(
        VerdictRow(**values) for values in verdict_values(row.seq, row.batch_seq, facet, notable)
    )
    found = make_found_rows_of_run(
        notable,
        run_seq=row.seq,
        batch_seq=row.batch_seq,
        agent=row.agent,
        configuration=row.configuration,
        configuration_id=row.configuration_id,
        town=row.town,
        found_at=ended,
    )
    write_found_in_runs(session, found)


def end_values(
    report: RunReport,
    definition: FailureDefinition,
    *,
    keeps_trace: bool,
    ended: datetime,
    notable: Sequence[NotableVerdict] | None = None,
) -> dict[str, Any]:
    """Returns the columns of a run that its report determines, its status left out.

    Args:
        report: The report.
        definition: What counts as a failure of the run.
        keeps_trace: Whether the run has a trace.
        ended: Time of its end.
        notable: The verdicts that did not pass, if the caller needs them, too.
    """
    notable = notable_verdicts(report, definition) if notable is None else notable
    finished = report.status is RunStatus.FINISHED
    violations = [one for one in notable if one.is_violation]
    observations = sum(one.verdict.severity is Severity.OBSERVATION for one in notable)
    return {
        "ended_at": ended,
        "cause": report.failure.cause if report.failure is not None else "",
        "trace_sha256": report.trace_sha256 if keeps_trace else "",
        "violations": len(violations) if finished else None,
        "at_fault_violations": (
            sum(1 for one in violations if one.verdict.at_fault) if finished else None
        ),
        "observations": observations if finished else None,
        "failures": count_failures_of(report, definition, notable),
        "accountability": strongest_of(
            one.accountability for one in violations if one.accountability is not None
        ),
        "steps": report.steps if finished else None,
        "sim_time_s": report.sim_time_s if finished else None,
        "wall_time_s": report.wall_time_s if finished else None,
    }


def report_values(
    run_seq: int, report: RunReport, candidate: Candidate | None = None
) -> dict[str, Any]:
    """Returns the columns of a report, with what the genes of its run decode to."""
    return {
        "run_seq": run_seq,
        "body": report_to_json(report),
        "candidate": None if candidate is None else candidate_to_json(candidate),
    }


def verdict_values(
    run_seq: int, batch_seq: int, facet: int, notable: Iterable[NotableVerdict]
) -> list[dict[str, Any]]:
    """Returns the columns of the verdicts that are stored, a mapping each."""
    return [
        {
            "run_seq": run_seq,
            "oracle": verdict.oracle,
            "ego": verdict.ego,
            "outcome": verdict.outcome,
            "severity": verdict.severity,
            "at_fault": verdict.at_fault,
            "accountability": accountable,
            "time": verdict.time,
            "counterpart": verdict.counterpart,
            "batch_seq": batch_seq,
            "facet": facet,
        }
        for _, verdict, accountable, _, _ in notable
    ]
