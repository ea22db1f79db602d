"""Suites that were run: what their gates decided, and how their scenarios went since."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.query_parameters import Configuration, Limit, PageToken
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.guards.idempotency_keys import Answer, IdempotencyKey, Work, run_once
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.suites import SuiteList, SuiteRunRequest
from drivora_service.shapes import to_json
from drivora_service.store.runs.run_records import Page
from drivora_service.store.suites.suite_records import SuiteHistory, SuiteRunRecord, SuiteRunSummary

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction

router = resource_router("suites")

_SuiteName = Annotated[str, Query(max_length=200, description="Of this suite.")]
_AgentName = Annotated[str, Query(max_length=200, description="Driven by this agent.")]


@router.get(
    "/suites",
    response_model=SuiteList,
    responses=answers(recorded_examples.SUITES, 401, 403),
    dependencies=[Depends(reader)],
)
def list_suites(request: Request, context: Context) -> Response:
    """Lists the suites that were run, the last run first."""
    with context.database.read() as transaction:
        suites = transaction.suite_runs.suites()
    return json_answer(request, SuiteList, SuiteList(items=suites))


@router.get(
    "/suites:history",
    response_model=SuiteHistory,
    responses=answers(recorded_examples.SUITE_HISTORY, 401, 403, 404, 422),
    dependencies=[Depends(reader)],
)
def suite_history(
    request: Request,
    context: Context,
    suite: Annotated[str, Query(min_length=1, max_length=200, description="Of this suite.")],
    agent: _AgentName = "",
    configuration: Configuration = "",
    runs: Annotated[int, Query(ge=1, le=200, description="Number of runs, the last ones.")] = 30,
) -> Response:
    """Returns the last runs of a suite, and what became of each scenario in them."""
    with context.database.read() as transaction:
        history = transaction.suite_runs.history(
            suite, agent=agent, configuration_id=configuration, limit=runs
        )
    return json_answer(request, SuiteHistory, history)


@router.post(
    "/suite-runs",
    status_code=201,
    response_model=SuiteRunRecord,
    responses=answers(recorded_examples.SUITE_RUN, 401, 403, 409, 413, 422, status=201),
    openapi_extra={
        "requestBody": {
            "content": {"application/json": {"example": recorded_examples.SUITE_RUN_REQUEST}}
        }
    },
    dependencies=[Depends(submitter)],
)
def post_suite_run(
    request: Request,
    context: Context,
    body: request_bodies.RawBody,
    given: SuiteRunRequest,
    idempotency_key: IdempotencyKey = "",
) -> Response:
    """Keeps what the gate of a suite decided; `drivora suite run` posts it.

    The service does not decide itself: it has the runs, but not the expectations of the suite.
    """

    def commit(transaction: Transaction) -> Answer:
        suite_run_id = transaction.suite_runs.add(given.decision, given.outcomes)
        record = transaction.suite_runs.get(suite_run_id)
        return Answer(
            status=201,
            headers={"Location": f"{context.base}/suite-runs/{suite_run_id}"},
            body=to_json(SuiteRunRecord, record).decode(),
        )

    return run_once(request, context, idempotency_key, body, lambda: Work(commit=commit))


@router.get(
    "/suite-runs",
    response_model=Page[SuiteRunSummary],
    responses=answers(recorded_examples.SUITE_RUNS, 401, 403, 422),
    dependencies=[Depends(reader)],
)
def list_suite_runs(
    request: Request,
    context: Context,
    suite: _SuiteName = "",
    agent: _AgentName = "",
    configuration: Configuration = "",
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists runs of suites, newest first."""
    with context.database.read() as transaction:
        page = transaction.suite_runs.page(
            suite=suite,
            agent=agent,
            configuration_id=configuration,
            limit=limit,
            page_token=page_token,
        )
    return json_answer(request, Page[SuiteRunSummary], page)


@router.get(
    "/suite-runs/{suite_run_id:id}",
    response_model=SuiteRunRecord,
    responses=answers(recorded_examples.SUITE_RUN, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def get_suite_run(request: Request, context: Context, suite_run_id: str) -> Response:
    """Returns a run of a suite, with what became of its scenarios."""
    with context.database.read() as transaction:
        record = transaction.suite_runs.get(suite_run_id)
    return json_answer(request, SuiteRunRecord, record)
