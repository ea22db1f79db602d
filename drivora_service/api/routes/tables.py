"""Runs, verdicts, metrics and agents of batches, campaigns and studies as tables."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from fastapi import Depends, Request, Response

from drivora_service.api.answers.query_parameters import Results
from drivora_service.api.answers.table_answer import Columns, table_answer
from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import table_answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.resource_router import resource_router
from drivora_service.studies.campaign_lookup import campaign_ids
from drivora_service.studies.table_names import ResultTableName

if TYPE_CHECKING:
    from drivora_service.studies.tables.table_forms import Table

router = resource_router("tables", Depends(reader))


@router.get(
    "/tables/{table}",
    response_class=Response,
    responses=table_answers(recorded_examples.RESULT_TABLE, 401, 403, 404, 406, 422),
)
def get_table(
    request: Request,
    context: Context,
    table: ResultTableName,
    wanted: Results,
    columns: Columns = None,
) -> Response:
    """Returns runs, their verdicts, metrics or agents as a table, in a form by `Accept`.

    Runs are those of any of the batches, campaigns and studies, or all, that pass the filters;
    evaluations of campaigns count whose runs are not stored.
    """

    def open_table() -> Table:
        from drivora_service.studies.tables.result_tables import result_table

        ids = campaign_ids(context.database, wanted.campaign_ids)
        return result_table(context.database, table, replace(wanted, campaign_ids=ids))

    owner = ""
    if len(wanted.batch_ids) == 1 and not wanted.campaign_ids and not wanted.study_ids:
        with context.database.read() as transaction:
            owner = transaction.batches.get(wanted.batch_ids[0]).name
    return table_answer(request, table, open_table, columns, owner=owner)
