"""What is computed from the recording of a run, for its replay."""

from __future__ import annotations

from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Annotated

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers.arrow_answer import ARROW, arrow_answer
from drivora_service.api.answers.recorded_run import (
    ego_of,
    find_recorded_run,
    is_driven_by_sumo,
    scenario_of,
    view_of,
)
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, series_answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.compression import compressed_answer
from drivora_service.api.guards.entity_tags import JSON, digest
from drivora_service.api.guards.negotiation import accepted_form
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.perception import Perception
from drivora_service.api.schemas.series import Series
from drivora_service.api.schemas.timeline import Timeline

if TYPE_CHECKING:
    from drivora_service.observations.trace_files.table_stream import TableStream

router = resource_router("runs", Depends(reader))

EgoRow = Annotated[int, Query(ge=0, le=10**4, description="Row of the ego in the trace, from 0.")]


@router.get(
    "/runs/{run_id:id}/timeline",
    response_model=Timeline,
    responses=answers(recorded_examples.TIMELINE, 401, 403, 404, 409),
)
def get_timeline(request: Request, context: Context, run_id: str) -> Response:
    """Returns what happened when in a run: violations, signals, actors, lines of agents' logs."""
    run = find_recorded_run(context, run_id)

    def content() -> bytes:
        from drivora_service.api.answers.run_timeline import timeline_of

        return timeline_of(run.record, view_of(context, run)).model_dump_json().encode()

    etag = digest(f"timeline {_software()} {run.state}".encode())
    return compressed_answer(request, content, media_type=JSON, etag=etag)


@router.get(
    "/runs/{run_id:id}/series",
    response_model=Series,
    responses=series_answers(recorded_examples.SERIES, 401, 403, 404, 406, 409),
)
def get_series(request: Request, context: Context, run_id: str, ego: EgoRow = 0) -> Response:
    """Returns values of an ego by step, as oracles and metrics measure them; also as Arrow."""
    run = find_recorded_run(context, run_id)
    form = accepted_form(request, (JSON, ARROW))
    etag = digest(f"series {ego} {_software()} {run.state}".encode())
    if form == ARROW:

        def table() -> TableStream:
            from drivora_service.api.answers.run_series import series_table

            return series_table(run_id, ego_of(view_of(context, run), ego))

        return arrow_answer(request, table, etag=etag)

    def content() -> bytes:
        from drivora_service.api.answers.run_series import series_json

        return series_json(run_id, ego_of(view_of(context, run), ego))

    return compressed_answer(request, content, media_type=JSON, etag=etag)


@router.get(
    "/runs/{run_id:id}/perception",
    response_model=Perception,
    responses=series_answers(recorded_examples.PERCEPTION, 401, 403, 404, 406, 409),
)
def get_perception(request: Request, context: Context, run_id: str, ego: EgoRow = 0) -> Response:
    """Returns what an ego perceived: numbers by step, or with Arrow every actor by step."""
    run = find_recorded_run(context, run_id)
    form = accepted_form(request, (JSON, ARROW))
    etag = digest(f"perception {ego} {_software()} {run.state}".encode())
    if form == ARROW:

        def table() -> TableStream:
            from drivora_service.api.answers.run_perception import perception_table

            view = ego_of(view_of(context, run), ego)
            by_sumo = is_driven_by_sumo(context, run, view)
            return perception_table(
                run.record, scenario_of(context, run), view, is_sumo_driver=by_sumo
            )

        return arrow_answer(request, table, etag=etag)

    def content() -> bytes:
        from drivora_service.api.answers.run_perception import perception_json

        view = ego_of(view_of(context, run), ego)
        by_sumo = is_driven_by_sumo(context, run, view)
        return perception_json(run.record, scenario_of(context, run), view, is_sumo_driver=by_sumo)

    return compressed_answer(request, content, media_type=JSON, etag=etag)


@cache
def _software() -> str:
    """Returns the version of the code that computes the answers."""
    return version("drivora")
