"""The filter of the commands that list failures and their groups."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivora_service.cli.terminal.options import parse_choice, parse_counts

if TYPE_CHECKING:
    from drivora_service.client import Client
    from drivora_service.store.failures.failure_records import FoundFilter


def make_filter(
    group: str,
    oracle: str,
    agent: str,
    configuration: str,
    town: str,
    accountability: str,
    campaign: str,
    study: str,
    batch: str,
    counts: str | None,
) -> FoundFilter:
    """Returns the filter that options ask for."""
    from drivora_service.oracles.verdicts.accountability import Accountability
    from drivora_service.store.failures.failure_records import FoundFilter

    return FoundFilter(
        group=group,
        oracle=oracle,
        agent=agent,
        configuration_id=configuration,
        town=town,
        accountability=(
            parse_choice(Accountability, accountability, "--accountability")
            if accountability
            else None
        ),
        campaign_id=campaign,
        study_id=study,
        batch_id=batch,
        counts=parse_counts(counts),
    )


def check_owners(client: Client, wanted: FoundFilter) -> None:
    """Checks that the batch, campaign and study of a filter exist.

    Raises:
        UnknownName: One of them does not.
    """
    if wanted.batch_id:
        client.batch(wanted.batch_id)
    if wanted.campaign_id:
        client.campaign(wanted.campaign_id)
    if wanted.study_id:
        client.study(wanted.study_id)
