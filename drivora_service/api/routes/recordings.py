"""What is computed from the recording of a run, for its replay."""

from __future__ import annotations

from functools import cache
from importlib.metadata import version

from fastapi import Depends, Request, Response

from drivora_service.api import examples
from drivora_service.api.compression import compressed_answer
from drivora_service.api.conditional import JSON, digest
from drivora_service.api.context import Context
from drivora_service.api.documentation import answers
from drivora_service.api.recorded_run import recorded_run, view_of
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.timeline import Timeline
from drivora_service.api.security import reader

router = resource_router("runs", Depends(reader))


@router.get(
    "/runs/{run_id:id}/timeline",
    response_model=Timeline,
    responses=answers(examples.TIMELINE, 401, 403, 404, 409),
)
def get_timeline(request: Request, context: Context, run_id: str) -> Response:
    """Returns what happened when in a run: violations, signals, actors, lines of agents' logs."""
    run = recorded_run(context, run_id)

    def content() -> bytes:
        from drivora_service.api.run_timeline import timeline_of

        return timeline_of(run.record, view_of(context, run)).model_dump_json().encode()

    etag = digest(f"timeline {_software()} {run.state}".encode())
    return compressed_answer(request, content, media_type=JSON, etag=etag)


@cache
def _software() -> str:
    """Returns the version of the code that computes the answers."""
    return version("drivora")
