"""Following a campaign, and exporting it at its end."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.cli.campaigns.campaign_display import campaign_display
from drivora_service.cli.campaigns.campaign_output import campaign_content
from drivora_service.cli.terminal.out_option import write_result
from drivora_service.cli.terminal.private_files import give_to_user

if TYPE_CHECKING:
    from drivora_service.api.schemas.campaigns import Campaign
    from drivora_service.client import Client


def follow(client: Client, campaign_id: str) -> Campaign:
    """Shows the progress of a campaign until it has ended or is paused.

    Raises:
        KeyboardInterrupt: The command was interrupted; the campaign continues.
        ServiceError: The service refused, did not answer, or cannot begin runs.
    """
    budget = client.campaign(campaign_id).budget
    with campaign_display(budget) as display:
        return client.follow_campaign(campaign_id, on_progress=display.show)


def pause_and_wait(client: Client, campaign_id: str) -> Campaign:
    """Pauses a campaign and waits until it is paused."""
    client.pause_campaign(campaign_id)
    return client.follow_campaign(campaign_id)


def export_campaign(client: Client, campaign: Campaign, target: Path) -> None:
    """Writes a campaign, and the scenario and trace of each failing evaluation."""
    failures = list(client.failures(campaign.id))
    text = json.dumps(campaign_content(campaign, failures), indent=2, ensure_ascii=False)
    write_result(target / "campaign.json", text + "\n")
    for failure in {failure.evaluation: failure for failure in failures}.values():
        name, number = f"{failure.evaluation:06d}", failure.evaluation
        write_result(target / f"{name}.json", client.evaluation_scenario(campaign.id, number))
        if failure.observations_url:
            trace = target / f"{name}.trace.parquet"
            client.save_evaluation_observations(trace, campaign.id, number)
            give_to_user(trace)
