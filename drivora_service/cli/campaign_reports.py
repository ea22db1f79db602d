"""Reports of campaigns with their pictures, of a data folder or of a service."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from drivora_service.campaigns.catalogues import Catalogues, installed_catalogues
from drivora_service.campaigns.confirming import trace_name
from drivora_service.campaigns.documents import CampaignDocument
from drivora_service.cli.embedded import network_catalogue, settings_for
from drivora_service.cli.output import note
from drivora_service.cli.service_campaigns import ServiceCampaigns
from drivora_service.cli.stored_campaigns import StoredCampaigns
from drivora_service.errors import UnknownName
from drivora_service.settings import Settings
from drivora_service.store.campaign_records import CampaignRecord
from drivora_service.studies.campaign_report import CampaignReport, group, read_report
from drivora_service.studies.report_pictures import draw_examples


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnReport:
    """A report and the pictures that were drawn for it.

    Attributes:
        pictures: By number of the evaluation.
    """

    report: CampaignReport
    pictures: Mapping[int, Path]


def report_here(campaign_id: str, data_dir: Path | None, folder: Path | None) -> DrawnReport:
    """Reports on a campaign of a data folder.

    Args:
        campaign_id: Which.
        data_dir: The data folder; ``None``: the one of the environment.
        folder: Where pictures go; ``None``: none are drawn.

    Raises:
        UnknownName: There is no such campaign.
    """
    with StoredCampaigns(data_dir) as campaigns:
        catalogues = _catalogues(campaigns.settings)
        report = read_report(campaigns.database, campaign_id, catalogues)
        traces = campaigns.folder(campaign_id).traces
        pictures = {} if folder is None else draw_examples(report, traces, catalogues, folder)
    return DrawnReport(report=report, pictures=pictures)


def report_of_service(
    url: str, campaign_id: str, data_dir: Path | None, folder: Path | None
) -> DrawnReport:
    """Reports on a campaign of a service.

    Args:
        url: Address of the service.
        campaign_id: Which.
        data_dir: Has the imported road networks that pictures show.
        folder: Where pictures go; ``None``: none are drawn.

    Raises:
        ServiceError: There is no such campaign, or the service did not answer.
    """
    with ServiceCampaigns(url) as service:
        found = service.found(campaign_id)
        figures, why_not = service.figures(campaign_id)
        report = CampaignReport(
            record=found.record,
            document=CampaignDocument.model_validate(found.record.document),
            figures=figures,
            groups=group(found.failures),
            note=why_not,
        )
        catalogues = _catalogues(settings_for(data_dir))
        if folder is None or not _has_network(catalogues, found.record):
            return DrawnReport(report=report, pictures={})
        with tempfile.TemporaryDirectory(prefix="drivora-") as scratch:
            fetched = _with_traces(report, service, Path(scratch))
            pictures = draw_examples(fetched, Path(scratch), catalogues, folder)
    return DrawnReport(report=report, pictures=pictures)


def _catalogues(settings: Settings) -> Catalogues:
    return installed_catalogues(network_catalogue(settings), settings.agents_folder)


def _has_network(catalogues: Catalogues, record: CampaignRecord) -> bool:
    """Says whether the road network of a campaign is here; tells the user if it is not."""
    try:
        network = catalogues.networks.get(record.town)
    except UnknownName:
        note(f"no pictures: the road network {record.town!r} is not here; import it to have them")
        return False
    if network.sha256 != record.network_sha256:
        note(f"no pictures: the road network {record.town!r} is not the one of the service")
        return False
    return True


def _with_traces(report: CampaignReport, service: ServiceCampaigns, folder: Path) -> CampaignReport:
    """Fetches the traces of the examples, and names them as a folder of traces does."""
    for one in report.groups:
        target = folder / trace_name(one.example.evaluation)
        if not target.exists():
            service.save_trace(report.record.id, one.example, target)
    groups = tuple(
        replace(
            one,
            failures=tuple(
                replace(failure, trace=trace_name(failure.evaluation) if failure.trace else "")
                for failure in one.failures
            ),
        )
        for one in report.groups
    )
    return replace(report, groups=groups)
