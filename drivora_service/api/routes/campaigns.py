"""Campaigns: post, follow, pause, resume and cancel them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.query_parameters import Limit, PageToken
from drivora_service.api.context import ApiContext, Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, campaign_body
from drivora_service.api.guards.authorization import reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.guards.idempotency_keys import Answer, IdempotencyKey, Work, run_once
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.campaigns import (
    Campaign,
    CampaignValidation,
    SpacePresetList,
    campaign_of,
    space_presets,
)
from drivora_service.campaigns.hosts.campaign_requests import ask_for
from drivora_service.errors import Conflict
from drivora_service.shapes import to_json
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    CampaignSummary,
)
from drivora_service.store.locks.work_locks import LongWork
from drivora_service.store.runs.run_records import Page

if TYPE_CHECKING:
    from drivora_service.campaigns.document.campaign_reading import ValidCampaign
    from drivora_service.campaigns.search.engine import Search
    from drivora_service.store.database import Transaction

router = resource_router("campaigns")

_POLL_AFTER_S = "2"

C = TypeVar("C", bound=CampaignSummary)

_STORED_AS = {CampaignState.INTERRUPTED: CampaignState.RUNNING}


@router.post(
    "/campaigns",
    status_code=202,
    response_model=Campaign,
    responses=answers(recorded_examples.QUEUED_CAMPAIGN, 401, 403, 409, 413, 415, 422, status=202),
    openapi_extra=campaign_body(recorded_examples.CAMPAIGN),
    dependencies=[Depends(submitter)],
)
def post_campaign(
    request: Request,
    context: Context,
    body: request_bodies.RawBody,
    idempotency_key: IdempotencyKey = "",
) -> Response:
    """Queues the campaign in the body; `Location` is its address."""
    form = request_bodies.document_format(request)

    def prepare() -> Work:
        valid, _ = _prepare_campaign(context, body, form)

        def commit(transaction: Transaction) -> Answer:
            from drivora_service.campaigns.records.stored_campaigns import new_campaign

            campaign_id = transaction.campaigns.create(new_campaign(valid)).id
            context.campaigns.open(transaction, campaign_id)
            campaign = _campaign(context, transaction, campaign_id, valid)
            headers = {
                "Location": f"{context.base}/campaigns/{campaign_id}",
                "Retry-After": _POLL_AFTER_S,
            }
            return Answer(status=202, headers=headers, body=to_json(Campaign, campaign).decode())

        return Work(commit=commit)

    response = run_once(request, context, idempotency_key, body, prepare)
    context.campaigns.wake()
    return response


@router.post(
    "/campaigns:validate",
    response_model=CampaignValidation,
    responses=answers(recorded_examples.CAMPAIGN_VALIDATION, 401, 403, 413, 415, 422),
    openapi_extra=campaign_body(recorded_examples.CAMPAIGN),
    dependencies=[Depends(submitter)],
)
def validate_campaign(
    request: Request, context: Context, body: request_bodies.RawBody
) -> CampaignValidation:
    """Checks a campaign as posting it would, and answers with the same problems."""
    form = request_bodies.document_format(request)
    valid, search = _prepare_campaign(context, body, form)
    return CampaignValidation(
        valid=True,
        tester=valid.campaign.tester.name,
        town=valid.town,
        seeds=len(valid.seeds),
        genes=search.genes,
        notes=valid.notes_for(valid.campaign.workers),
    )


@router.get(
    "/campaigns:presets",
    response_model=SpacePresetList,
    responses=answers(recorded_examples.SPACE_PRESETS, 401, 403),
    dependencies=[Depends(reader)],
)
def list_presets(request: Request) -> Response:
    """Lists the named spaces that a campaign or a study can have."""
    return json_answer(request, SpacePresetList, space_presets())


@router.get(
    "/campaigns",
    response_model=Page[CampaignSummary],
    responses=answers(recorded_examples.CAMPAIGNS, 401, 403, 422),
    dependencies=[Depends(reader)],
)
def list_campaigns(
    request: Request,
    context: Context,
    state: Annotated[
        list[CampaignState] | None, Query(description="In any of these states.")
    ] = None,
    study: Annotated[str, Query(max_length=40, description="Of this study.")] = "",
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists campaigns, newest first."""
    wanted = frozenset(state or ())
    stored = frozenset(_STORED_AS.get(one, one) for one in wanted)
    with context.database.read() as transaction:
        page = transaction.campaigns.page(
            states=stored, study_id=study, limit=limit, page_token=page_token
        )
    seen = (_as_seen(context, campaign) for campaign in page.items)
    items = tuple(campaign for campaign in seen if not wanted or campaign.state in wanted)
    body = Page(items=items, next_page_token=page.next_page_token)
    return json_answer(request, Page[CampaignSummary], body)


@router.get(
    "/campaigns/{campaign_id:id}",
    response_model=Campaign,
    responses=answers(recorded_examples.FINISHED_CAMPAIGN, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def get_campaign(request: Request, context: Context, campaign_id: str) -> Response:
    """Returns a campaign with its progress and findings."""
    with context.database.read() as transaction:
        campaign = _campaign(context, transaction, campaign_id)
    response = json_answer(request, Campaign, campaign)
    if campaign.state in (CampaignState.QUEUED, CampaignState.RUNNING):
        response.headers["Retry-After"] = _POLL_AFTER_S
    return response


@router.post(
    "/campaigns/{campaign_id:id}:pause",
    status_code=202,
    response_model=Campaign,
    responses=answers(recorded_examples.PAUSED_CAMPAIGN, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def pause_campaign(context: Context, campaign_id: str) -> Campaign:
    """Pauses a campaign after the evaluation that is being told; it can be resumed."""
    return _request_stop(context, campaign_id, CampaignRequest.PAUSE)


@router.post(
    "/campaigns/{campaign_id:id}:cancel",
    status_code=202,
    response_model=Campaign,
    responses=answers(recorded_examples.CANCELLED_CAMPAIGN, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def cancel_campaign(context: Context, campaign_id: str) -> Campaign:
    """Cancels a campaign permanently; what it has found stays."""
    return _request_stop(context, campaign_id, CampaignRequest.CANCEL)


@router.post(
    "/campaigns/{campaign_id:id}:resume",
    status_code=202,
    response_model=Campaign,
    responses=answers(recorded_examples.RESUMED_CAMPAIGN, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def resume_campaign(context: Context, campaign_id: str) -> Campaign:
    """Resumes a campaign that was paused or has failed, as if it had not been interrupted."""
    context.campaigns.resume(campaign_id)
    with context.database.read() as transaction:
        return _campaign(context, transaction, campaign_id)


def _prepare_campaign(
    context: ApiContext, body: bytes, form: Literal["json", "yaml"]
) -> tuple[ValidCampaign, Search]:
    """Reads a campaign, and makes what the space and the tester may refuse."""
    # Imported here: they need the code of all agents, oracles and testers.
    from drivora_service.campaigns.document.campaign_reading import read_campaign
    from drivora_service.campaigns.search.search_preparation import prepare_search

    valid = read_campaign(body, context.catalogues, form)
    return valid, prepare_search(valid, context.catalogues, run_prefix="")


def _request_stop(context: ApiContext, campaign_id: str, request: CampaignRequest) -> Campaign:
    with context.database.read() as transaction:
        record = transaction.campaigns.get(campaign_id)
    if record.state is CampaignState.FINISHED:
        raise Conflict(f"campaign {campaign_id} is finished")
    ask_for(context.database, campaign_id, request)
    context.campaigns.wake()
    context.wake()
    with context.database.read() as transaction:
        return _campaign(context, transaction, campaign_id)


def _campaign(
    context: ApiContext,
    transaction: Transaction,
    campaign_id: str,
    valid: ValidCampaign | None = None,
) -> Campaign:
    record = transaction.campaigns.get(campaign_id)
    if not _is_deserted(context, record):
        return _make_campaign(context.base, transaction, record, valid)
    # Its command may have ended since this transaction began: what is stored then is final.
    with context.database.read() as later:
        record = later.campaigns.get(campaign_id)
        return _make_campaign(context.base, later, _mark_interrupted(record), valid)


def _make_campaign(
    base: str, transaction: Transaction, record: CampaignRecord, valid: ValidCampaign | None
) -> Campaign:
    kinds = transaction.campaign_views.kinds(record.id)
    notes = () if valid is None else valid.notes_for(valid.campaign.workers)
    seeds = transaction.campaign_views.seeds(record.id)
    missing = transaction.campaign_views.missing_results(campaign_id=record.id)
    return campaign_of(record, kinds, seeds, base, missing=missing, notes=notes)


def _as_seen(context: ApiContext, campaign: CampaignSummary) -> CampaignSummary:
    """Returns a campaign of a list, ``interrupted`` if its command was killed."""
    if not _is_deserted(context, campaign):
        return campaign
    with context.database.read() as later:
        record = later.campaigns.get(campaign.id)
    return _mark_interrupted(replace(campaign, state=record.state))


def _is_deserted(context: ApiContext, campaign: CampaignSummary) -> bool:
    """Returns whether a campaign is stored as running, and no command runs it."""
    return (
        campaign.state is CampaignState.RUNNING
        and not campaign.batch_id
        and not context.database.locks.is_held(LongWork.campaign(campaign.id))
    )


def _mark_interrupted(campaign: C) -> C:
    if campaign.state is not CampaignState.RUNNING:
        return campaign
    return replace(campaign, state=CampaignState.INTERRUPTED)
