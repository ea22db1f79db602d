"""Answers with an ``ETag``, and 304 for clients that have them already."""

from __future__ import annotations

import hashlib
from typing import Any

from fastapi import Request, Response

from drivora_service.shapes import to_json

JSON = "application/json"


def json_answer(request: Request, kind: Any, body: object, *, etag: str = "") -> Response:
    """Answers with JSON, or with 304 if the client has it already.

    Args:
        request: The request.
        kind: Type of the answer, as which it is written.
        body: The answer.
        etag: Stands for the content; "": its hash.
    """
    content = to_json(kind, body)
    return bytes_answer(request, content, media_type=JSON, etag=etag or digest(content))


def bytes_answer(request: Request, content: bytes, *, media_type: str, etag: str) -> Response:
    """Answers with bytes, or with 304 if the client has it already."""
    headers = cache_headers(etag)
    if is_known(request, etag):
        return Response(status_code=304, headers=headers)
    return Response(content, media_type=media_type, headers=headers)


def is_known(request: Request, etag: str) -> bool:
    """Whether the request names ``etag`` as known."""
    known = request.headers.get("if-none-match", "")
    tags = {tag.strip().removeprefix("W/") for tag in known.split(",")}
    return f'"{etag}"' in tags or "*" in tags


def cache_headers(etag: str) -> dict[str, str]:
    """Returns the headers that let a client ask again cheaply."""
    return {
        "ETag": f'"{etag}"',
        "Cache-Control": "private, no-cache",
        "Vary": "Accept, Authorization, Cookie",
    }


def digest(content: bytes) -> str:
    """Returns a short hash of an answer."""
    return hashlib.sha256(content).hexdigest()[:32]
