"""The unfinished work on a road network."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.runs.run_report import UNFINISHED
from drivora_service.store.campaigns.campaign_records import CampaignState
from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.store.minimizations.minimization_records import MinimizationState
from drivora_service.store.minimizations.minimization_tables import MinimizationRow
from drivora_service.store.runs.facet_tables import FacetRow


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkUse:
    """Numbers of unfinished runs, and of campaigns and minimisations that services work on."""

    runs: int
    campaigns: int
    minimizations: int

    @property
    def counted(self) -> str:
        """The numbers in words; "" if there is no such work."""
        return ", ".join(
            f"{number} {what}{'' if number == 1 else 's'}"
            for number, what in (
                (self.runs, "run"),
                (self.campaigns, "campaign"),
                (self.minimizations, "minimisation"),
            )
            if number
        )


def network_use(session: Session, name: str) -> NetworkUse:
    """Counts the unfinished work on a network."""
    runs = session.scalar(
        select(func.sum(FacetRow.runs)).where(
            FacetRow.town == name, FacetRow.status.in_(UNFINISHED)
        )
    )
    # Those of commands have no batch, and their end is not known where the command was killed.
    campaigns = session.execute(
        select(CampaignRow.town, CampaignRow.document).where(
            CampaignRow.batch_id != "",
            CampaignRow.state.in_((CampaignState.QUEUED, CampaignState.RUNNING)),
        )
    ).all()
    minimizations = session.scalars(
        select(MinimizationRow.document).where(
            MinimizationRow.owner_id == "",
            MinimizationRow.state.in_([state for state in MinimizationState if state.is_active]),
        )
    ).all()
    return NetworkUse(
        runs=runs or 0,
        campaigns=sum(name in {town, *_towns(document)} for town, document in campaigns),
        minimizations=sum(_town(json.loads(document)) == name for document in minimizations),
    )


def _towns(document: str) -> Iterator[str]:
    """Returns the networks of the seed scenarios of a campaign that has several."""
    for seed in json.loads(document).get("scenarios") or ():
        yield _town(seed["scenario"])


def _town(scenario: dict[str, Any]) -> str:
    town: str = scenario["map_region"]["town"]
    return town
