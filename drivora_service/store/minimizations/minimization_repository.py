"""Minimisations: storing and reading them, and the answers of their runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TypeVar

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.errors import Conflict, UnknownName
from drivora_service.oracles.verdicts.failure_identity import FailureIdentity
from drivora_service.runs.report_encoding import report_from_json
from drivora_service.runs.run_report import UNFINISHED, RunReport
from drivora_service.shapes import adapter, combine, to_json
from drivora_service.store.engine.ids import new_id
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.minimizations.minimization_records import (
    MinimizationProgress,
    MinimizationRecord,
    MinimizationState,
    MinimizationSummary,
    NewMinimization,
)
from drivora_service.store.minimizations.minimization_tables import MinimizationRow
from drivora_service.store.runs.batch_repository import BatchRepository
from drivora_service.store.runs.run_records import BatchState, Page, Priority
from drivora_service.store.runs.run_tables import BatchRow, ReportRow, RunRow

Kind = TypeVar("Kind", bound=MinimizationSummary)

_MOST_NAMED = 5
"""Number of minimisations that an error names, newest first."""
_ACTIVE = tuple(state for state in MinimizationState if state.is_active)


@dataclass(frozen=True, slots=True, kw_only=True)
class ActiveMinimization:
    """A minimisation that a process works on.

    Attributes:
        run_id: Run that fails.
        document: The scenario that it begins with, as JSON.
    """

    id: str
    run_id: str
    batch_id: str
    failure: FailureIdentity
    budget: int
    document: str


class MinimizationRepository:
    """Reads and writes minimisations."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def open(self, new: NewMinimization) -> str:
        """Stores a minimisation with an empty batch, or reopens an equal one; returns its id.

        One whose command has ended is reopened, and goes on from its stored runs.
        """
        failure = to_json(FailureIdentity, new.failure).decode()
        row = self._session.scalar(
            select(MinimizationRow)
            .where(
                MinimizationRow.run_id == new.run_id,
                MinimizationRow.failure == failure,
                MinimizationRow.budget == new.budget,
                MinimizationRow.document == new.document,
                MinimizationRow.state == MinimizationState.INTERRUPTED,
            )
            .order_by(MinimizationRow.seq.desc())
            .limit(1)
        )
        if row is not None:
            self._reopen(row, new.owner_id)
            return row.id
        # What a user waits for comes before campaigns, and after single runs.
        batch = BatchRepository(self._session).create(
            name=f"minimise {new.run_id}", priority=Priority.CI, owner_id=new.owner_id
        )
        row = MinimizationRow(
            id=new_id(),
            run_id=new.run_id,
            batch_id=batch.id,
            owner_id=new.owner_id,
            state=MinimizationState.QUEUED,
            failure=failure,
            budget=new.budget,
            document=new.document,
            progress=to_json(MinimizationProgress, MinimizationProgress()).decode(),
            created_at=datetime.now(UTC),
        )
        self._session.add(row)
        self._session.flush()
        return row.id

    def get(self, minimization_id: str) -> MinimizationRecord:
        """Returns a minimisation.

        Raises:
            UnknownName: There is none of this id.
        """
        return _record(MinimizationRecord, self._row(minimization_id))

    def page(
        self, *, run_id: str = "", limit: int = 50, page_token: str = ""
    ) -> Page[MinimizationSummary]:
        """Returns minimisations, newest first.

        Args:
            run_id: Only those of this run; "": of any.
            limit: Greatest number of them.
            page_token: Token of the page.

        Raises:
            InvalidDocument: The token is not one of this list.
        """
        scope = f"minimizations {run_id}"
        query = select(MinimizationRow).order_by(MinimizationRow.seq.desc()).limit(limit + 1)
        if run_id:
            query = query.where(MinimizationRow.run_id == run_id)
        if page_token:
            query = query.where(MinimizationRow.seq < read_token(scope, page_token))
        rows = self._session.scalars(query).all()
        more = make_token(scope, rows[limit - 1].seq) if len(rows) > limit else ""
        items = tuple(_record(MinimizationSummary, row) for row in rows[:limit])
        return Page(items=items, next_page_token=more)

    def active(self, owner_id: str) -> tuple[ActiveMinimization, ...]:
        """Returns the minimisations that a process works on, oldest first; "": any service."""
        rows = self._session.scalars(
            select(MinimizationRow)
            .where(MinimizationRow.owner_id == owner_id, MinimizationRow.state.in_(_ACTIVE))
            .order_by(MinimizationRow.seq)
        )
        return tuple(combine(ActiveMinimization, row, failure=_failure(row)) for row in rows)

    def reports(self, minimization_id: str) -> Iterator[RunReport]:
        """Yields the reports of all its runs that have ended."""
        bodies = self._session.scalars(
            select(ReportRow.body)
            .join(RunRow, RunRow.seq == ReportRow.run_seq)
            .join(BatchRow, BatchRow.seq == RunRow.batch_seq)
            .where(BatchRow.id == self._row(minimization_id).batch_id)
        )
        return map(report_from_json, bodies)

    def unfinished_runs(self, minimization_id: str) -> tuple[str, ...]:
        """Returns the ids of its runs that are queued or running."""
        ids = self._session.scalars(
            select(RunRow.id)
            .join(BatchRow, BatchRow.seq == RunRow.batch_seq)
            .where(
                BatchRow.id == self._row(minimization_id).batch_id,
                RunRow.status.in_(UNFINISHED),
            )
        )
        return tuple(ids)

    def advance(
        self,
        minimization_id: str,
        progress: MinimizationProgress,
        state: MinimizationState = MinimizationState.RUNNING,
        *,
        message: str = "",
    ) -> None:
        """Stores how far an active minimisation is, or how it has ended.

        Raises:
            UnknownName: There is none of this id.
            Conflict: It is not active.
        """
        row = self._row(minimization_id)
        if row.state not in _ACTIVE:
            raise Conflict(f"minimisation {minimization_id} is {row.state}")
        now = datetime.now(UTC)
        row.progress = to_json(MinimizationProgress, progress).decode()
        row.started_at = row.started_at or now
        row.state, row.message = state, message
        if not state.is_active:
            row.ended_at = now

    def cancel(self, minimization_id: str) -> None:
        """Cancels a minimisation and its runs; one that has ended is unchanged.

        Raises:
            UnknownName: There is none of this id.
        """
        row = self._row(minimization_id)
        state = MinimizationState(row.state)
        if state.is_active or state is MinimizationState.INTERRUPTED:
            row.state, row.ended_at = MinimizationState.CANCELLED, datetime.now(UTC)
            BatchRepository(self._session).cancel(row.batch_id)

    def interrupt(self, owner_id: str) -> None:
        """Stores that the process of a command has ended without its minimisations."""
        rows = self._session.scalars(
            select(MinimizationRow).where(
                MinimizationRow.owner_id == owner_id, MinimizationRow.state.in_(_ACTIVE)
            )
        )
        for row in rows:
            row.state = MinimizationState.INTERRUPTED

    def _reopen(self, row: MinimizationRow, owner_id: str) -> None:
        row.state, row.owner_id = MinimizationState.QUEUED, owner_id
        batch = self._session.scalars(select(BatchRow).where(BatchRow.id == row.batch_id)).one()
        batch.state, batch.owner_id = BatchState.OPEN, owner_id

    def _row(self, minimization_id: str) -> MinimizationRow:
        row = self._session.scalar(
            select(MinimizationRow).where(MinimizationRow.id == minimization_id)
        )
        if row is None:
            ids = self._session.scalars(
                select(MinimizationRow.id).order_by(MinimizationRow.seq.desc()).limit(_MOST_NAMED)
            )
            raise UnknownName("minimisation", minimization_id, tuple(ids))
        return row


def _record(kind: type[Kind], row: MinimizationRow) -> Kind:
    progress: MinimizationProgress = adapter(MinimizationProgress).validate_json(row.progress)
    return combine(
        kind,
        progress,
        id=row.id,
        run_id=row.run_id,
        state=MinimizationState(row.state),
        message=row.message,
        failure=_failure(row),
        budget=row.budget,
        batch_id=row.batch_id,
        created_at=row.created_at,
        started_at=row.started_at,
        ended_at=row.ended_at,
        revision=row.revision,
    )


def _failure(row: MinimizationRow) -> FailureIdentity:
    found: FailureIdentity = adapter(FailureIdentity).validate_json(row.failure)
    return found
