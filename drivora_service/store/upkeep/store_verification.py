"""Checks of the store for contradictions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from sqlalchemy import func, select, text
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from drivora_service.errors import StoreError
from drivora_service.observations.trace_files.stored_trace import find_file
from drivora_service.runs.run_report import UNFINISHED, RunStatus
from drivora_service.store.database import Database
from drivora_service.store.engine.storage_faults import explain_sqlite_error
from drivora_service.store.engine.store_errors import damage_name
from drivora_service.store.runs.run_tables import BatchRow, ReportRow, RunRow
from drivora_service.store.traces.trace_folders import FailureTraces, RunTraces, run_ids
from drivora_service.store.upkeep.campaign_verification import (
    campaign_count_findings,
    failure_findings,
    traced_failures,
)
from drivora_service.store.upkeep.contradictions import Finding
from drivora_service.store.upkeep.facet_verification import facet_findings
from drivora_service.store.upkeep.lost_runs import find_lost_runs

_STRAY = (
    "no judged run has this trace: a kill left it, or the database lost its last changes or is an "
    "older backup; `drivora store prune` removes it"
)


def verify(
    database: Database,
    traces: RunTraces,
    *,
    campaigns: Path | None = None,
    campaign_traces: FailureTraces | None = None,
    hash_trace: Callable[[Path], str] | None = None,
) -> Iterator[Finding]:
    """Checks the database, and that every trace has its run or failure and every one its trace.

    Args:
        database: Read in one transaction, so a server may run meanwhile.
        traces: Folder of the traces of runs.
        campaigns: Folder of the folders of campaigns; ``None``: not checked.
        campaign_traces: Folder of the traces of failures; ``None``: not checked.
        hash_trace: Returns the hash of a trace file, to compare with the run's; ``None``: only the
            existence of the files is checked.
    """
    with database.read() as transaction:
        session = transaction.session
        damage = tuple(_damage(session, database))
        yield from damage
        if damage:
            # Whatever else does not fit may be due to it.
            return
        yield from _reports(session)
        yield from _counts(session)
        yield from facet_findings(session)
        yield from campaign_count_findings(session)
        yield from failure_findings(session)
        expected_failures = traced_failures(session)
        traced = select(RunRow.id, RunRow.attempts, RunRow.trace_sha256)
        rows = session.execute(traced.where(RunRow.trace_sha256 != ""))
        expected = {row.id: (row.attempts, row.trace_sha256) for row in rows}
        # Running runs may have a trace already.
        unfinished = set(session.scalars(select(RunRow.id).where(RunRow.status.in_(UNFINISHED))))
    lost = find_lost_runs(database, traces, campaigns)
    if lost is not None:
        yield Finding(kind="lost_runs", subject=lost.place, message=lost.message)
        return
    for run_id, (attempt, sha256) in expected.items():
        yield from _trace(run_id, partial(traces.path, run_id, attempt), sha256, hash_trace)
    if campaign_traces is not None:
        for failure in expected_failures:
            path = partial(campaign_traces.path, failure.campaign_id, failure.name)
            sha256 = failure.trace_sha256
            subject = f"{failure.campaign_id}/{failure.name}"
            yield from _trace(subject, path, sha256, hash_trace if sha256 else None)
    try:
        for run_id in run_ids(traces):
            if run_id not in expected and run_id not in unfinished:
                yield Finding(
                    kind="trace_without_run",
                    subject=traces.address(run_id),
                    message=_STRAY,
                )
    except OSError as error:
        message = f"the traces cannot be listed: {error}"
        yield Finding(kind="damaged_trace", subject=traces.place, message=message)


def _damage(session: Session, database: Database) -> Iterator[Finding]:
    if database.file is None:
        return
    try:
        found = [message for (message,) in session.execute(text("PRAGMA integrity_check"))]
    except DBAPIError as error:
        if not damage_name(error):
            raise
        # It reads rows as well, and ends at some damages.
        found = [str(error.orig)]
    damage = [" ".join(message.split()) for message in found if message != "ok"]
    for message in damage:
        yield Finding(kind="damaged_database", subject=database.file.name, message=message)
    if damage:
        advice = explain_sqlite_error(database.file, "SQLITE_CORRUPT")
        yield Finding(kind="damaged_database", subject=database.file.name, message=advice)
        return
    for table, rowid, parent, _ in session.execute(text("PRAGMA foreign_key_check")):
        message = f"row {rowid} of {table} refers to a missing row of {parent}"
        yield Finding(kind="damaged_database", subject=table, message=message)


def _reports(session: Session) -> Iterator[Finding]:
    joined = select(RunRow.id).outerjoin(ReportRow, ReportRow.run_seq == RunRow.seq)
    missing = joined.where(ReportRow.run_seq.is_(None), RunRow.status.not_in(UNFINISHED))
    for run_id in session.scalars(missing):
        message = "the run has ended and has no report"
        yield Finding(kind="missing_report", subject=run_id, message=message)
    early = joined.where(ReportRow.run_seq.is_not(None), RunRow.status.in_(UNFINISHED))
    for run_id in session.scalars(early):
        message = "the run has a report and has not ended"
        yield Finding(kind="early_report", subject=run_id, message=message)


def _counts(session: Session) -> Iterator[Finding]:
    runs = func.count(RunRow.seq)
    waiting = runs.filter(RunRow.status == RunStatus.QUEUED)
    query = (
        select(BatchRow.id, BatchRow.size, BatchRow.queued, runs, waiting)
        .outerjoin(RunRow, RunRow.batch_seq == BatchRow.seq)
        .group_by(BatchRow.seq)
    )
    for batch_id, size, queued, found, found_waiting in session.execute(query):
        if (size, queued) != (found, found_waiting):
            message = (
                f"the batch says {size} runs, {queued} of them queued; "
                f"there are {found} and {found_waiting}"
            )
            yield Finding(kind="wrong_count", subject=batch_id, message=message)


def _trace(
    subject: str,
    find_path: Callable[[], Path],
    sha256: str,
    hash_trace: Callable[[Path], str] | None,
) -> Iterator[Finding]:
    try:
        path = find_path()
    except OSError as error:
        yield Finding(kind="damaged_trace", subject=subject, message=f"cannot be fetched: {error}")
        return
    there = find_file(path)
    if there.fault:
        kind = "missing_trace" if there.is_missing else "damaged_trace"
        yield Finding(kind=kind, subject=subject, message=f"{path} {there.fault}")
        return
    if hash_trace is None:
        return
    try:
        found = hash_trace(path)
    except (OSError, ValueError, StoreError) as error:
        message = f"{path} cannot be read: {error}"
    else:
        if found == sha256:
            return
        message = f"{path} has the hash {found}, its run says {sha256}"
    yield Finding(kind="damaged_trace", subject=subject, message=message)
