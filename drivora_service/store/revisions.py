"""The count of changes that orders everything that happens to runs."""

from __future__ import annotations

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.store.tables import RunRow


def latest_revision(session: Session) -> int:
    """Returns the greatest revision of any run, 0 if there is none."""
    return session.scalar(select(func.max(RunRow.revision))) or 0
