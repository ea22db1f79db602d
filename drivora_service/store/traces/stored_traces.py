"""Which trace is that of a stored run: that of the attempt that ended it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.store.database import Database
from drivora_service.store.runs.run_tables import RunRow
from drivora_service.store.traces.trace_folders import RunTraces


def find_trace_path(database: Callable[[], Database], traces: RunTraces, run_id: str) -> Path:
    """Returns the path of the trace of a run, which may not exist.

    Args:
        database: Returns the database of the runs.
        traces: Their traces.
        run_id: Id of the run, which may not exist either.

    Raises:
        OSError: The storage does not answer.
    """
    with database().read() as transaction:
        attempt = last_attempt(transaction.session, run_id)
    return traces.path(run_id, attempt)


def last_attempt(session: Session, run_id: str) -> int:
    """Returns the number of the last attempt at a run; 1 if there is no such run."""
    return session.scalar(select(RunRow.attempts).where(RunRow.id == run_id)) or 1
