"""Minimisations: start one for a failing run, follow and cancel it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from fastapi import Body, Depends, Query, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.query_parameters import Limit, PageToken
from drivora_service.api.answers.run_lookup import (
    find_definition,
    find_document,
    find_overrides,
    find_run,
)
from drivora_service.api.context import ApiContext, Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.guards.idempotency_keys import Answer, IdempotencyKey, Work, run_once
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.minimizations import (
    Minimization,
    MinimizationRequest,
    minimization_of,
)
from drivora_service.shapes import to_json
from drivora_service.store.minimizations.minimization_records import MinimizationSummary
from drivora_service.store.runs.run_records import Page
from drivora_service.suites.minimization.starting import new_minimization

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction
    from drivora_service.store.minimizations.minimization_records import NewMinimization

router = resource_router("minimizations")

_POLL_AFTER_S = "1"
_ENOUGH = 1 << 10
"""More runs at once than any machine has workers: a search needs as many as there are."""
_EXAMPLE = {"oracle": "collision", "budget": 200}


@router.post(
    "/runs/{run_id:id}:minimize",
    status_code=202,
    response_model=Minimization,
    responses=answers(
        recorded_examples.QUEUED_MINIMIZATION, 401, 403, 404, 409, 413, 422, status=202
    ),
    openapi_extra={"requestBody": {"content": {"application/json": {"example": _EXAMPLE}}}},
    dependencies=[Depends(submitter)],
)
def minimize_run(
    request: Request,
    context: Context,
    run_id: str,
    body: request_bodies.RawBody,
    given: Annotated[MinimizationRequest | None, Body()] = None,
    idempotency_key: IdempotencyKey = "",
) -> Response:
    """Searches the smallest scenario that fails as the run does; `Location` is its address."""
    wanted = given or MinimizationRequest()

    def prepare() -> Work:
        # Refused before workers get ready.
        with context.database.read() as transaction:
            _new(context, transaction, run_id, wanted, owner_id="")
        owner_id = context.reserve(_ENOUGH)

        def commit(transaction: Transaction) -> Answer:
            new = _new(context, transaction, run_id, wanted, owner_id=owner_id)
            minimization_id = transaction.minimizations.open(new)
            headers = {
                "Location": f"{context.base}/minimizations/{minimization_id}",
                "Retry-After": _POLL_AFTER_S,
            }
            body = to_json(Minimization, _minimization(context, transaction, minimization_id))
            return Answer(status=202, headers=headers, body=body.decode())

        return Work(commit=commit)

    response = run_once(request, context, idempotency_key, body, prepare)
    context.minimizations.wake()
    return response


@router.get(
    "/minimizations",
    response_model=Page[MinimizationSummary],
    responses=answers(recorded_examples.MINIMIZATIONS, 401, 403, 422),
    dependencies=[Depends(reader)],
)
def list_minimizations(
    request: Request,
    context: Context,
    run: Annotated[str, Query(max_length=40, description="Only those of this run.")] = "",
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists minimisations, newest first."""
    with context.database.read() as transaction:
        page = transaction.minimizations.page(run_id=run, limit=limit, page_token=page_token)
    return json_answer(request, Page[MinimizationSummary], page)


@router.get(
    "/minimizations/{minimization_id:id}",
    response_model=Minimization,
    responses=answers(recorded_examples.FINISHED_MINIMIZATION, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def get_minimization(request: Request, context: Context, minimization_id: str) -> Response:
    """Returns a minimisation with its progress and the smallest scenario so far."""
    with context.database.read() as transaction:
        minimization = _minimization(context, transaction, minimization_id)
    response = json_answer(request, Minimization, minimization)
    if minimization.state.is_active:
        response.headers["Retry-After"] = _POLL_AFTER_S
    return response


@router.post(
    "/minimizations/{minimization_id:id}:cancel",
    status_code=202,
    response_model=Minimization,
    responses=answers(recorded_examples.CANCELLED_MINIMIZATION, 401, 403, 404, status=202),
    dependencies=[Depends(submitter)],
)
def cancel_minimization(context: Context, minimization_id: str) -> Minimization:
    """Cancels a minimisation and its runs; the smallest scenario so far stays."""
    return _cancel(context, minimization_id)


def _cancel(context: ApiContext, minimization_id: str) -> Minimization:
    with context.database.write() as transaction:
        transaction.minimizations.cancel(minimization_id)
        minimization = _minimization(context, transaction, minimization_id)
    context.minimizations.wake()
    context.wake()
    return minimization


def _new(
    context: ApiContext,
    transaction: Transaction,
    run_id: str,
    wanted: MinimizationRequest,
    *,
    owner_id: str,
) -> NewMinimization:
    run = find_run(transaction, run_id)
    return new_minimization(
        run,
        find_document(transaction, run_id),
        overrides=find_overrides(transaction, run_id),
        definition=find_definition(transaction, run_id),
        oracle=wanted.oracle,
        radius_m=wanted.radius_m,
        budget=wanted.budget,
        owner_id=owner_id,
        oracles=context.oracles.names(),
        known_agents=context.agents.availability(),
    )


def _minimization(
    context: ApiContext, transaction: Transaction, minimization_id: str
) -> Minimization:
    return minimization_of(transaction.minimizations.get(minimization_id), context.base)
