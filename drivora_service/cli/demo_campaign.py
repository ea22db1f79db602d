"""The campaign of the demo: several egos with the same ADS at an all-way stop."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from drivora_service.cli.campaign_files import read_campaign_file, shipped_campaigns
from drivora_service.cli.campaign_results import CampaignFindings, print_campaign
from drivora_service.cli.campaigns import export_campaign
from drivora_service.cli.drawing import draw_trace
from drivora_service.cli.embedded import settings_for
from drivora_service.cli.output import note
from drivora_service.cli.service_campaigns import ServiceCampaigns

_EXAMPLE = "side-collision.yaml"


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoCampaign:
    """What the campaign left behind.

    Attributes:
        file: The campaign, with its scenario in it.
        folder: With the scenario and the trace of each failure.
        pictures: Of the first failure of each kind, beside its trace.
    """

    found: CampaignFindings
    file: Path
    folder: Path
    pictures: tuple[Path, ...]


def search_on(url: str, data_dir: Path, *, simulations: int) -> DemoCampaign:
    """Has a service run the campaign, shows it meanwhile, and then what it has found.

    Args:
        url: Address of the service.
        data_dir: Folder of the demo.
        simulations: Budget of the campaign.

    Raises:
        ServiceError: The service refused or did not answer.
    """
    file = _write_campaign(data_dir, simulations)
    with ServiceCampaigns(url) as campaigns:
        record, _ = campaigns.post(file)
        note(f"the campaign in {file} searches for failures: {record.name}")
        campaigns.follow(record.id)
        folder = data_dir / "failures"
        export_campaign(campaigns, record.id, folder)
        found = campaigns.found(record.id)
    print_campaign(found)
    return DemoCampaign(
        found=found, file=file, folder=folder, pictures=_draw(found, folder, data_dir)
    )


def _write_campaign(data_dir: Path, simulations: int) -> Path:
    """Keeps the campaign as one file that `drivora campaign run` takes."""
    content = read_campaign_file(shipped_campaigns() / _EXAMPLE)
    content["budget"] = {"simulations": simulations}
    file = data_dir / "campaign.json"
    file.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    return file


def _draw(found: CampaignFindings, folder: Path, data_dir: Path) -> tuple[Path, ...]:
    settings = settings_for(data_dir)
    pictures = []
    for number in sorted({kind.first for kind in found.kinds}):
        trace = folder / f"{number:06d}.trace.parquet"
        if trace.is_file():
            picture = folder / f"{number:06d}.png"
            rules = {f.verdict.oracle for f in found.failures if f.evaluation == number}
            draw_trace(trace, settings, picture, rules=rules)
            pictures.append(picture)
    return tuple(pictures)
