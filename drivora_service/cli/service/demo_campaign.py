"""The campaign of the demo: several egos with the same ADS at an all-way stop."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from drivora_service.api.schemas.campaigns import Campaign, Failure
from drivora_service.cli.application.installation import settings_for
from drivora_service.cli.campaigns.campaign_files import read_campaign_file, shipped_campaigns
from drivora_service.cli.campaigns.campaign_output import print_campaign
from drivora_service.cli.campaigns.campaign_running import export_campaign, follow
from drivora_service.cli.terminal.output import note
from drivora_service.cli.terminal.trace_drawing import draw_trace
from drivora_service.client import Client

_EXAMPLE = "side-collision.yaml"


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoCampaign:
    """The results of the campaign.

    Attributes:
        file: The campaign, with its scenario in it.
        folder: With the scenario and the trace of each failure.
        pictures: Pictures of the first failure of each kind, beside its trace.
    """

    campaign: Campaign
    failures: tuple[Failure, ...]
    file: Path
    folder: Path
    pictures: tuple[Path, ...]


def run_demo_campaign(client: Client, data_dir: Path, *, simulations: int) -> DemoCampaign:
    """Has a service run the campaign, shows it meanwhile, and then what it has found.

    Args:
        client: Client of the service.
        data_dir: Folder of the demo.
        simulations: Budget of the campaign.

    Raises:
        ServiceError: The service refused or did not answer.
    """
    file = _write_campaign(data_dir, simulations)
    posted = client.post_campaign(file.read_bytes())
    note(f"the campaign in {file} searches for failures: {posted.name}")
    campaign = follow(client, posted.id)
    folder = data_dir / "failures"
    export_campaign(client, campaign, folder)
    print_campaign(campaign)
    failures = tuple(client.failures(campaign.id))
    return DemoCampaign(
        campaign=campaign,
        failures=failures,
        file=file,
        folder=folder,
        pictures=_draw(campaign, failures, folder, data_dir),
    )


def _write_campaign(data_dir: Path, simulations: int) -> Path:
    """Keeps the campaign as one file that `drivora campaign run` takes."""
    content = read_campaign_file(shipped_campaigns() / _EXAMPLE)
    content["budget"] = {"simulations": simulations}
    file = data_dir / "campaign.json"
    file.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    return file


def _draw(
    campaign: Campaign, failures: Sequence[Failure], folder: Path, data_dir: Path
) -> tuple[Path, ...]:
    settings = settings_for(data_dir)
    pictures = []
    numbers = sorted({kind.first for kind in campaign.kinds})
    note(f"drawing {len(numbers)} failures and a run")
    for number in numbers:
        trace = folder / f"{number:06d}.trace.parquet"
        if trace.is_file():
            picture = folder / f"{number:06d}.png"
            oracles = {f.verdict.oracle for f in failures if f.evaluation == number}
            draw_trace(trace, settings, picture, oracles=oracles)
            pictures.append(picture)
    return tuple(pictures)
