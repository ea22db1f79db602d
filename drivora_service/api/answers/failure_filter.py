"""Query parameters that filter failures of all campaigns and batches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Query
from pydantic import AwareDatetime

from drivora_service.api.answers.query_parameters import Configuration
from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import Counted
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.failures.failure_records import FoundFilter

if TYPE_CHECKING:
    from drivora_service.api.context import ApiContext
    from drivora_service.store.database import Transaction


async def _found_filter(
    oracle: Annotated[str, Query(max_length=60, description="Of this oracle.")] = "",
    group: Annotated[str, Query(max_length=40, description="Of the group of this id.")] = "",
    at_fault: Annotated[bool | None, Query(description="By the fault of an ego, or not.")] = None,
    accountability: Annotated[
        Accountability | None,
        Query(description="For which an ego is accountable so far; `avoidable`: its fault."),
    ] = None,
    agent: Annotated[str, Query(max_length=200, description="Of this agent.")] = "",
    configuration: Configuration = "",
    town: Annotated[str, Query(max_length=100, description="On this network.")] = "",
    campaign: Annotated[str, Query(max_length=40, description="Found by this campaign.")] = "",
    study: Annotated[
        str, Query(max_length=40, description="Found by a campaign of this study.")
    ] = "",
    batch: Annotated[
        str, Query(max_length=40, description="Of runs of this batch, outside campaigns.")
    ] = "",
    confirmation: Annotated[
        Confirmation | None, Query(description="Whether it happened again, in a campaign.")
    ] = None,
    counts: Annotated[
        Counted | None,
        Query(
            description="The violations that are failures; without it, and without "
            "`accountability` and `at_fault`, those that were defined as such for their run or "
            "campaign. A campaign keeps only what it counts."
        ),
    ] = None,
    since: Annotated[
        AwareDatetime | None, Query(description="Found at this time or later.")
    ] = None,
    until: Annotated[AwareDatetime | None, Query(description="Found before this time.")] = None,
) -> FoundFilter:
    return FoundFilter(
        oracle=oracle,
        group=group,
        at_fault=at_fault,
        accountability=accountability,
        agent=agent,
        configuration_id=configuration,
        town=town,
        campaign_id=campaign,
        study_id=study,
        batch_id=batch,
        confirmation=confirmation,
        counts=counts,
        since=since,
        until=until,
    )


def check_oracle(context: ApiContext, transaction: Transaction, wanted: FoundFilter) -> None:
    """Checks the oracle of a filter.

    Raises:
        UnknownName: There is none of this name, and there is no failure of one that was removed.
    """
    if not wanted.oracle:
        return
    known = context.oracles.names()
    if wanted.oracle not in known and not transaction.found.has_oracle(wanted.oracle):
        raise UnknownName("oracle", wanted.oracle, tuple(known))


FoundFailures = Annotated[FoundFilter, Depends(_found_filter)]
