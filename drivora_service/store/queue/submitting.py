"""Putting runs into the queue, many at a time."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime

from sqlalchemy import func, insert, select
from sqlalchemy.orm import Session

from drivora_service.agents.configuration import AgentConfiguration
from drivora_service.errors import Conflict, QueueFull, UnknownName
from drivora_service.runs.report_encoding import choice_to_json
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.shapes import field_names
from drivora_service.store.changes.revisions import next_revisions
from drivora_service.store.engine.ids import new_id
from drivora_service.store.engine.stored_documents import store_documents
from drivora_service.store.queue.endings import write_report
from drivora_service.store.queue.quarantine import (
    QuarantineRepository,
    make_quarantine_report,
    quarantine_key,
)
from drivora_service.store.queue.queued_candidates import source_to_json
from drivora_service.store.runs.batch_repository import single_jobs
from drivora_service.store.runs.facet_tables import FacetRow
from drivora_service.store.runs.facets import Facet, add_counts, facet_key
from drivora_service.store.runs.run_records import BatchState, NewRun, Priority, RunOptions
from drivora_service.store.runs.run_tables import BatchRow, RunRow

_RUNS_A_SECOND = 5
"""A cautious estimate of how fast a full queue empties, for ``Retry-After``."""


def submit_runs(
    session: Session,
    runs: Sequence[NewRun],
    *,
    batch_id: str,
    owner_id: str,
    queue_limit: int | None,
) -> tuple[str, ...]:
    """Implements :meth:`JobRepository.submit`."""
    batch = _batch(session, batch_id) if batch_id else _single_jobs(session, owner_id)
    if batch.state == BatchState.CANCELLED:
        raise Conflict(f"batch {batch.id} was cancelled; post its scenarios to a new one")
    ids = tuple(run.run_id or new_id() for run in runs)
    over = _already_over(session, runs, ids)
    waiting = len(runs) - len(over)
    if queue_limit is not None:
        _check_room(session, waiting, queue_limit)
    store_documents(session, {run.scenario_sha256: run.document for run in runs})
    _store_runs(session, batch, runs, ids, over)
    batch.size += len(runs)
    batch.queued += waiting
    for start in range(0, len(over), 500):
        chunk = list(over)[start : start + 500]
        for row in session.scalars(select(RunRow).where(RunRow.id.in_(chunk))):
            write_report(session, row, over[row.id], ended=row.created_at)
    session.flush()
    return ids


def _batch(session: Session, batch_id: str) -> BatchRow:
    row = session.scalar(select(BatchRow).where(BatchRow.id == batch_id))
    if row is None:
        raise UnknownName("batch", batch_id, ())
    return row


def _single_jobs(session: Session, owner_id: str) -> BatchRow:
    batch_id = single_jobs(owner_id)
    row = session.scalar(select(BatchRow).where(BatchRow.id == batch_id))
    if row is not None:
        return row
    row = BatchRow(
        id=batch_id,
        name="jobs posted alone",
        priority=Priority.INTERACTIVE.rank,
        state=BatchState.OPEN,
        created_at=datetime.now(UTC),
        size=0,
        queued=0,
        served=0,
        owner_id=owner_id,
    )
    session.add(row)
    session.flush()
    return row


def _already_over(
    session: Session, runs: Sequence[NewRun], ids: Sequence[str]
) -> dict[str, RunReport]:
    """Returns the reports of the runs that are not started, by run id."""
    keys = [
        quarantine_key(run.scenario_sha256, run.options.agent_override, run.options.seed_override)
        for run in runs
    ]
    quarantined = QuarantineRepository(session).find(frozenset(keys))
    over: dict[str, RunReport] = {}
    for run, run_id, key in zip(runs, ids, keys, strict=True):
        if run.report is not None:
            over[run_id] = replace(run.report, run_id=run_id)
        # The document of a candidate is not known before a worker has decoded its genes.
        elif key in quarantined and run.candidate is None:
            over[run_id] = make_quarantine_report(run_id, quarantined[key])
    return over


def _check_room(session: Session, more: int, limit: int) -> None:
    queued = count_queued_runs(session)
    if more and queued + more > limit:
        wait = math.ceil(min(queued + more - limit, queued) / _RUNS_A_SECOND)
        raise QueueFull(queued=queued, limit=limit, retry_after_s=max(1, min(wait, 600)))


def count_queued_runs(session: Session) -> int:
    """Returns the number of queued runs."""
    waiting = select(func.sum(FacetRow.runs)).where(FacetRow.status == RunStatus.QUEUED)
    return session.scalar(waiting) or 0


def _store_runs(
    session: Session,
    batch: BatchRow,
    runs: Sequence[NewRun],
    ids: Sequence[str],
    over: dict[str, RunReport],
) -> None:
    if not runs:
        return
    now = datetime.now(UTC)
    first = next_revisions(session, len(runs))
    facets = [_facet(run, over.get(run_id)) for run, run_id in zip(runs, ids, strict=True)]
    session.execute(
        insert(RunRow),
        [
            {
                "id": run_id,
                "revision": first + index,
                "batch_seq": batch.seq,
                "item": run.item if run.item >= 0 else index,
                "label": run.label,
                "document_sha256": run.scenario_sha256,
                "town": run.town,
                "agent": run.agent,
                "configuration": facet.configuration,
                "configuration_id": facet.configuration_id,
                **{name: getattr(run.options, name) for name in field_names(RunOptions)},
                "feedback": None if run.feedback is None else choice_to_json(run.feedback),
                "keeps_trace": run.keeps_trace,
                "candidate": None if run.candidate is None else source_to_json(run.candidate),
                "status": facet.status,
                "created_at": now,
                "facet": facet_key(facet),
            }
            for index, (run, run_id, facet) in enumerate(zip(runs, ids, facets, strict=True))
        ],
    )
    add_counts(session, Counter((batch.seq, facet) for facet in facets))


def _facet(run: NewRun, report: RunReport | None) -> Facet:
    status = RunStatus.QUEUED if report is None else report.status
    configuration = run.configuration or AgentConfiguration(words=run.agent)
    return Facet(
        agent=run.agent,
        town=run.town,
        status=status,
        violated=None,
        accountability=None,
        configuration=configuration.words,
        configuration_id=configuration.id,
    )
