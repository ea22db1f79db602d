"""Counts and sizes of the whole store, for operators."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from sqlalchemy import func, select, text
from sqlalchemy.orm import Session

from drivora_service.runs.run_report import RunStatus
from drivora_service.store.runs.facet_tables import FacetRow
from drivora_service.store.runs.run_tables import BatchRow, QuarantineRow, RunRow

_WITH_CAUSE = tuple(
    status.value
    for status in RunStatus
    if status not in (RunStatus.QUEUED, RunStatus.RUNNING, RunStatus.FINISHED)
)


@dataclass(frozen=True, slots=True, kw_only=True)
class StoreFigures:
    """Figures of the store at one moment.

    Attributes:
        failures: Runs that did not finish, by status and cause.
        oldest_queued_at: Submission time of the oldest queued run that may start; runs of paused
            batches are left out. ``None`` if there is none.
        quarantined: Scenarios in quarantine.
        database_bytes: Size of the database with its write-ahead log.
    """

    failures: Mapping[tuple[RunStatus, str], int]
    oldest_queued_at: datetime | None
    quarantined: int
    database_bytes: int


class FigureRepository:
    """Reads figures; their cost grows with failed and queued runs, not with all runs."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def figures(self) -> StoreFigures:
        """Returns the current figures."""
        facets = select(FacetRow.key).where(FacetRow.status.in_(_WITH_CAUSE), FacetRow.runs > 0)
        failures = self._session.execute(
            select(RunRow.status, RunRow.cause, func.count())
            .where(RunRow.facet.in_(facets))
            .group_by(RunRow.status, RunRow.cause)
        )
        quarantined = self._session.scalar(select(func.count()).select_from(QuarantineRow))
        return StoreFigures(
            failures={(RunStatus(status), cause): number for status, cause, number in failures},
            oldest_queued_at=self._oldest_queued_at(),
            quarantined=quarantined or 0,
            database_bytes=self._database_bytes(),
        )

    def _oldest_queued_at(self) -> datetime | None:
        open_batches = select(BatchRow.seq).where(BatchRow.queued > 0, BatchRow.state == "open")
        first = select(func.min(RunRow.seq)).where(
            RunRow.status == RunStatus.QUEUED.value, RunRow.batch_seq.in_(open_batches)
        )
        return self._session.scalar(
            select(RunRow.created_at).where(RunRow.seq == first.scalar_subquery())
        )

    def _database_bytes(self) -> int:
        engine = self._session.get_bind()
        if engine.dialect.name != "sqlite":
            return self._session.scalar(text("SELECT pg_database_size(current_database())")) or 0
        file = self._session.connection().engine.url.database or ""
        size = 0
        for suffix in ("", "-wal"):
            # The write-ahead log may be missing.
            with contextlib.suppress(OSError):
                size += Path(file + suffix).stat().st_size
        return size
