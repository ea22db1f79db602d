"""Cancelling runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from datetime import UTC, datetime

from sqlalchemy import update
from sqlalchemy.orm import Session

from drivora_service.runs import lifecycle
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.queue.endings import run_state, set_run_state, write_report
from drivora_service.store.runs.run_tables import BatchRow, RunRow


def cancel_runs(session: Session, rows: Iterable[RunRow]) -> None:
    """Ends the queued runs of ``rows`` and requests the end of the running ones."""
    now = datetime.now(UTC)
    left: Counter[int] = Counter()
    for row in rows:
        was_queued = row.status == RunStatus.QUEUED
        transition = lifecycle.cancel(run_state(row), row.id)
        if transition.state == run_state(row):
            continue
        set_run_state(row, transition.state)
        if transition.report is not None:
            write_report(session, row, transition.report, ended=now)
        if was_queued:
            left[row.batch_seq] += 1
    for batch_seq, number in left.items():
        session.execute(
            update(BatchRow)
            .where(BatchRow.seq == batch_seq)
            .values(queued=BatchRow.queued - number)
        )
