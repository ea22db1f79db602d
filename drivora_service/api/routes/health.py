"""Whether the service lives, can take work, and how it does."""

from __future__ import annotations

from importlib.metadata import version

from fastapi import APIRouter, Depends, Response

from drivora_service.api import examples
from drivora_service.api.context import Context
from drivora_service.api.documentation import answers, problem_answer
from drivora_service.api.schemas.service import Check, Health, Readiness
from drivora_service.api.security import reader
from drivora_service.api.service_metrics import CONTENT_TYPE, metrics_text
from drivora_service.errors import StoreError

router = APIRouter(tags=["service"])


@router.get("/healthz", response_model=Health, responses=answers(examples.HEALTH))
def healthz() -> Health:
    """Answers as long as the process lives."""
    return Health(status="ok", version=version("drivora"))


@router.get(
    "/readyz",
    response_model=Readiness,
    responses={
        **answers(examples.READINESS),
        503: {**answers(examples.NOT_READY)[200], "model": Readiness, "description": "Not ready"},
    },
)
def readyz(context: Context, response: Response) -> Readiness:
    """Answers 200 if runs can be taken and begun and campaigns started, else 503 and why."""
    checks = (_database(context), _workers(context), _campaigns(context))
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
                "text/plain": {"schema": {"type": "string"}, "example": examples.METRICS_TEXT}
            },
        },
        401: problem_answer(401),
        403: problem_answer(403),
    },
    dependencies=[Depends(reader)],
)
def metrics(context: Context) -> Response:
    """Gives counts of runs, the queue and the workers for Prometheus."""
    return Response(metrics_text(context), media_type=CONTENT_TYPE)


def _database(context: Context) -> Check:
    try:
        with context.database.read() as transaction:
            transaction.jobs.queued()
    except StoreError as error:
        return Check(name="database", ok=False, detail=str(error))
    return Check(name="database", ok=True, detail="")


def _workers(context: Context) -> Check:
    fault = context.worker_fault()
    return Check(name="workers", ok=not fault, detail=fault)


def _campaigns(context: Context) -> Check:
    alive = context.campaigns_alive()
    return Check(name="campaigns", ok=alive, detail="" if alive else "no campaign is started")
