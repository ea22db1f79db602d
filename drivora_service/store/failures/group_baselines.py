"""Baselines that groups of failures are compared with."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.store.campaigns.campaign_tables import CampaignRow, StudyRow
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.runs.run_tables import BatchRow


def baseline_of(session: Session, wanted: FoundFilter, text: str) -> FoundFilter:
    """Returns the filter of the failures of a baseline.

    Args:
        session: Session of the transaction.
        wanted: Filter of the failures that are compared with it.
        text: A time with its zone, before which the baseline's failures were found; or the id of
            the batch, campaign or study that found them.

    Raises:
        InvalidDocument: It is neither.
    """
    time = _time(text)
    if time is not None:
        return replace(wanted, since=None, until=min(time, wanted.until or time))
    free = replace(wanted, since=None, until=None, batch_id="", campaign_id="", study_id="")
    if _is_there(session, BatchRow, text):
        return replace(free, batch_id=text)
    if _is_there(session, CampaignRow, text):
        return replace(free, campaign_id=text)
    if _is_there(session, StudyRow, text):
        return replace(free, study_id=text)
    raise InvalidDocument(
        (
            Problem(
                pointer="/baseline",
                code="unknown_baseline",
                message=f"found {text!r}; a time such as 2026-11-20T08:00:00Z, or the id of a "
                "batch, a campaign or a study is needed",
            ),
        )
    )


def _is_there(session: Session, row: Any, text: str) -> bool:
    return session.scalar(select(row.seq).where(row.id == text)) is not None


def _time(text: str) -> datetime | None:
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        return None
    return found if found.tzinfo else None
