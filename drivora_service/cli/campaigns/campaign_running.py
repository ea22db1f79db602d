"""Following a campaign, and exporting it at its end."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from drivora_service.cli.campaigns.campaign_display import Repeated, campaign_display
from drivora_service.cli.campaigns.campaign_output import campaign_content
from drivora_service.cli.campaigns.start_choosing import order_failures
from drivora_service.cli.terminal.out_option import write_result
from drivora_service.cli.terminal.private_files import give_to_user
from drivora_service.store.campaigns.campaign_records import Confirmation

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
    counter = RepeatedCounter(client)
    with campaign_display(budget) as display:
        return client.follow_campaign(
            campaign_id,
            on_progress=lambda campaign: display.show(campaign, counter.count(campaign)),
        )


class RepeatedCounter:
    """Counts the failing simulations of a campaign that were run again.

    The counts of a campaign's kinds do not add up to it: a simulation may have failures of several
    kinds. The failures are read only if these counts have changed.
    """

    def __init__(self, client: Client) -> None:
        """Creates a counter that asks a service."""
        self._client = client
        self._by_kind: tuple[tuple[int, int], ...] = ()
        self._counted = Repeated()

    def count(self, campaign: Campaign) -> Repeated:
        """Returns the numbers of a campaign as it is now."""
        by_kind = tuple((kind.confirmed, kind.flaky) for kind in campaign.kinds)
        if by_kind != self._by_kind:
            self._by_kind, self._counted = by_kind, self._read(campaign)
        return self._counted

    def _read(self, campaign: Campaign) -> Repeated:
        match campaign.kinds:
            case (only,):
                return Repeated(confirmed=only.confirmed, flaky=only.flaky)
            case kinds if not any(kind.confirmed or kind.flaky for kind in kinds):
                return Repeated()
        ends = {one.evaluation: one.confirmation for one in self._client.failures(campaign.id)}
        counts = Counter(ends.values())
        return Repeated(confirmed=counts[Confirmation.CONFIRMED], flaky=counts[Confirmation.FLAKY])


def pause_and_wait(client: Client, campaign_id: str) -> Campaign:
    """Pauses a campaign and waits until it is paused."""
    client.pause_campaign(campaign_id)
    return client.follow_campaign(campaign_id)


def export_campaign(client: Client, campaign: Campaign, target: Path) -> None:
    """Writes a campaign with its failing candidates, and scenario and trace of each."""
    failures = list(client.failures(campaign.id))
    failing = {failure.evaluation: failure for failure in failures}
    found = (client.evaluation(campaign.id, number) for number in order_failures(failures))
    content = {
        **campaign_content(campaign, failures),
        # From which another campaign can start.
        "candidates": [
            {"evaluation": one.number, "seed_number": one.seed_number, "values": one.values}
            for one in found
        ],
    }
    text = json.dumps(content, indent=2, ensure_ascii=False)
    write_result(target / "campaign.json", text + "\n")
    for failure in failing.values():
        name, number = f"{failure.evaluation:06d}", failure.evaluation
        write_result(target / f"{name}.json", client.evaluation_scenario(campaign.id, number))
        if failure.observations_url:
            trace = target / f"{name}.trace.parquet"
            client.save_evaluation_observations(trace, campaign.id, number)
            give_to_user(trace)
