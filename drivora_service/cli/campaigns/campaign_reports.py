"""Reports of campaigns with their pictures."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.campaigns.document.campaign_reading import hash_of_networks
from drivora_service.campaigns.search.confirmation import trace_name
from drivora_service.cli.application.installation import catalogues_for
from drivora_service.cli.terminal.output import note
from drivora_service.client import Client
from drivora_service.errors import NotFound, RequestConflict, UnknownName
from drivora_service.given_names import read_stored
from drivora_service.networks.catalogue import NetworkCatalogue
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.studies.reports.campaign_report import CampaignReport, group
from drivora_service.studies.reports.campaign_report_pictures import draw_examples


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnReport:
    """A report and the pictures that were drawn for it.

    Attributes:
        pictures: By number of the evaluation.
    """

    report: CampaignReport
    pictures: Mapping[int, Path]


def draw_report(
    client: Client, campaign_id: str, data_dir: Path | None, folder: Path | None
) -> DrawnReport:
    """Reports on a campaign.

    Args:
        client: Client of the application or service with the campaign.
        campaign_id: Id of the campaign.
        data_dir: Data folder with the imported road networks for pictures.
        folder: Folder for pictures; ``None``: none are drawn.

    Raises:
        ServiceError: There is no such campaign, or the service did not answer.
    """
    campaign = client.campaign(campaign_id)
    figures = client.figures(campaign_id)
    report = CampaignReport(
        record=campaign,
        document=read_stored(CampaignDocument, campaign.document),
        figures=figures.figures,
        groups=group(tuple(client.failures(campaign_id))),
        note=figures.note,
        privileged=figures.privileged,
        seeds=campaign.seeds,
        missing=campaign.missing_results,
    )
    if folder is None:
        return DrawnReport(report=report, pictures={})
    catalogues = catalogues_for(data_dir)
    if not _has_networks(catalogues.networks, report):
        return DrawnReport(report=report, pictures={})
    with tempfile.TemporaryDirectory(prefix="drivora-") as scratch:
        fetched = _fetch_traces(report, client, Path(scratch))
        pictures = draw_examples(fetched, Path(scratch), catalogues, folder)
    return DrawnReport(report=report, pictures=pictures)


def _has_networks(networks: NetworkCatalogue, report: CampaignReport) -> bool:
    """Whether the road networks of a campaign are here; tells the user if they are not."""
    found = {}
    for town in {seed.map_region.town for seed in report.document.seeds.values()}:
        try:
            found[town] = networks.get(town)
        except UnknownName:
            note(f"no pictures: the road network {town!r} is not here; import it to have them")
            return False
    if hash_of_networks(tuple(found.values())) != report.record.network_sha256:
        note(f"no pictures: the road network {report.record.town!r} is not that of the campaign")
        return False
    return True


def _fetch_traces(report: CampaignReport, client: Client, folder: Path) -> CampaignReport:
    """Fetches the traces of the examples, and names them as a folder of traces does."""
    for one in report.groups:
        target = folder / trace_name(one.example.evaluation)
        is_confirmed = one.example.confirmation is Confirmation.CONFIRMED
        if not one.example.trace or not is_confirmed or target.exists():
            continue
        try:
            client.save_evaluation_observations(target, report.record.id, one.example.evaluation)
        except (NotFound, RequestConflict) as error:
            note(f"no picture of evaluation {one.example.evaluation}: {error}")
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
