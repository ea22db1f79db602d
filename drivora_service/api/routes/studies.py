"""Studies: post, follow, pause, resume and cancel them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from fastapi import Depends, Query, Request, Response

from drivora_service.api.answers import request_bodies
from drivora_service.api.answers.query_parameters import Limit, PageToken, Points
from drivora_service.api.answers.table_answer import Columns, table_answer
from drivora_service.api.context import ApiContext, Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import answers, study_body, table_answers
from drivora_service.api.guards.authorization import reader, submitter
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.guards.idempotency_keys import Answer, IdempotencyKey, Work, run_once
from drivora_service.api.resource_router import resource_router
from drivora_service.api.schemas.studies import (
    Study,
    StudyInList,
    StudyValidation,
    study_in_list,
    study_of,
)
from drivora_service.shapes import to_json
from drivora_service.store.campaigns.campaign_records import CampaignRequest
from drivora_service.store.runs.run_records import Page
from drivora_service.studies.comparison.campaign_measures import measure
from drivora_service.studies.comparison.discovery_curves import StudyBands, study_bands
from drivora_service.studies.comparison.study_comparison import StudyComparison, compare_study
from drivora_service.studies.study_storing import stop_study, store_study
from drivora_service.studies.table_names import TableName

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction
    from drivora_service.studies.study_reading import ValidStudy
    from drivora_service.studies.tables.table_forms import Table

router = resource_router("studies")

_POLL_AFTER_S = "2"

Names = Annotated[
    list[str] | None,
    Query(max_length=100, description="Only of this name in the study; may be repeated."),
]


@router.post(
    "/studies",
    status_code=202,
    response_model=Study,
    responses=answers(recorded_examples.QUEUED_STUDY, 401, 403, 409, 413, 415, 422, status=202),
    openapi_extra=study_body(recorded_examples.STUDY),
    dependencies=[Depends(submitter)],
)
def post_study(
    request: Request,
    context: Context,
    body: request_bodies.RawBody,
    idempotency_key: IdempotencyKey = "",
) -> Response:
    """Queues the campaigns of the study in the body; `Location` is its address."""
    form = request_bodies.document_format(request)

    def prepare() -> Work:
        valid = _read_document(context, body, form)

        def commit(transaction: Transaction) -> Answer:
            study_id = store_study(transaction, valid, context.studies)
            study = _study(context, transaction, study_id, valid.notes)
            headers = {
                "Location": f"{context.base}/studies/{study_id}",
                "Retry-After": _POLL_AFTER_S,
            }
            return Answer(status=202, headers=headers, body=to_json(Study, study).decode())

        return Work(commit=commit)

    response = run_once(request, context, idempotency_key, body, prepare)
    context.studies.wake()
    return response


@router.post(
    "/studies:validate",
    response_model=StudyValidation,
    responses=answers(recorded_examples.STUDY_VALIDATION, 401, 403, 413, 415, 422),
    openapi_extra=study_body(recorded_examples.STUDY),
    dependencies=[Depends(submitter)],
)
def validate_study(
    request: Request, context: Context, body: request_bodies.RawBody
) -> StudyValidation:
    """Checks a study as posting it would, and answers with the same problems."""
    valid = _read_document(context, body, request_bodies.document_format(request))
    document = valid.document
    return StudyValidation(
        valid=True,
        scenarios=len(document.scenarios),
        agents=len(document.agent_labels),
        methods=len(document.methods),
        repetitions=document.repetitions,
        campaigns=len(valid.campaigns),
        simulations=valid.simulations,
        genes=valid.genes,
        notes=valid.notes,
    )


@router.get(
    "/studies",
    response_model=Page[StudyInList],
    responses=answers(recorded_examples.STUDIES, 401, 403, 422),
    dependencies=[Depends(reader)],
)
def list_studies(
    request: Request, context: Context, limit: Limit = 50, page_token: PageToken = ""
) -> Response:
    """Lists studies, newest first."""
    with context.database.read() as transaction:
        page = transaction.studies.page(limit=limit, page_token=page_token)
    items = tuple(
        study_in_list(study, has_process=context.studies.has_process(study.id))
        for study in page.items
    )
    body = Page(items=items, next_page_token=page.next_page_token)
    return json_answer(request, Page[StudyInList], body)


@router.get(
    "/studies/{study_id:id}",
    response_model=Study,
    responses=answers(recorded_examples.FINISHED_STUDY, 401, 403, 404),
    dependencies=[Depends(reader)],
)
def get_study(request: Request, context: Context, study_id: str) -> Response:
    """Returns a study with the progress of its campaigns; `GET /campaigns?study=` lists them."""
    with context.database.read() as transaction:
        study = _study(context, transaction, study_id)
    response = json_answer(request, Study, study)
    if study.state.is_active:
        response.headers["Retry-After"] = _POLL_AFTER_S
    return response


@router.post(
    "/studies/{study_id:id}:pause",
    status_code=202,
    response_model=Study,
    responses=answers(recorded_examples.PAUSED_STUDY, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def pause_study(context: Context, study_id: str) -> Study:
    """Pauses the campaigns of a study, each after the evaluation that is being told."""
    return _request_stop(context, study_id, CampaignRequest.PAUSE)


@router.post(
    "/studies/{study_id:id}:cancel",
    status_code=202,
    response_model=Study,
    responses=answers(recorded_examples.CANCELLED_STUDY, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def cancel_study(context: Context, study_id: str) -> Study:
    """Cancels the campaigns of a study that are not over permanently; what was found stays."""
    return _request_stop(context, study_id, CampaignRequest.CANCEL)


@router.post(
    "/studies/{study_id:id}:resume",
    status_code=202,
    response_model=Study,
    responses=answers(recorded_examples.RESUMED_STUDY, 401, 403, 404, 409, status=202),
    dependencies=[Depends(submitter)],
)
def resume_study(context: Context, study_id: str) -> Study:
    """Resumes the campaigns of a study that are not over, as if they had not been interrupted."""
    context.studies.resume(study_id)
    return _read(context, study_id)


@router.get(
    "/studies/{study_id:id}/comparison",
    response_model=StudyComparison,
    responses=answers(recorded_examples.STUDY_COMPARISON, 401, 403, 404, 409, 422),
    dependencies=[Depends(reader)],
)
def get_comparison(
    request: Request,
    context: Context,
    study_id: str,
    baseline_method: Annotated[
        str, Query(max_length=200, description="Method of the study; `random`, or the first one.")
    ] = "",
    baseline_agent: Annotated[
        str, Query(max_length=200, description="Agent of the study; else the first one.")
    ] = "",
    by: Annotated[
        list[str] | None,
        Query(alias="measure", max_length=50, description="By what; may be repeated."),
    ] = None,
    equal_time: Annotated[
        bool,
        Query(description="Count what each had done after the time that the shortest one took."),
    ] = False,
) -> Response:
    """Compares the finished campaigns of a study by method and by agent, an overview first."""
    comparison = compare_study(
        context.database,
        study_id,
        context.catalogues,
        baseline_method=baseline_method,
        baseline_agent=baseline_agent,
        measures=tuple(measure(name) for name in dict.fromkeys(by or ())),
        equal_time=equal_time,
    )
    return json_answer(request, StudyComparison, comparison)


@router.get(
    "/studies/{study_id:id}/bands",
    response_model=StudyBands,
    responses=answers(recorded_examples.STUDY_BANDS, 401, 403, 404, 422),
    dependencies=[Depends(reader)],
)
def get_bands(
    request: Request,
    context: Context,
    study_id: str,
    method: Names = None,
    scenario: Names = None,
    agent: Names = None,
    points: Points = 300,
) -> Response:
    """Returns median and quartiles of failures against simulations, by scenario, agent, method."""
    bands = study_bands(
        context.database,
        study_id,
        methods=method or (),
        scenarios=scenario or (),
        agents=agent or (),
        points=points,
    )
    return json_answer(request, StudyBands, bands)


@router.get(
    "/studies/{study_id:id}/tables/{table}",
    response_class=Response,
    responses=table_answers(recorded_examples.STUDY_TABLE, 401, 403, 404, 406, 422),
    dependencies=[Depends(reader)],
)
def get_table(
    request: Request,
    context: Context,
    study_id: str,
    table: TableName,
    columns: Columns = None,
) -> Response:
    """Returns campaigns, evaluations or failures of a study as a table, in a form by `Accept`."""
    with context.database.read() as transaction:
        study = transaction.studies.get(study_id)

    def open_table() -> Table:
        from drivora_service.studies.tables.study_tables import study_table

        return study_table(context.database, study_id, table)

    return table_answer(request, table, open_table, columns, owner=study.name)


def _read_document(context: ApiContext, body: bytes, form: Literal["json", "yaml"]) -> ValidStudy:
    # Imported here: it needs the code of all agents, oracles and testers.
    from drivora_service.studies.study_reading import read_study

    return read_study(body, context.catalogues, form)


def _request_stop(context: ApiContext, study_id: str, request: CampaignRequest) -> Study:
    stop_study(context.database, study_id, request)
    context.studies.wake()
    context.wake()
    return _read(context, study_id)


def _read(context: ApiContext, study_id: str) -> Study:
    with context.database.read() as transaction:
        return _study(context, transaction, study_id)


def _study(
    context: ApiContext, transaction: Transaction, study_id: str, notes: tuple[str, ...] = ()
) -> Study:
    # Asked before the campaigns are read: a process lets go of a study after its last campaign.
    has_process = context.studies.has_process(study_id)
    record = transaction.studies.get(study_id)
    scenes = transaction.studies.scenes(study_id)
    missing = transaction.campaign_views.missing_results(study_id=study_id)
    return study_of(
        record, scenes, context.base, has_process=has_process, missing=missing, notes=notes
    )
