"""Failures of all campaigns and batches."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Path, Request, Response

from drivora_service.api.answers.failure_filter import FoundFailures, check_oracle
from drivora_service.api.answers.query_parameters import Limit, PageToken
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.failures import FoundFailure, found_failure_of
from drivora_service.store.failures.found_counting import FoundCounts
from drivora_service.store.runs.run_records import Page

router = resource_router("failures", Depends(reader))


@router.get(
    "/failures",
    response_model=Page[FoundFailure],
    responses=answers(recorded_examples.FOUND_FAILURES, 401, 403, 404, 422),
)
def list_failures(
    request: Request,
    context: Context,
    wanted: FoundFailures,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists the failures of all campaigns and batches, the last found first."""
    with context.database.read() as transaction:
        check_oracle(context, transaction, wanted)
        page = transaction.found.page(wanted, limit=limit, page_token=page_token)
    items = tuple(found_failure_of(failure, context.base) for failure in page.items)
    body = Page(items=items, next_page_token=page.next_page_token)
    return json_answer(request, Page[FoundFailure], body)


@router.get(
    "/failures:counts",
    response_model=FoundCounts,
    responses=answers(recorded_examples.FOUND_COUNTS, 401, 403, 404, 422),
)
def count_failures(request: Request, context: Context, wanted: FoundFailures) -> Response:
    """Returns the numbers of the failures that pass a filter, and what they count."""
    with context.database.read() as transaction:
        check_oracle(context, transaction, wanted)
        counts = transaction.found.counts(wanted)
    return json_answer(request, FoundCounts, counts)


@router.get(
    "/failures/{number:int}",
    response_model=FoundFailure,
    responses=answers(recorded_examples.FOUND_FAILURE, 401, 403, 404, 422),
)
def get_failure(
    request: Request,
    context: Context,
    number: Annotated[int, Path(ge=1, le=2**31 - 1, description="Id of the failure.")],
) -> Response:
    """Returns a failure of a campaign or of a run."""
    with context.database.read() as transaction:
        failure = transaction.found.failure(number)
    return json_answer(request, FoundFailure, found_failure_of(failure, context.base))
