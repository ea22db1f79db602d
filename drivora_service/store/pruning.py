"""Removing what nobody needs any more."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import delete, exists, select, update
from sqlalchemy.orm import Session

from drivora_service.runs.report import RunStatus
from drivora_service.store.batches import SINGLE_JOBS
from drivora_service.store.campaign_tables import EvaluationRow
from drivora_service.store.database import Database
from drivora_service.store.facets import subtract_runs
from drivora_service.store.revisions import latest_revision
from drivora_service.store.tables import AttemptRow, BatchRow, DocumentRow, OwnerRow, RunRow
from drivora_service.store.traces import TraceFolder

_CHUNK = 500
_UNFINISHED = (RunStatus.QUEUED, RunStatus.RUNNING)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pruned:
    """What was removed.

    Attributes:
        runs: Runs, with their reports, verdicts and attempts.
        traces: Trace files.
        freed_bytes: Size of those files.
    """

    runs: int
    traces: int
    freed_bytes: int


def prune(
    database: Database,
    traces: TraceFolder,
    *,
    ended_before: datetime,
    keep_violated: bool = False,
    only_traces: bool = False,
) -> Pruned:
    """Removes runs that ended before a moment, their traces, and what is left without an owner.

    Rows go before files, so that a run never claims a trace that is gone; a server may go on
    meanwhile.

    Args:
        database: Where the runs are.
        traces: Where their traces are.
        ended_before: Runs that ended later stay.
        keep_violated: Whether runs with a broken rule stay, whatever their age.
        only_traces: Whether runs stay and lose only their traces.
    """
    runs = 0
    while True:
        with database.write() as transaction:
            count = _prune_chunk(
                transaction.session, ended_before, keep_violated, only_traces=only_traces
            )
        runs += count
        if count < _CHUNK:
            break
    with database.write() as transaction:
        _remove_orphans(transaction.session, ended_before)
    with database.read() as transaction:
        wanted = set(
            transaction.session.scalars(
                select(RunRow.id).where(
                    (RunRow.trace_sha256 != "") | RunRow.status.in_(_UNFINISHED)
                )
            )
        )
    removed, freed = _remove_traces(traces, wanted, written_before=ended_before)
    return Pruned(runs=0 if only_traces else runs, traces=removed, freed_bytes=freed)


def _prune_chunk(
    session: Session, ended_before: datetime, keep_violated: bool, *, only_traces: bool
) -> int:
    query = select(RunRow.seq, RunRow.batch_seq, RunRow.facet).where(
        RunRow.status.not_in(_UNFINISHED), RunRow.ended_at < ended_before
    )
    if keep_violated:
        query = query.where((RunRow.violations == 0) | RunRow.violations.is_(None))
    if only_traces:
        query = query.where(RunRow.trace_sha256 != "")
    found = session.execute(query.order_by(RunRow.seq).limit(_CHUNK)).all()
    chosen = RunRow.seq.in_([seq for seq, _, _ in found])
    if only_traces:
        changed = latest_revision(session)
        session.execute(
            update(RunRow).where(chosen).values(trace_sha256="", revision=RunRow.seq + changed)
        )
        return len(found)
    session.execute(delete(RunRow).where(chosen))
    subtract_runs(session, Counter((batch, facet) for _, batch, facet in found))
    for batch_seq, number in Counter(batch for _, batch, _ in found).items():
        session.execute(
            update(BatchRow).where(BatchRow.seq == batch_seq).values(size=BatchRow.size - number)
        )
    return len(found)


def _remove_orphans(session: Session, ended_before: datetime) -> None:
    session.execute(
        delete(BatchRow).where(
            BatchRow.id != SINGLE_JOBS,
            BatchRow.size == 0,
            BatchRow.created_at < ended_before,
            ~exists().where(RunRow.batch_seq == BatchRow.seq),
        )
    )
    session.execute(
        delete(DocumentRow).where(
            ~exists().where(RunRow.document_sha256 == DocumentRow.sha256),
            ~exists().where(EvaluationRow.document_sha256 == DocumentRow.sha256),
        )
    )
    session.execute(
        delete(OwnerRow).where(
            OwnerRow.ended_at.is_not(None), ~exists().where(AttemptRow.owner_id == OwnerRow.id)
        )
    )


def _remove_traces(
    traces: TraceFolder, wanted: set[str], *, written_before: datetime
) -> tuple[int, int]:
    removed = freed = 0
    for run_id in traces.run_ids():
        path = traces.path(run_id)
        about = path.stat()
        # A file that is newer may be of a run that was queued after we looked.
        if run_id in wanted or about.st_mtime >= written_before.timestamp():
            continue
        freed += about.st_size
        path.unlink()
        removed += 1
    return removed, freed
