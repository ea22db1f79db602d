"""Request bodies as bytes: scenario documents are parsed by the scenario room, not by FastAPI."""

from __future__ import annotations

from http import HTTPStatus
from typing import Annotated, Any, Literal

from fastapi import Depends, Request
from pydantic_core import from_json

from drivora_service.api.problem_details import ApiError
from drivora_service.errors import InvalidDocument, Problem

JSON_TYPES = frozenset({"application/json"})
NDJSON_TYPES = frozenset({"application/x-ndjson", "application/ndjson", "application/jsonl"})
YAML_TYPES = frozenset({"application/yaml", "application/x-yaml", "text/yaml"})
XML_TYPES = frozenset({"application/xml", "text/xml", "application/octet-stream"})


async def _read_body(request: Request) -> bytes:
    return await request.body()


RawBody = Annotated[bytes, Depends(_read_body)]
"""The body, read before the endpoint's thread starts."""


def media_type(request: Request, allowed: frozenset[str]) -> str:
    """Returns the body's media type.

    Raises:
        ApiError: It is not among those allowed (415).
    """
    given = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    coding = request.headers.get("content-encoding", "identity").lower()
    if given in allowed and coding == "identity":
        return given
    found = repr(given) if coding == "identity" else f"encoded as {coding[:80]!r}"
    raise ApiError(
        HTTPStatus.UNSUPPORTED_MEDIA_TYPE,
        f"the body must be plain {' or '.join(sorted(allowed))}, not {found}",
        headers={"Accept-Post": ", ".join(sorted(allowed))},
    )


def document_format(request: Request) -> Literal["json", "yaml"]:
    """Returns the language of a single document."""
    given = media_type(request, JSON_TYPES | YAML_TYPES)
    return "yaml" if given in YAML_TYPES else "json"


def split_batch(request: Request, body: bytes, *, most: int) -> list[bytes | dict[str, Any]]:
    """Returns the documents of a batch, unparsed if they came as lines.

    Raises:
        InvalidDocument: The body is no list, is empty, or holds more than ``most`` documents.
    """
    given = media_type(request, JSON_TYPES | NDJSON_TYPES)
    documents = _lines(body) if given in NDJSON_TYPES else _items(body)
    if not documents:
        raise _make_error("empty_batch", "the batch holds no scenario; at least one is needed")
    if len(documents) > most:
        raise _make_error(
            "batch_too_long", f"found {len(documents)} scenarios; at most {most} are allowed"
        )
    return documents


def _lines(body: bytes) -> list[bytes | dict[str, Any]]:
    return [line for line in body.splitlines() if line.strip()]


def _items(body: bytes) -> list[bytes | dict[str, Any]]:
    try:
        content = from_json(body)
    except ValueError as error:
        raise _make_error("malformed_json", f"the body is not JSON: {error}") from error
    if not isinstance(content, list):
        raise _make_error(
            "not_a_list", "a batch is a JSON list of scenarios, or one a line (NDJSON)"
        )
    return content


def _make_error(code: str, message: str) -> InvalidDocument:
    return InvalidDocument((Problem(pointer="", code=code, message=message),))
