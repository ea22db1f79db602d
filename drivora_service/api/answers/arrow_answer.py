"""Answers that are Arrow streams, compressed as the client accepts."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fastapi import Request, Response
from fastapi.responses import StreamingResponse

from drivora_service.api.guards.compression import compress_stream, negotiate_coding
from drivora_service.api.guards.entity_tags import is_known

if TYPE_CHECKING:
    from drivora_service.observations.trace_files.table_stream import TableStream

ARROW = "application/vnd.apache.arrow.stream"


def arrow_answer(request: Request, opened: Callable[[], TableStream], *, etag: str) -> Response:
    """Answers with an Arrow IPC stream, or with 304 if the client has it already.

    Args:
        request: The request.
        opened: Opens the table; called only if it is sent.
        etag: Stands for the content of the table.
    """
    coding, headers = negotiate_coding(request, f"{etag}-arrow")
    if is_known(request, headers["ETag"].strip('"')):
        return Response(status_code=304, headers=headers)
    from drivora_service.observations.trace_files.table_stream import stream_bytes

    parts = stream_bytes(opened())
    if coding:
        headers["Content-Encoding"] = coding
        parts = compress_stream(parts, coding)
    return StreamingResponse(parts, media_type=ARROW, headers=headers)
