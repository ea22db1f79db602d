"""Ids of what is stored, by names, by their first digits, or of the newest."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Query, Request, Response

from drivora_service.api.context import Context
from drivora_service.api.documentation import recorded_examples
from drivora_service.api.documentation.openapi import PLAIN_TEXT, id_answers
from drivora_service.api.guards.authorization import reader
from drivora_service.api.guards.entity_tags import JSON, bytes_answer, digest, json_answer
from drivora_service.api.guards.negotiation import accepted_form
from drivora_service.api.resource_router import resource_router
from drivora_service.store.id_records import FoundId, IdKind

router = resource_router("ids", Depends(reader))

_LONGEST = 400


@router.get(
    "/ids",
    response_model=FoundId,
    responses=id_answers(recorded_examples.FOUND_ID, 401, 403, 404, 406, 422),
)
def get_id(
    request: Request,
    context: Context,
    kind: Annotated[
        list[IdKind], Query(min_length=1, description="What is meant; may be repeated.")
    ],
    wanted: Annotated[
        str,
        Query(
            min_length=1,
            max_length=_LONGEST,
            description="`latest`, the newest of the kind; an id, or its first digits; a name. Of "
            "a run also `CAMPAIGN-EVALUATION`.",
        ),
    ],
) -> Response:
    """Returns the id of the one thing that a name or the beginning of an id means.

    The first that fits counts: an id, `latest`, a name, the beginning of an id. If several things
    have the name or ids that begin so, the answer is 404, and `detail` lists them. With
    `Accept: text/plain` the answer is the id alone.
    """
    from drivora_service.store.id_lookup import find_id

    form = accepted_form(request, (JSON, PLAIN_TEXT))
    with context.database.read() as transaction:
        found = find_id(transaction.session, tuple(dict.fromkeys(kind)), wanted)
    if form == JSON:
        return json_answer(request, FoundId, found)
    line = f"{found.id}\n".encode()
    return bytes_answer(request, line, media_type=PLAIN_TEXT, etag=digest(line))
