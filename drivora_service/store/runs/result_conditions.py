"""Parts of the rows of results that runs and evaluations share."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from pydantic_core import from_json
from sqlalchemy import ColumnElement, or_, select
from sqlalchemy.orm import Session

from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.runs.result_records import ResultFilter

_CELL = ("study_scenario", "study_agent", "study_method")


def is_named(wanted: ResultFilter) -> ColumnElement[bool]:
    """Returns the condition that a campaign is named, or its study."""
    return or_(CampaignRow.id.in_(wanted.campaign_ids), CampaignRow.study_id.in_(wanted.study_ids))


def campaign_columns(campaign: CampaignRow | None, number: int | None) -> dict[str, Any]:
    """Returns the columns that say where in a campaign and in a study a run belongs.

    Args:
        campaign: Its campaign, if it is of one.
        number: Number of its evaluation; ``None``: it is the run of a seed scenario.
    """
    if campaign is None:
        names = ("campaign_id", "campaign", "evaluation", "study_id")
        return dict.fromkeys((*names, *_CELL, "repetition"))
    return {
        "campaign_id": campaign.id,
        "campaign": campaign.name,
        "evaluation": number,
        "study_id": campaign.study_id,
        **{name: getattr(campaign, name) for name in _CELL},
        "repetition": campaign.repetition or None,
    }


def seeds_of(session: Session, hashes: Collection[str]) -> Mapping[str, int]:
    """Returns the seeds that scenarios have, by their hashes."""
    if not hashes:
        return {}
    rows = session.execute(
        select(DocumentRow.sha256, DocumentRow.body).where(DocumentRow.sha256.in_(hashes))
    )
    found = ((sha256, _seed(body)) for sha256, body in rows)
    return {sha256: seed for sha256, seed in found if seed is not None}


def _seed(document: str) -> int | None:
    """Returns the seed of a scenario; ``None`` for what was posted and is no scenario."""
    try:
        content = from_json(document)
    except ValueError:
        return None
    seed = content.get("seed") if isinstance(content, dict) else None
    return seed if isinstance(seed, int) and not isinstance(seed, bool) else None
