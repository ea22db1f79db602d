"""Pictures for the report of a campaign."""

from __future__ import annotations

from pathlib import Path

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.observations.trace_files.trace_file import read_trace
from drivora_service.plotting.run_picture import draw_run
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.studies.reports.campaign_report import CampaignReport


def draw_examples(
    report: CampaignReport, traces: Path, catalogues: Catalogues, folder: Path
) -> dict[int, Path]:
    """Draws the example of each group, if it was confirmed and its trace exists.

    An evaluation is drawn once.

    Args:
        report: The campaign.
        traces: Folder of its traces.
        catalogues: Catalogues with the road network.
        folder: Folder of the pictures; made if it does not exist.

    Returns:
        Pictures by number of the evaluation.

    Raises:
        UnknownName: The road network is no longer available.
        StoreError: A trace cannot be read.
    """
    pictures: dict[int, Path] = {}
    drawn: set[tuple[str, int | None]] = set()
    every = [failure for one in report.groups for failure in one.failures]
    for one in report.groups:
        example = one.example
        source = traces / example.trace
        group = (example.verdict.oracle, one.number)
        # The trace of a flaky failure is of a second run that drove otherwise.
        is_confirmed = example.confirmation is Confirmation.CONFIRMED
        if group in drawn or not example.trace or not is_confirmed or not source.is_file():
            continue
        drawn.add(group)
        if example.evaluation in pictures:
            continue
        trace = read_trace(source)
        verdicts = [
            failure.verdict for failure in every if failure.evaluation == example.evaluation
        ]
        folder.mkdir(parents=True, exist_ok=True)
        picture = folder / f"{example.evaluation:06d}.png"
        draw_run(trace, catalogues.networks.get(trace.network), verdicts, picture)
        pictures[example.evaluation] = picture
    return pictures
