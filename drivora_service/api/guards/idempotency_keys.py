"""``Idempotency-Key``: a repeated request is done once and gets the same answer."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING, Annotated

from fastapi import Header, Request, Response
from pydantic import BaseModel, ConfigDict

from drivora_service.api.context import ApiContext
from drivora_service.api.guards.authorization import client_name
from drivora_service.api.guards.entity_tags import JSON
from drivora_service.api.problem_details import ApiError

if TYPE_CHECKING:
    from drivora_service.store.database import Transaction

IdempotencyKey = Annotated[
    str,
    Header(
        alias="Idempotency-Key",
        max_length=200,
        description="Name of this request, chosen by the client; sent again with the same body, "
        "it is answered as the first time and nothing is done twice.",
    ),
]

_REPLAY_HEADER = "Idempotency-Replayed"


class Answer(BaseModel):
    """An answer as it is kept for repetitions."""

    model_config = ConfigDict(frozen=True)

    status: int
    headers: dict[str, str]
    body: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """A request that is ready to be done.

    Attributes:
        commit: Does it, within the transaction that also keeps the answer.
    """

    commit: Callable[[Transaction], Answer]


def run_once(
    request: Request,
    context: ApiContext,
    key: str,
    body: bytes,
    prepare: Callable[[], Work],
) -> Response:
    """Returns the answer of a request: that of its first time, if it was made before.

    Args:
        request: The request.
        context: With the database that keeps the keys.
        key: The client's name of the request, or "" for one that is not to be remembered.
        body: The request's body; another body under the same key is refused.
        prepare: Checks the request; nothing is kept if it raises.

    Raises:
        ApiError: The key was used with another body (422), or the first request is still being
            done (409).
    """
    if not key:
        work = prepare()
        with context.database.write() as transaction:
            answer = work.commit(transaction)
        return _response(answer)
    name = hashlib.sha256(
        "\0".join((client_name(request), request.method, request.url.path, key)).encode()
    ).hexdigest()
    fingerprint = hashlib.sha256(
        b"\0".join((request.url.query.encode(), _content_type(request), body))
    ).hexdigest()
    with context.database.write() as transaction:
        reservation = transaction.idempotency.reserve(name, fingerprint)
    if not reservation.fresh:
        return _replay(reservation.fingerprint == fingerprint, reservation.reference)
    try:
        work = prepare()
        with context.database.write() as transaction:
            answer = work.commit(transaction)
            transaction.idempotency.complete(name, answer.model_dump_json())
    except BaseException:
        with context.database.write() as transaction:
            transaction.idempotency.give_up(name)
        raise
    return _response(answer)


def _replay(same_body: bool, reference: str | None) -> Response:
    if not same_body:
        raise ApiError(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            "this Idempotency-Key was used with another request; choose a new one",
        )
    if reference is None:
        raise ApiError(
            HTTPStatus.CONFLICT,
            "the first request with this Idempotency-Key is still being done",
            headers={"Retry-After": "1"},
        )
    response = _response(Answer.model_validate_json(reference))
    response.headers[_REPLAY_HEADER] = "true"
    return response


def _response(answer: Answer) -> Response:
    return Response(answer.body, status_code=answer.status, headers=answer.headers, media_type=JSON)


def _content_type(request: Request) -> bytes:
    return request.headers.get("content-type", "").encode()
