"""Runs that were interrupted by several deaths of the server: they wait and are started last."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from datetime import datetime, timedelta
from functools import cache

from sqlalchemy import ColumnElement, Select, or_, select, true
from sqlalchemy.orm import Session

from drivora_service.runs.lifecycle import LONGEST_WAIT_S
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.queue.queued_runs import QUEUED, RUNS
from drivora_service.store.runs.run_records import BatchState
from drivora_service.store.runs.run_tables import BatchRow, RunRow


class HeldRuns:
    """The queued runs that have a ``not_before``; there are few or none."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def numbers(self) -> Mapping[int, int]:
        """Returns their numbers by the ``seq`` of their batch."""
        # Counted here: for a GROUP BY, SQLite would scan all queued runs in the order of batches.
        return Counter(
            batch_seq for (batch_seq,) in self._session.connection().execute(_select_held())
        )

    def others(self, numbers: Mapping[int, int]) -> ColumnElement[bool]:
        """Returns the condition that a batch has queued runs that are not held."""
        if not numbers:
            return true()
        full = self._session.execute(
            select(BatchRow.seq, BatchRow.queued).where(BatchRow.seq.in_(numbers))
        )
        return BatchRow.seq.not_in([row.seq for row in full if row.queued <= numbers[row.seq]])

    def due(self, now: datetime, reserved_to: str) -> int | None:
        """Returns the ``seq`` of the held run to start next.

        Returns ``None`` while another one runs, so that the one that kills the server runs alone. A
        wait beyond the longest possible one is due to a clock that was set back, and counts as
        over.
        """
        running = select(RunRow.seq).where(
            RunRow.not_before.is_not(None), RunRow.status == RunStatus.RUNNING
        )
        if self._session.scalar(running.limit(1)) is not None:
            return None
        return self._session.scalar(
            select(RunRow.seq)
            .join(BatchRow, BatchRow.seq == RunRow.batch_seq)
            .where(
                RunRow.not_before.is_not(None),
                RunRow.status == RunStatus.QUEUED,
                BatchRow.state == BatchState.OPEN,
                BatchRow.owner_id == reserved_to,
                or_(
                    RunRow.not_before <= now,
                    RunRow.not_before > now + timedelta(seconds=2 * LONGEST_WAIT_S),
                ),
            )
            .order_by(RunRow.not_before)
            .limit(1)
        )


@cache
def _select_held() -> Select[int]:
    # The status is a constant in the text, so that the query is not planned for its value.
    return select(RUNS.c.batch_seq).where(RUNS.c.not_before.is_not(None), RUNS.c.status == QUEUED)
