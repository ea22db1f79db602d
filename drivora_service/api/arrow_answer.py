"""Answers that are Arrow streams, compressed as the client accepts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from http import HTTPStatus
from typing import TYPE_CHECKING

from fastapi import Request, Response
from fastapi.responses import StreamingResponse

from drivora_service.api.compression import coded_headers, compressed
from drivora_service.api.conditional import is_known
from drivora_service.api.problems import ApiError

if TYPE_CHECKING:
    from drivora_service.observations.table_stream import TableStream

ARROW = "application/vnd.apache.arrow.stream"


def accepted_form(request: Request, forms: Sequence[str]) -> str:
    """Returns the media type that the client names, or the first one if it accepts any.

    Raises:
        ApiError: It accepts none of them (406).
    """
    accept = request.headers.get("accept", "*/*")
    kinds = {part.partition(";")[0].strip().lower() for part in accept.split(",")}
    for form in forms:
        if form in kinds:
            return form
    if kinds & {"*/*", "application/*"}:
        return forms[0]
    detail = f"the answer comes as {' or '.join(forms)}, not {accept!r}"
    raise ApiError(HTTPStatus.NOT_ACCEPTABLE, detail)


def arrow_answer(request: Request, opened: Callable[[], TableStream], *, etag: str) -> Response:
    """Answers with an Arrow IPC stream, or with 304 if the client has it already.

    Args:
        request: The request.
        opened: Opens the table; called only if it is sent.
        etag: Stands for the content of the table.
    """
    coding, headers = coded_headers(request, f"{etag}-arrow")
    if is_known(request, headers["ETag"].strip('"')):
        return Response(status_code=304, headers=headers)
    from drivora_service.observations.table_stream import stream_bytes

    parts = stream_bytes(opened())
    if coding:
        headers["Content-Encoding"] = coding
        parts = compressed(parts, coding)
    return StreamingResponse(parts, media_type=ARROW, headers=headers)
