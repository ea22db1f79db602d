"""Jobs: post one scenario, follow and cancel it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from fastapi import Depends, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.query_parameters import (
    Filter,
    Label,
    Limit,
    PageToken,
    PostedDefinition,
    RunOverrides,
)
from drivora_service.api.answers.submission import (
    Checker,
    check_definition,
    check_overrides,
    new_run,
)
from drivora_service.api.context import ApiContext, Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, scenario_body
from drivora_service.api.guards.authorization import reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.guards.idempotency_keys import Answer, IdempotencyKey, Work, run_once
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.jobs import Job, job_of
from drivora_service.oracles.verdicts.failure_definition import definition_to_json
from drivora_service.shapes import to_json
from drivora_service.store.runs.run_records import Page, RunSummary

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction

router = resource_router("jobs")

_POLL_AFTER_S = "1"


@router.post(
    "/jobs",
    status_code=202,
    response_model=Job,
    responses=answers(recorded_examples.QUEUED_JOB, 401, 403, 409, 413, 415, 422, 429, status=202),
    openapi_extra=scenario_body(recorded_examples.SCENARIO),
    dependencies=[Depends(submitter)],
)
def post_job(
    request: Request,
    context: Context,
    body: request_bodies.RawBody,
    overrides: RunOverrides,
    definition: PostedDefinition,
    label: Label = "",
    idempotency_key: IdempotencyKey = "",
) -> Response:
    """Queues a run of the scenario in the body; `Location` is its job."""
    form = request_bodies.document_format(request)

    def prepare() -> Work:
        check_overrides(context, overrides)
        check_definition(context, definition)
        options = replace(overrides.options, definition=definition_to_json(definition))
        valid = Checker(context, overrides).validate(body, form)
        run = new_run(valid, options, context.agents, item=0, label=label)
        owner_id = context.reserve(1)

        def commit(transaction: Transaction) -> Answer:
            limit = context.limits.queued_runs
            (job_id,) = transaction.jobs.submit([run], owner_id=owner_id, queue_limit=limit)
            job = _job(context, transaction, job_id)
            headers = {"Location": f"{context.base}/jobs/{job_id}", "Retry-After": _POLL_AFTER_S}
            return Answer(status=202, headers=headers, body=to_json(Job, job).decode())

        return Work(commit=commit)

    response = run_once(request, context, idempotency_key, body, prepare)
    context.wake()
    return response


@router.get(
    "/jobs",
    response_model=Page[RunSummary],
    responses=answers(recorded_examples.JOBS, 401, 403, 422),
    dependencies=[Depends(reader)],
)
def list_jobs(
    request: Request,
    context: Context,
    wanted: Filter,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists jobs, newest first."""
    with context.database.read() as transaction:
        page = transaction.jobs.page(wanted, limit=limit, page_token=page_token)
    return json_answer(request, Page[RunSummary], page)


@router.get(
    "/jobs/{job_id:id}",
    response_model=Job,
    responses=answers(recorded_examples.JOB, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def get_job(request: Request, context: Context, job_id: str) -> Response:
    """Returns a job. A run that failed is a job with an `error`."""
    with context.database.read() as transaction:
        job = _job(context, transaction, job_id)
    response = json_answer(request, Job, job)
    if not job.status.is_final:
        response.headers["Retry-After"] = _POLL_AFTER_S
    return response


@router.post(
    "/jobs/{job_id:id}:cancel",
    status_code=202,
    response_model=Job,
    responses=answers(recorded_examples.CANCELLED_JOB, 401, 403, 404, status=202),
    dependencies=[Depends(submitter)],
)
def cancel_job(context: Context, job_id: str) -> Job:
    """Cancels a job: a queued one at once, a running one as soon as its worker has stopped it."""
    return _cancel(context, job_id)


def _cancel(context: ApiContext, job_id: str) -> Job:
    with context.database.write() as transaction:
        transaction.jobs.cancel(job_id)
        job = _job(context, transaction, job_id)
    context.wake()
    return job


def _job(context: ApiContext, transaction: Transaction, job_id: str) -> Job:
    return job_of(transaction.jobs.detail(job_id), context.base)
