"""Campaigns to look at and to stop: of a data folder, or of a service."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Protocol, Self

from drivora_service.cli.campaign_results import CampaignFindings, campaign_result
from drivora_service.store.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignSummary,
    EvaluationRecord,
    Failure,
)


class Campaigns(Protocol):
    """What commands ask for; a context manager that lets go of it."""

    def __enter__(self) -> Self:
        """Returns the object itself."""
        ...

    def __exit__(self, *_exception: object) -> None:
        """Lets go of it."""
        ...

    def found(self, campaign_id: str) -> CampaignFindings:
        """Returns a campaign with what it has found."""
        ...

    def newest(self, limit: int) -> tuple[CampaignSummary, ...]:
        """Returns the newest campaigns first."""
        ...

    def is_running(self, record: CampaignSummary) -> bool:
        """Whether a process works on a campaign."""
        ...

    def lineage(self, campaign_id: str, number: int) -> tuple[EvaluationRecord, ...]:
        """Returns an evaluation, last, and its ancestors."""
        ...

    def scenario(self, campaign_id: str, number: int) -> str:
        """Returns the scenario of an evaluation as the text of a document."""
        ...

    def save_trace(self, campaign_id: str, failure: Failure, target: Path) -> None:
        """Writes the trace of a failure, if it has one."""
        ...

    def ask_for(self, campaign_id: str, request: CampaignRequest) -> CampaignRecord:
        """Pauses or cancels a campaign."""
        ...


def open_campaigns(server: str, data_dir: Path | None) -> Campaigns:
    """Returns the campaigns of a service, or of a data folder if ``server`` is ""."""
    if server:
        from drivora_service.cli.service_campaigns import ServiceCampaigns

        return ServiceCampaigns(server)
    from drivora_service.cli.stored_campaigns import StoredCampaigns

    return StoredCampaigns(data_dir)


def export_campaign(campaigns: Campaigns, campaign_id: str, target: Path) -> None:
    """Writes a campaign's summary, and the scenario and trace of each failing evaluation."""
    found = campaigns.found(campaign_id)
    target.mkdir(parents=True, exist_ok=True)
    text = json.dumps(campaign_result(found), indent=2, ensure_ascii=False)
    (target / "campaign.json").write_text(text + "\n")
    for failure in {failure.evaluation: failure for failure in found.failures}.values():
        name = f"{failure.evaluation:06d}"
        (target / f"{name}.json").write_text(campaigns.scenario(campaign_id, failure.evaluation))
        campaigns.save_trace(campaign_id, failure, target / f"{name}.trace.parquet")
