"""Answers that are tables, in the form that the client accepts."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

from fastapi import Query, Request, Response
from fastapi.responses import StreamingResponse

from drivora_service.api.guards.entity_tags import JSON
from drivora_service.api.guards.negotiation import accepted_form
from drivora_service.studies.table_names import TableForm

if TYPE_CHECKING:
    from drivora_service.studies.tables.table_forms import Table

Columns = Annotated[
    list[str] | None,
    Query(alias="column", max_length=100, description="Only these; may be repeated."),
]

_SUFFIXES = {
    TableForm.PARQUET: "parquet",
    TableForm.ARROW: "arrow",
    TableForm.JSON: "json",
    TableForm.CSV: "csv",
}

_FORMS = (TableForm.CSV, TableForm.PARQUET, TableForm.ARROW, TableForm.JSON)


def _file_name(owner: str, table: str) -> str:
    """Returns a name in characters that every file system and a header allow."""
    plain = re.sub(r"[^A-Za-z0-9_.-]+", "-", owner).strip("-.")[:80]
    return f"{plain}-{table}" if plain else table


def table_answer(
    request: Request,
    name: str,
    opened: Callable[[], Table],
    columns: list[str] | None,
    *,
    owner: str = "",
) -> Response:
    """Answers with a table.

    Args:
        request: The request.
        name: Name of the table.
        opened: Opens the table.
        columns: Columns that the client wants; none: all.
        owner: Name of what its rows belong to, for the name of the file; "" for all.

    Raises:
        ApiError: The client accepts none of the forms (406).
        UnknownName: There is no such column.
        InvalidDocument: There are too many rows for JSON.
    """
    from drivora_service.studies.tables.table_forms import select_columns, table_chunks

    form = TableForm(accepted_form(request, _FORMS))
    table = select_columns(opened(), columns or ())
    headers = {
        "Content-Disposition": f'attachment; filename="{_file_name(owner, name)}'
        f'.{_SUFFIXES[form]}"',
        "Cache-Control": "private, no-cache",
        "Vary": "Accept, Authorization",
    }
    if form is TableForm.JSON:
        # In memory as a whole, so that it can still be refused.
        content = b"".join(table_chunks(table, form))
        return Response(content, media_type=JSON, headers=headers)
    return StreamingResponse(table_chunks(table, form), media_type=form, headers=headers)
