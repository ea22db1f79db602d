"""The campaigns of this machine's data folder, to look at and to stop."""

from __future__ import annotations

import shutil
from pathlib import Path

from drivora_service.campaigns.folder import CampaignFolder, ask_for
from drivora_service.cli.campaign_results import CampaignFindings
from drivora_service.cli.embedded import settings_for
from drivora_service.settings import Settings
from drivora_service.store.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignSummary,
    EvaluationRecord,
    Failure,
)
from drivora_service.store.database import Database, open_database


class StoredCampaigns:
    """An open data folder; a context manager that closes its database.

    Attributes:
        settings: Of the data folder.
        database: Of the data folder.
    """

    def __init__(self, data_dir: Path | None) -> None:
        """Opens the database of a data folder; ``None``: the one of the environment."""
        self.settings: Settings = settings_for(data_dir)
        self.database: Database = open_database(self.settings.resolved_database_url)

    def __enter__(self) -> StoredCampaigns:
        """Returns the object itself."""
        return self

    def __exit__(self, *_exception: object) -> None:
        """Closes the database."""
        self.database.close()

    def record(self, campaign_id: str) -> CampaignRecord:
        """Returns a campaign.

        Raises:
            UnknownName: There is no such campaign.
        """
        with self.database.read() as transaction:
            return transaction.campaigns.get(campaign_id)

    def found(self, campaign_id: str) -> CampaignFindings:
        """Returns a campaign with what it has found.

        Raises:
            UnknownName: There is no such campaign.
        """
        with self.database.read() as transaction:
            record = transaction.campaigns.get(campaign_id)
            return CampaignFindings(
                record=record,
                is_running=self.is_running(record),
                kinds=transaction.campaign_views.kinds(campaign_id),
                failures=transaction.evaluations.failures(campaign_id),
            )

    def newest(self, limit: int) -> tuple[CampaignSummary, ...]:
        """Returns the newest campaigns first."""
        with self.database.read() as transaction:
            return transaction.campaigns.page(limit=limit).items

    def lineage(self, campaign_id: str, number: int) -> tuple[EvaluationRecord, ...]:
        """Returns an evaluation, last, and its ancestors.

        Raises:
            UnknownName: There is no such campaign or evaluation.
        """
        with self.database.read() as transaction:
            return transaction.evaluations.lineage(campaign_id, number)

    def scenario(self, campaign_id: str, number: int) -> str:
        """Returns the scenario of an evaluation as the text of a document.

        Raises:
            UnknownName: There is no such campaign or evaluation, or it is invalid.
        """
        from drivora_service.scenario.canonical import from_canonical
        from drivora_service.scenario.documents import document_text
        from drivora_service.scenario.exporting import to_document

        with self.database.read() as transaction:
            canonical = transaction.evaluations.document(campaign_id, number)
        return document_text(to_document(from_canonical(canonical)))

    def save_trace(self, campaign_id: str, failure: Failure, target: Path) -> None:
        """Copies the trace of a failure, if it has one."""
        trace = self.folder(campaign_id).traces / failure.trace
        if trace.is_file():
            shutil.copyfile(trace, target)

    def ask_for(self, campaign_id: str, request: CampaignRequest) -> CampaignRecord:
        """Pauses or cancels a campaign.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: It is over, so that it cannot be paused.
        """
        return ask_for(self.database, campaign_id, self.folder(campaign_id), request)

    def folder(self, campaign_id: str) -> CampaignFolder:
        """Returns the folder of a campaign."""
        return CampaignFolder(self.settings.campaigns_dir, campaign_id)

    def is_running(self, record: CampaignSummary) -> bool:
        """Whether a process works on a campaign."""
        return self.folder(record.id).is_running
