"""The filter of the commands that list failures and their groups."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivora_service.cli.application.references import id_of
from drivora_service.cli.terminal.options import parse_choice, parse_counts
from drivora_service.store.id_records import IdKind

if TYPE_CHECKING:
    from drivora_service.client import Client
    from drivora_service.store.failures.failure_records import FoundFilter


def make_filter(
    client: Client,
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
    """Returns the filter that options ask for.

    Raises:
        NotFound: A group, configuration, campaign, study or batch is not stored.
    """
    from drivora_service.oracles.verdicts.accountability import Accountability
    from drivora_service.store.failures.failure_records import FoundFilter

    return FoundFilter(
        group=id_of(client, group, IdKind.FAILURE_GROUP),
        oracle=oracle,
        agent=agent,
        configuration_id=id_of(client, configuration, IdKind.CONFIGURATION),
        town=town,
        accountability=(
            parse_choice(Accountability, accountability, "--accountability")
            if accountability
            else None
        ),
        campaign_id=id_of(client, campaign, IdKind.CAMPAIGN),
        study_id=id_of(client, study, IdKind.STUDY),
        batch_id=id_of(client, batch, IdKind.BATCH),
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
