"""Failures of all campaigns and batches, and their groups."""

from __future__ import annotations

from typing import Annotated
from urllib.parse import urlencode

from fastapi import Depends, Path, Query, Request, Response
from pydantic import AwareDatetime

from drivora_service.api import examples
from drivora_service.api.conditional import json_answer
from drivora_service.api.context import Context
from drivora_service.api.documentation import answers
from drivora_service.api.parameters import Limit, PageToken
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.failures import (
    FailureGroup,
    FoundFailure,
    failure_group_of,
    found_failure_of,
)
from drivora_service.api.security import reader
from drivora_service.api_paths import PREFIX
from drivora_service.oracles.accountability import Accountability
from drivora_service.store.campaign_records import Confirmation
from drivora_service.store.found_records import FoundFilter
from drivora_service.store.records import Page

router = resource_router("failures", Depends(reader))


async def _found_filter(
    oracle: Annotated[str, Query(max_length=60, description="Of this oracle.")] = "",
    group: Annotated[str, Query(max_length=400, description="Of this group.")] = "",
    at_fault: Annotated[bool | None, Query(description="By the fault of an ego, or not.")] = None,
    accountability: Annotated[
        Accountability | None,
        Query(description="For which an ego is accountable so far; `avoidable`: its fault."),
    ] = None,
    agent: Annotated[str, Query(max_length=200, description="Of this agent.")] = "",
    town: Annotated[str, Query(max_length=100, description="On this network.")] = "",
    campaign: Annotated[str, Query(max_length=40, description="Found by this campaign.")] = "",
    batch: Annotated[
        str, Query(max_length=40, description="Of runs of this batch, outside campaigns.")
    ] = "",
    confirmation: Annotated[
        Confirmation | None, Query(description="Whether it happened again, in a campaign.")
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
        town=town,
        campaign_id=campaign,
        batch_id=batch,
        confirmation=confirmation,
        since=since,
        until=until,
    )


Wanted = Annotated[FoundFilter, Depends(_found_filter)]


@router.get(
    "/failures",
    response_model=Page[FoundFailure],
    responses=answers(examples.FOUND_FAILURES, 401, 403, 422),
)
def list_failures(
    request: Request,
    context: Context,
    wanted: Wanted,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists the failures of all campaigns and batches, the last found first."""
    with context.database.read() as transaction:
        page = transaction.found.page(wanted, limit=limit, page_token=page_token)
    items = tuple(found_failure_of(failure, PREFIX) for failure in page.items)
    body = Page(items=items, next_page_token=page.next_page_token)
    return json_answer(request, Page[FoundFailure], body)


@router.get(
    "/failures/groups",
    response_model=Page[FailureGroup],
    responses=answers(examples.FAILURE_GROUPS, 401, 403, 422),
)
def list_groups(
    request: Request,
    context: Context,
    wanted: Wanted,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists the groups of the failures that pass the filters, the last seen first."""
    with context.database.read() as transaction:
        page = transaction.found.groups(wanted, limit=limit, page_token=page_token)
    # The filters of the request stay: the counts are those of its failures.
    kept = [
        (name, value)
        for name, value in request.query_params.multi_items()
        if name not in ("limit", "page_token", "group")
    ]
    items = tuple(
        failure_group_of(
            group, PREFIX, f"{PREFIX}/failures?{urlencode([*kept, ('group', group.group)])}"
        )
        for group in page.items
    )
    body = Page(items=items, next_page_token=page.next_page_token)
    return json_answer(request, Page[FailureGroup], body)


@router.get(
    "/failures/{number}",
    response_model=FoundFailure,
    responses=answers(examples.FOUND_FAILURE, 401, 403, 404, 422),
)
def get_failure(
    request: Request,
    context: Context,
    number: Annotated[int, Path(ge=1, le=2**31 - 1, description="Id of the failure.")],
) -> Response:
    """Returns a failure of a campaign or of a run."""
    with context.database.read() as transaction:
        failure = transaction.found.failure(number)
    return json_answer(request, FoundFailure, found_failure_of(failure, PREFIX))
