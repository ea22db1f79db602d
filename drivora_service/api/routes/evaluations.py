"""Evaluations of campaigns, their lineage, and the failures among them."""

from __future__ import annotations

import asyncio
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Path, Query, Request, Response

from drivora_service.api.answers.query_parameters import Frames, Limit, PageToken
from drivora_service.api.answers.recorded_frames import observations_answer
from drivora_service.api.answers.recorded_run import find_recorded_evaluation
from drivora_service.api.answers.run_pictures import Asked, Moments, picture_answer
from drivora_service.api.answers.table_answer import Columns, table_answer
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import (
    answers,
    observations_answers,
    picture_answers,
    scenario_answers,
    table_answers,
)
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import JSON, bytes_answer, digest, json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.campaigns import (
    Evaluation,
    Failure,
    evaluation_of,
    failure_of,
)
from drivora_service.campaigns.search.confirmation import trace_name
from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import (
    Confirmation,
    EvaluationFilter,
    EvaluationSummary,
    FailureFilter,
)
from drivora_service.store.campaigns.evaluation_runs import EvaluationId
from drivora_service.store.runs.run_records import Page
from drivora_service.studies.table_names import CampaignTableName

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction
    from drivora_service.studies.tables.table_forms import Table

router = resource_router("campaigns", Depends(reader))

_MOST_ANCESTORS = 500

Number = Annotated[int, Path(ge=0, le=10**9, description="Number of the evaluation, from 0.")]


class Order(StrEnum):
    """The order of evaluations."""

    OLDEST_FIRST = "number"
    NEWEST_FIRST = "-number"


@router.get(
    "/campaigns/{campaign_id:id}/evaluations",
    response_model=Page[EvaluationSummary],
    responses=answers(recorded_examples.EVALUATIONS, 401, 403, 404, 422),
)
def list_evaluations(
    request: Request,
    context: Context,
    campaign_id: str,
    status: Annotated[EvaluationStatus | None, Query(description="With this status.")] = None,
    violating: Annotated[bool | None, Query(description="With, or without, any failure.")] = None,
    generation: Annotated[
        int | None, Query(ge=0, le=10**9, description="Of this generation.")
    ] = None,
    order: Annotated[Order, Query(description="Order of the evaluations.")] = Order.OLDEST_FIRST,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists the evaluations of a campaign, in the order in which its tester was told."""
    wanted = EvaluationFilter(status=status, violating=violating, generation=generation)
    with context.database.read() as transaction:
        page = transaction.campaign_views.evaluations(
            campaign_id,
            wanted,
            newest_first=order is Order.NEWEST_FIRST,
            limit=limit,
            page_token=page_token,
        )
    return json_answer(request, Page[EvaluationSummary], page)


@router.get(
    "/campaigns/{campaign_id:id}/evaluations/{number}",
    response_model=Evaluation,
    responses=answers(recorded_examples.EVALUATION, 401, 403, 404),
)
def get_evaluation(
    request: Request, context: Context, campaign_id: str, number: Number
) -> Response:
    """Returns a candidate with its genes, lineage and result."""
    with context.database.read() as transaction:
        campaign = transaction.campaigns.get(campaign_id)
        record = transaction.evaluations.get(campaign_id, number)
        summary = transaction.campaign_views.evaluation(campaign_id, number)
        lineage = transaction.campaign_views.ancestors(campaign_id, number, most=_MOST_ANCESTORS)
        is_recorded = bool(
            transaction.campaign_views.run(EvaluationId(campaign_id, number)).trace_sha256
        )
        run_url = _run_url(transaction, record.report.run_id, context.base)
    trace = context.campaign_folder(campaign_id).trace(trace_name(number))
    detail = evaluation_of(
        summary,
        record,
        lineage,
        context.gene_spaces.of(campaign, record.seed_number),
        campaign,
        f"{context.base}/campaigns/{campaign_id}/evaluations/{number}",
        run_url=run_url,
        has_trace=is_recorded and trace.is_file(),
    )
    return json_answer(request, Evaluation, detail)


@router.get(
    "/campaigns/{campaign_id:id}/evaluations/{number}/scenario",
    response_class=Response,
    responses=scenario_answers(recorded_examples.EVALUATION_SCENARIO, 401, 403, 404),
)
def get_scenario(request: Request, context: Context, campaign_id: str, number: Number) -> Response:
    """Returns the scenario of a candidate as a document that can be posted."""
    with context.database.read() as transaction:
        text = transaction.evaluations.document(campaign_id, number)
    content = document_text(to_document(from_canonical(text))).encode()
    return bytes_answer(request, content, media_type=JSON, etag=digest(content))


@router.get(
    "/campaigns/{campaign_id:id}/evaluations/{number}/observations",
    response_class=Response,
    responses=observations_answers(
        recorded_examples.EVALUATION_FRAME, 401, 403, 404, 406, 409, 422
    ),
)
def get_observations(
    request: Request,
    context: Context,
    campaign_id: str,
    number: Number,
    part: Frames,
) -> Response:
    """Returns the recording of the second, identical run of a failing candidate."""
    run = find_recorded_evaluation(context, EvaluationId(campaign_id, number))
    return observations_answer(request, run.trace, part)


@router.get(
    "/campaigns/{campaign_id:id}/evaluations/{number}/picture",
    response_class=Response,
    responses=picture_answers(recorded_examples.PICTURE, 401, 403, 404, 409, 422, 503),
)
async def get_picture(
    request: Request,
    context: Context,
    campaign_id: str,
    number: Number,
    asked: Asked,
    moments: Moments = 5,
) -> Response:
    """Returns a strip of moments of the second, identical run of a failing candidate, as SVG."""
    evaluation = EvaluationId(campaign_id, number)
    run = await asyncio.to_thread(find_recorded_evaluation, context, evaluation)
    return await picture_answer(
        request,
        context,
        run.trace,
        town=run.record.town,
        verdicts=run.record.verdicts,
        moments=moments,
        asked=asked,
    )


@router.get(
    "/campaigns/{campaign_id:id}/failures",
    response_model=Page[Failure],
    responses=answers(recorded_examples.FAILURES, 401, 403, 404, 422),
)
def list_failures(
    request: Request,
    context: Context,
    campaign_id: str,
    kind: Annotated[str, Query(max_length=400, description="Of this kind.")] = "",
    oracle: Annotated[str, Query(max_length=60, description="Of this oracle.")] = "",
    at_fault: Annotated[bool | None, Query(description="By the fault of an ego, or not.")] = None,
    accountability: Annotated[
        Accountability | None, Query(description="For which an ego is accountable so far.")
    ] = None,
    confirmation: Annotated[
        Confirmation | None, Query(description="Whether it happened again.")
    ] = None,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists the failures that a campaign has found, in the order of their evaluations."""
    wanted = FailureFilter(
        kind=kind,
        oracle=oracle,
        at_fault=at_fault,
        accountability=accountability,
        confirmation=confirmation,
    )
    with context.database.read() as transaction:
        page = transaction.campaign_views.failures(
            campaign_id, wanted, limit=limit, page_token=page_token
        )
    url = f"{context.base}/campaigns/{campaign_id}"
    items = tuple(failure_of(failure, url) for failure in page.items)
    body = Page(items=items, next_page_token=page.next_page_token)
    return json_answer(request, Page[Failure], body)


@router.get(
    "/campaigns/{campaign_id:id}/tables/{table}",
    response_class=Response,
    responses=table_answers(recorded_examples.CAMPAIGN_TABLE, 401, 403, 404, 406, 422),
)
def get_table(
    request: Request,
    context: Context,
    campaign_id: str,
    table: CampaignTableName,
    columns: Columns = None,
    after: Annotated[
        int, Query(ge=-1, le=10**9, description="Only evaluations of greater numbers.")
    ] = -1,
) -> Response:
    """Returns evaluations or failures of a campaign as a table, in a form by `Accept`."""
    with context.database.read() as transaction:
        campaign = transaction.campaigns.get(campaign_id)

    def open_table() -> Table:
        from drivora_service.studies.tables.evaluation_tables import campaign_table

        return campaign_table(context.database, campaign_id, table, after=after)

    return table_answer(request, table, open_table, columns, owner=campaign.name)


def _run_url(transaction: Transaction, run_id: str, base: str) -> str:
    try:
        transaction.jobs.get(run_id)
    except UnknownName:
        return ""
    return f"{base}/runs/{run_id}"
