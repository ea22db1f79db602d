"""Workers: what they do, and what waits for them."""

from __future__ import annotations

from fastapi import Depends, Request, Response

from drivora_service.api.answers.worker_view import workers_now
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.workers import Workers

router = resource_router("workers", Depends(reader))


@router.get(
    "/workers", response_model=Workers, responses=answers(recorded_examples.WORKERS, 401, 403)
)
def get_workers(request: Request, context: Context) -> Response:
    """Returns what each worker does, how many runs wait and end, and what holds them up."""
    with context.database.read() as transaction:
        workers = workers_now(context, transaction)
    return json_answer(request, Workers, workers)
