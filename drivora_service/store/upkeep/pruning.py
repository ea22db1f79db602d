"""Removing old runs and traces, in short transactions.

Rows are removed before files, so that a run never refers to a missing trace. A kill leaves files
without a run; the next pass removes them. Candidates are searched in read transactions, which do
not block writers.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from sqlalchemy import ColumnElement, delete, exists, select, update
from sqlalchemy.orm import Session

from drivora_service.runs.run_report import UNFINISHED, RunStatus
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.campaigns.campaign_tables import CampaignRow, EvaluationRow
from drivora_service.store.changes.revisions import next_revisions, revise_batches
from drivora_service.store.database import Database
from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.engine.chunks import batched
from drivora_service.store.minimizations.minimization_records import MinimizationState
from drivora_service.store.minimizations.minimization_tables import MinimizationRow
from drivora_service.store.runs.batch_repository import SINGLE_JOBS
from drivora_service.store.runs.facet_tables import FacetRow
from drivora_service.store.runs.facets import subtract_runs
from drivora_service.store.runs.run_tables import BatchRow, RunRow
from drivora_service.store.traces.trace_folders import RunTraces
from drivora_service.store.upkeep.free_space import return_free_space

_WITHOUT_RESULT = (RunStatus.CANCELLED, RunStatus.INVALID, RunStatus.INFRASTRUCTURE_FAILED)
_READ_AT_ONCE = 2000
_MOST_AT_ONCE = 400
_LEAST_AT_ONCE = 10
_TRANSACTION_S = 0.03
"""Seconds that a transaction shall take at most; other writers wait meanwhile."""


class Chosen(StrEnum):
    """The kinds of runs with retention times of their own."""

    ALL = "all"
    NOT_VIOLATED = "not violated"
    PASSED = "passed"
    """Judged without a violation, or ended without a result about the ADS."""
    FAILING = "failing"
    """All others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pruned:
    """Counts of removed things.

    Attributes:
        runs: Runs, with their reports, verdicts and attempts.
        traces: Trace files.
        freed_bytes: Size of those files.
    """

    runs: int
    traces: int
    freed_bytes: int

    def __add__(self, other: Pruned) -> Pruned:
        """Returns the sum of both."""
        return Pruned(
            runs=self.runs + other.runs,
            traces=self.traces + other.traces,
            freed_bytes=self.freed_bytes + other.freed_bytes,
        )


def prune(
    database: Database,
    traces: RunTraces,
    *,
    ended_before: datetime,
    keep_violated: bool = False,
    only_traces: bool = False,
) -> Pruned:
    """Removes runs that ended before a time, their traces, and orphaned rows and files.

    A server may run meanwhile. Runs of campaigns that are not over, and of active minimisations,
    are kept.

    Args:
        database: Holds the runs.
        traces: Folder of their traces.
        ended_before: Runs that ended later are kept.
        keep_violated: Whether runs with a violated oracle are kept at any age.
        only_traces: Whether to remove only the traces of runs.
    """
    chosen = Chosen.NOT_VIOLATED if keep_violated else Chosen.ALL
    pruned = prune_chosen(
        database, traces, chosen, ended_before=ended_before, only_traces=only_traces
    )
    pruned += remove_strays(database, traces, written_before=ended_before)
    return_free_space(database)
    return pruned


def prune_chosen(
    database: Database,
    traces: RunTraces,
    chosen: Chosen,
    *,
    ended_before: datetime,
    only_traces: bool = False,
    stopping: Callable[[], bool] = lambda: False,
) -> Pruned:
    """Removes runs of one kind as :func:`prune` does, and no orphans.

    ``stopping`` is called between two transactions and returns whether to stop early.
    """
    runs = 0
    files = Pruned(runs=0, traces=0, freed_bytes=0)
    at_once = 50
    for candidates in _candidates(database, chosen, ended_before, only_traces=only_traces):
        if stopping():
            break
        rest = list(candidates)
        while rest and not stopping():
            chunk, rest = rest[:at_once], rest[at_once:]
            with database.write() as transaction:
                begun = time.perf_counter()
                if only_traces:
                    removed = _drop_traces(transaction.session, chunk, ended_before)
                else:
                    removed = _drop_runs(transaction.session, chunk, ended_before)
            took = time.perf_counter() - begun
            at_once = round(at_once * min(max(_TRANSACTION_S / max(took, 1e-6), 0.5), 1.5))
            at_once = min(max(at_once, _LEAST_AT_ONCE), _MOST_AT_ONCE)
            runs += len(removed)
            files += _remove_files(traces, removed)
            # Waiting threads and processes shall have their turn before the next chunk.
            time.sleep(min(took, 0.1))
    if not only_traces:
        with database.write() as transaction:
            _remove_empty_batches(transaction.session, ended_before)
    return files + Pruned(runs=0 if only_traces else runs, traces=0, freed_bytes=0)


def remove_strays(database: Database, traces: RunTraces, *, written_before: datetime) -> Pruned:
    """Removes trace files without a run, such as a kill leaves behind."""
    removed = Pruned(runs=0, traces=0, freed_bytes=0)
    for run_ids in traces.run_ids_by_folder():
        wanted: set[str] = set()
        for chunk in batched(run_ids):
            with database.read() as transaction:
                wanted.update(
                    transaction.session.scalars(
                        select(RunRow.id).where(
                            RunRow.id.in_(chunk),
                            (RunRow.trace_sha256 != "") | RunRow.status.in_(UNFINISHED),
                        )
                    )
                )
        # A newer file may belong to a run that was queued after this query.
        strays = [
            run_id
            for run_id in run_ids
            if run_id not in wanted
            and traces.modification_time(run_id) < written_before.timestamp()
        ]
        removed += _remove_files(traces, strays)
    return removed


def _candidates(
    database: Database, chosen: Chosen, ended_before: datetime, *, only_traces: bool
) -> Iterator[Sequence[int]]:
    """Yields runs that are old enough, oldest first within a facet."""
    with database.read() as transaction:
        keys = transaction.session.scalars(select(FacetRow.key).where(*_facets(chosen))).all()
        of_campaigns = (
            select(BatchRow.seq)
            .join(CampaignRow, CampaignRow.batch_id == BatchRow.id)
            .where(CampaignRow.state.not_in([s for s in CampaignState if s.is_over]))
        )
        of_minimizations = (
            select(BatchRow.seq)
            .join(MinimizationRow, MinimizationRow.batch_id == BatchRow.id)
            .where(MinimizationRow.state.in_([s for s in MinimizationState if s.is_active]))
        )
        kept = set(transaction.session.scalars(of_campaigns.union(of_minimizations)))
    for key in keys:
        last = 0
        while True:
            with database.read() as transaction:
                rows = transaction.session.execute(
                    select(
                        RunRow.seq,
                        RunRow.batch_seq,
                        RunRow.created_at,
                        RunRow.ended_at,
                        RunRow.trace_sha256,
                    )
                    .where(RunRow.facet == key, RunRow.seq > last)
                    .order_by(RunRow.seq)
                    .limit(_READ_AT_ONCE)
                ).all()
            yield [
                row.seq
                for row in rows
                if row.ended_at is not None
                and row.ended_at < ended_before
                and row.batch_seq not in kept
                and not (only_traces and not row.trace_sha256)
            ]
            # Runs are numbered in the order of their submission, and end after it.
            if len(rows) < _READ_AT_ONCE or rows[-1].created_at >= ended_before:
                break
            last = rows[-1].seq


def _facets(chosen: Chosen) -> list[ColumnElement[bool]]:
    conditions: list[ColumnElement[bool]] = [FacetRow.status.not_in(UNFINISHED)]
    passed = FacetRow.violated.is_(False) | FacetRow.status.in_(_WITHOUT_RESULT)
    match chosen:
        case Chosen.NOT_VIOLATED:
            conditions.append(FacetRow.violated.is_not(True))
        case Chosen.PASSED:
            conditions.append(passed)
        case Chosen.FAILING:
            conditions.append(
                FacetRow.violated.is_not(False) & FacetRow.status.not_in(_WITHOUT_RESULT)
            )
    return conditions


def _drop_runs(session: Session, seqs: Sequence[int], ended_before: datetime) -> list[str]:
    """Deletes runs that have not changed since the search; returns their ids."""
    found = session.execute(
        select(RunRow.seq, RunRow.id, RunRow.batch_seq, RunRow.facet, RunRow.document_sha256).where(
            *_still(seqs, ended_before)
        )
    ).all()
    chosen = [row.seq for row in found]
    session.execute(delete(RunRow).where(RunRow.seq.in_(chosen)))
    subtract_runs(session, Counter((row.batch_seq, row.facet) for row in found))
    numbers = Counter(row.batch_seq for row in found)
    for batch_seq, number in numbers.items():
        session.execute(
            update(BatchRow).where(BatchRow.seq == batch_seq).values(size=BatchRow.size - number)
        )
    if numbers:
        revise_batches(session, numbers, next_revisions(session, len(numbers)))
    session.execute(
        delete(DocumentRow).where(
            DocumentRow.sha256.in_({row.document_sha256 for row in found}),
            ~exists().where(RunRow.document_sha256 == DocumentRow.sha256),
            ~exists().where(EvaluationRow.document_sha256 == DocumentRow.sha256),
        )
    )
    return [row.id for row in found]


def _drop_traces(session: Session, seqs: Sequence[int], ended_before: datetime) -> list[str]:
    rows = session.scalars(select(RunRow).where(*_still(seqs, ended_before))).all()
    for row in rows:
        row.trace_sha256 = ""
    return [row.id for row in rows]


def _still(seqs: Sequence[int], ended_before: datetime) -> tuple[ColumnElement[bool], ...]:
    return (
        RunRow.seq.in_(seqs),
        RunRow.status.not_in(UNFINISHED),
        RunRow.ended_at < ended_before,
    )


def _remove_empty_batches(session: Session, created_before: datetime) -> None:
    session.execute(
        delete(BatchRow).where(
            BatchRow.id != SINGLE_JOBS,
            BatchRow.size == 0,
            BatchRow.created_at < created_before,
            ~exists().where(RunRow.batch_seq == BatchRow.seq),
        )
    )


def _remove_files(traces: RunTraces, run_ids: Sequence[str]) -> Pruned:
    removed = freed = 0
    for run_id in run_ids:
        try:
            freed += traces.remove(run_id)
        except FileNotFoundError:
            continue
        removed += 1
    return Pruned(runs=0, traces=removed, freed_bytes=freed)
