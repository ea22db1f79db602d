"""Batches: post many scenarios at once, follow and cancel them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import TYPE_CHECKING, Annotated, Any

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.batch_scenarios import read_batch_scenario
from drivora_service.api.answers.query_parameters import (
    Limit,
    PageToken,
    PostedDefinition,
    RunOverrides,
)
from drivora_service.api.answers.submission import (
    Checker,
    Overrides,
    check_definition,
    check_overrides,
    new_run,
)
from drivora_service.api.context import ApiContext, Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, batch_body
from drivora_service.api.guards.authorization import reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.guards.idempotency_keys import Answer, IdempotencyKey, Work, run_once
from drivora_service.api.problem_details import problem_items
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.batches import (
    Batch,
    BatchItem,
    BatchSubmission,
    ItemResult,
    batch_of,
)
from drivora_service.errors import InvalidDocument, Problem
from drivora_service.given_names import CHECKED_NAME
from drivora_service.oracles.verdicts.failure_definition import (
    FailureDefinition,
    definition_to_json,
)
from drivora_service.shapes import to_json
from drivora_service.store.runs.run_records import NewRun, Page, Priority

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction

router = resource_router("batches")

_POLL_AFTER_S = "2"
MOST_REJECTED = 1000
"""Scenarios at the beginning of a batch that none of which can be run is enough to refuse it."""
MOST_PROBLEMS = 10_000
"""In all scenarios of a batch; with more it is refused."""


@router.post(
    "/batches",
    status_code=202,
    response_model=BatchSubmission,
    responses=answers(recorded_examples.SUBMISSION, 401, 403, 409, 413, 415, 422, 429, status=202),
    openapi_extra=batch_body(recorded_examples.SCENARIO),
    dependencies=[Depends(submitter)],
)
def post_batch(
    request: Request,
    context: Context,
    body: request_bodies.RawBody,
    overrides: RunOverrides,
    definition: PostedDefinition,
    name: Annotated[str, Query(max_length=200, description="Display name."), CHECKED_NAME] = "",
    priority: Annotated[Priority, Query(description="Priority of its runs.")] = Priority.CI,
    idempotency_key: IdempotencyKey = "",
) -> Response:
    """Queues a run of every scenario in the body, a JSON list or one scenario a line (NDJSON).

    A scenario may come with the label of its run, with its seed, and with what is a failure of it,
    as `{"label": "…", "seed": 7, "failures": {"counts": "any"}, "scenario": {…}}`.

    Scenarios that cannot be run are rejected one by one; only if all are, is the batch refused.

    A batch is refused as well, and the rest of it not looked at, if none of its first 1,000
    scenarios can be run, or once 10,000 problems are found.
    """

    def prepare() -> Work:
        check_overrides(context, overrides)
        check_definition(context, definition)
        documents = request_bodies.split_batch(request, body, most=context.limits.batch_items)
        checked = _check_documents(context, documents, overrides, definition)
        owner_id = context.reserve(len(checked.runs))

        def commit(transaction: Transaction) -> Answer:
            batch = transaction.batches.create(name=name, priority=priority, owner_id=owner_id)
            job_ids = transaction.jobs.submit(
                checked.runs, batch_id=batch.id, queue_limit=context.limits.queued_runs
            )
            answer = BatchSubmission(
                batch=batch_of(transaction.batches.get(batch.id), context.base),
                accepted=len(checked.runs),
                rejected=len(checked.problems),
                items=_item_results(checked, job_ids),
            )
            headers = {
                "Location": f"{context.base}/batches/{batch.id}",
                "Retry-After": _POLL_AFTER_S,
            }
            return Answer(
                status=202, headers=headers, body=to_json(BatchSubmission, answer).decode()
            )

        return Work(commit=commit)

    response = run_once(request, context, idempotency_key, body, prepare)
    context.wake()
    return response


@router.get(
    "/batches",
    response_model=Page[Batch],
    responses=answers(recorded_examples.BATCHES, 401, 403, 422),
    dependencies=[Depends(reader)],
)
def list_batches(
    request: Request,
    context: Context,
    priority: Annotated[
        list[Priority] | None, Query(description="With any of these priorities.")
    ] = None,
    limit: Limit = 50,
    page_token: PageToken = "",
) -> Response:
    """Lists batches, newest first."""
    with context.database.read() as transaction:
        page = transaction.batches.page(
            priorities=priority or (), limit=limit, page_token=page_token
        )
    items = tuple(batch_of(batch, context.base) for batch in page.items)
    return json_answer(
        request, Page[Batch], Page(items=items, next_page_token=page.next_page_token)
    )


@router.get(
    "/batches/{batch_id:id}",
    response_model=Batch,
    responses=answers(recorded_examples.BATCH, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def get_batch(request: Request, context: Context, batch_id: str) -> Response:
    """Returns a batch with its progress."""
    with context.database.read() as transaction:
        found = transaction.batches.get(batch_id)
        batch = batch_of(found, context.base, transaction.batches.definition(batch_id))
    response = json_answer(request, Batch, batch)
    if not batch.done:
        response.headers["Retry-After"] = _POLL_AFTER_S
    return response


@router.post(
    "/batches/{batch_id:id}:cancel",
    status_code=202,
    response_model=Batch,
    responses=answers(recorded_examples.CANCELLED_BATCH, 401, 403, 404, status=202),
    dependencies=[Depends(submitter)],
)
def cancel_batch(context: Context, batch_id: str) -> Batch:
    """Cancels all runs of a batch that have not ended."""
    with context.database.write() as transaction:
        batch = transaction.batches.cancel(batch_id)
    context.wake()
    return batch_of(batch, context.base)


@router.post(
    "/batches/{batch_id:id}:pause",
    status_code=202,
    response_model=Batch,
    responses=answers(recorded_examples.PAUSED_BATCH, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def pause_batch(context: Context, batch_id: str) -> Batch:
    """Pauses a batch: no further run is started, running ones continue."""
    with context.database.write() as transaction:
        return batch_of(transaction.batches.pause(batch_id), context.base)


@router.post(
    "/batches/{batch_id:id}:resume",
    status_code=202,
    response_model=Batch,
    responses=answers(recorded_examples.RESUMED_BATCH, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def resume_batch(context: Context, batch_id: str) -> Batch:
    """Resumes a paused batch."""
    with context.database.write() as transaction:
        batch = transaction.batches.resume(batch_id)
    context.wake()
    return batch_of(batch, context.base)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Checked:
    """The scenarios of a batch.

    Attributes:
        runs: Runs of the valid scenarios.
        notes: Remarks on those, by place in the batch.
        problems: Problems of the other scenarios, by place in the batch.
    """

    runs: list[NewRun] = field(default_factory=list)
    notes: dict[int, tuple[str, ...]] = field(default_factory=dict)
    problems: dict[int, tuple[Problem, ...]] = field(default_factory=dict)


def _check_documents(
    context: ApiContext,
    documents: Sequence[Any],
    overrides: Overrides,
    definition: FailureDefinition,
) -> _Checked:
    """Checks the documents of a batch.

    Raises:
        InvalidDocument: None can be run, or there are so many mistakes that the rest is not looked
            at.
    """
    checker = Checker(context, overrides)
    checked = _Checked()
    runs, rejected = checked.runs, checked.problems
    found = 0
    for item, document in enumerate(documents):
        try:
            scenario = read_batch_scenario(document)
            valid = scenario.check_document(checker.validate)
            own = definition if scenario.failures is None else scenario.failures
            check_definition(context, own, "/failures")
            options = replace(overrides.options, definition=definition_to_json(own))
            if scenario.seed is not None:
                options = replace(options, seed_override=scenario.seed)
            runs.append(new_run(valid, options, context.agents, item=item, label=scenario.label))
            checked.notes[item] = valid.notes
            continue
        except InvalidDocument as error:
            rejected[item] = error.problems
            found += len(error.problems)
        all_rejected = not runs and len(rejected) >= MOST_REJECTED
        if (all_rejected or found >= MOST_PROBLEMS) and item + 1 < len(documents):
            raise _all_rejected(rejected, unchecked=len(documents) - item - 1, found=found)
    if not runs:
        raise _all_rejected(rejected, found=found)
    return checked


def _all_rejected(
    rejected: Mapping[int, tuple[Problem, ...]], *, unchecked: int = 0, found: int
) -> InvalidDocument:
    """Refuses a batch with the first problems of its documents."""
    every = (
        replace(p, pointer=f"/{item}{p.pointer}")
        for item, problems in rejected.items()
        for p in problems
    )
    if not unchecked:
        return InvalidDocument(tuple(islice(every, MOST_PROBLEMS)))
    message = (
        f"{found} problems in {len(rejected)} scenarios; the last {unchecked} were not looked at. "
        "Correct these first: the batch is refused as a whole"
    )
    stopped = Problem(pointer="", code="batch_not_checked", message=message)
    return InvalidDocument((stopped, *islice(every, MOST_PROBLEMS)))


def _item_results(checked: _Checked, job_ids: Sequence[str]) -> tuple[BatchItem, ...]:
    accepted = [
        BatchItem(
            item=run.item, result=ItemResult.ACCEPTED, job_id=job_id, notes=checked.notes[run.item]
        )
        for run, job_id in zip(checked.runs, job_ids, strict=True)
    ]
    rejected = [
        BatchItem(item=item, result=ItemResult.REJECTED, problems=tuple(problem_items(problems)))
        for item, problems in checked.problems.items()
    ]
    return tuple(sorted((*accepted, *rejected), key=lambda one: one.item))
