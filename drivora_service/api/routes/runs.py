"""Runs: verdicts, recordings and scenarios."""

from __future__ import annotations

import asyncio
from enum import StrEnum
from typing import Annotated

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers.query_parameters import Filter, Frames, Limit, PageToken
from drivora_service.api.answers.recorded_frames import observations_answer
from drivora_service.api.answers.recorded_run import find_recorded_run
from drivora_service.api.answers.run_lookup import find_document, find_overrides, find_run
from drivora_service.api.answers.run_pictures import Asked, Moments, picture_answer
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import (
    answers,
    observations_answers,
    picture_answers,
    scenario_answers,
)
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import JSON, bytes_answer, digest, json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.runs import Run, run_of
from drivora_service.scenario.canonical import from_canonical
from drivora_service.scenario.documents import document_text
from drivora_service.scenario.exporting import to_document
from drivora_service.scenario.overrides import with_overrides
from drivora_service.store.runs.run_counts import RunCounts
from drivora_service.store.runs.run_records import Page, RunSummary

router = resource_router("runs", Depends(reader))


class RunOrder(StrEnum):
    """The order of runs, by the time of their submission."""

    NEWEST_FIRST = "-created_at"
    OLDEST_FIRST = "created_at"


@router.get(
    "/runs",
    response_model=Page[RunSummary],
    responses=answers(recorded_examples.RUNS, 401, 403, 422),
)
def list_runs(
    request: Request,
    context: Context,
    wanted: Filter,
    order: Annotated[RunOrder, Query(description="Order of the runs.")] = RunOrder.NEWEST_FIRST,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists runs in the order of their submission, newest first unless said otherwise."""
    with context.database.read() as transaction:
        page = transaction.jobs.page(
            wanted,
            limit=limit,
            page_token=page_token,
            newest_first=order is RunOrder.NEWEST_FIRST,
        )
    return json_answer(request, Page[RunSummary], page)


@router.get(
    "/runs:counts",
    response_model=RunCounts,
    responses=answers(recorded_examples.RUN_COUNTS, 401, 403, 422),
)
def count_runs(request: Request, context: Context, wanted: Filter) -> Response:
    """Counts the runs that pass a filter, and those with each other value of its parts."""
    with context.database.read() as transaction:
        counts = transaction.jobs.counts_by_filter(wanted)
    return json_answer(request, RunCounts, counts)


@router.get(
    "/runs/{run_id:id}", response_model=Run, responses=answers(recorded_examples.RUN, 401, 403, 404)
)
def get_run(request: Request, context: Context, run_id: str) -> Response:
    """Returns a run with its results."""
    with context.database.read() as transaction:
        run = find_run(transaction, run_id)
    return json_answer(request, Run, run_of(run, context.base))


@router.get(
    "/runs/{run_id:id}/scenario",
    response_class=Response,
    responses=scenario_answers(recorded_examples.RUN_SCENARIO, 401, 403, 404),
)
def get_scenario(request: Request, context: Context, run_id: str) -> Response:
    """Returns what a run has driven, as a document that can be posted again."""
    with context.database.read() as transaction:
        text = find_document(transaction, run_id)
        agent, seed = find_overrides(transaction, run_id)
    driven = with_overrides(from_canonical(text), agent=agent, seed=seed)
    content = document_text(to_document(driven)).encode()
    return bytes_answer(request, content, media_type=JSON, etag=digest(content))


@router.get(
    "/runs/{run_id:id}/observations",
    response_class=Response,
    responses=observations_answers(recorded_examples.FRAME, 401, 403, 404, 406, 409, 422),
)
def get_observations(
    request: Request,
    context: Context,
    run_id: str,
    part: Frames,
) -> Response:
    """Returns the recording of a run: frames in the published shape, Parquet or Arrow."""
    run = find_recorded_run(context, run_id)
    return observations_answer(request, run.trace, part)


@router.get(
    "/runs/{run_id:id}/picture",
    response_class=Response,
    responses=picture_answers(recorded_examples.PICTURE, 401, 403, 404, 409, 422, 503),
)
async def get_picture(
    request: Request, context: Context, run_id: str, asked: Asked, moments: Moments = 5
) -> Response:
    """Returns a strip of moments of a run: those that lead to a violation, as SVG."""
    run = await asyncio.to_thread(find_recorded_run, context, run_id)
    return await picture_answer(
        request,
        context,
        run.trace,
        town=run.record.town,
        verdicts=run.record.verdicts,
        moments=moments,
        asked=asked,
    )
