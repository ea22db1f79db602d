"""Liveness, readiness and metrics of the service.

The first two are answered in the event loop from what is known, without a thread and without the
database, so that they come at once however many clients read and whatever the storage does.
"""

from __future__ import annotations

from functools import lru_cache
from importlib.metadata import version

from fastapi import APIRouter, Depends, Request, Response

from drivora_service.api.answers.service_metrics import CONTENT_TYPE, metrics_text
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, problem_answer
from drivora_service.api.guards.authorization import reader
from drivora_service.api.schemas.service import Check, Health, Readiness

router = APIRouter(tags=["service"])


@router.get("/healthz", response_model=Health, responses=answers(recorded_examples.HEALTH))
async def healthz() -> Health:
    """Answers as long as the process lives."""
    return Health(status="ok", version=_version())


@router.get(
    "/readyz",
    response_model=Readiness,
    responses={
        **answers(recorded_examples.READINESS),
        503: {
            **answers(recorded_examples.NOT_READY)[200],
            "model": Readiness,
            "description": "Not ready",
        },
    },
)
async def readyz(context: Context, response: Response) -> Readiness:
    """Answers 200 if runs and campaigns can be queued and started, else 503 with the reasons."""
    checks = tuple(
        Check(name=name, ok=not fault, detail=fault) for name, fault in context.faults().items()
    )
    ready = all(check.ok for check in checks)
    response.status_code = 200 if ready else 503
    return Readiness(ready=ready, checks=checks)


@router.get(
    "/metrics",
    response_class=Response,
    responses={
        200: {
            "description": "Prometheus text",
            "content": {
                "text/plain": {"schema": {"type": "string"}, "example": recorded_examples.METRICS}
            },
        },
        401: problem_answer(401),
        403: problem_answer(403),
    },
    dependencies=[Depends(reader)],
)
def metrics(context: Context, request: Request) -> Response:
    """Returns counts of runs, the queue, the workers and requests for Prometheus."""
    state = request.app.state
    text = metrics_text(context, state.request_times, state.client_counts)
    return Response(text, media_type=CONTENT_TYPE)


@lru_cache(maxsize=1)
def _version() -> str:
    return version("drivora")
