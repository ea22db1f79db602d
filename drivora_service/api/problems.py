"""Errors as problem details (RFC 9457): one shape for all errors."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any

import structlog
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException

from drivora_service.api.methods import MethodTable
from drivora_service.errors import (
    CampaignError,
    Conflict,
    DrivoraError,
    InvalidDocument,
    NetworkError,
    Problem,
    QueueFull,
    StoreUnavailable,
    UnknownName,
)

MEDIA_TYPE = "application/problem+json"
_MAX_PROBLEMS = 200
_UNAVAILABLE_S = "5"

_log = structlog.stdlib.get_logger(__name__)


class ProblemItem(BaseModel):
    """One problem and its place."""

    pointer: str = Field(description="JSON pointer (RFC 6901) into the body; empty: all of it.")
    code: str = Field(description="Short stable name of the kind of problem.")
    message: str = Field(description="What was found, what is allowed, what to do.")


class ProblemDetails(BaseModel):
    """An error, as RFC 9457 has it, with every single problem named."""

    model_config = ConfigDict(extra="forbid")

    type: str = Field(default="about:blank", description="Kind of error.")
    title: str = Field(description="Short text for the kind of error.")
    status: int = Field(description="HTTP status code.")
    detail: str = Field(default="", description="This occurrence of the error.")
    instance: str = Field(default="", description="Path of the request.")
    problems: list[ProblemItem] = Field(default_factory=list, description="Every problem found.")


class ApiError(Exception):
    """An answer that is an error, decided on by the HTTP layer itself."""

    def __init__(
        self,
        status: HTTPStatus,
        detail: str,
        *,
        problems: tuple[Problem, ...] = (),
        headers: dict[str, str] | None = None,
    ) -> None:
        self.status, self.detail, self.problems = status, detail, problems
        self.headers = headers or {}
        super().__init__(detail)


def problem_items(problems: tuple[Problem, ...]) -> list[ProblemItem]:
    """Returns problems in the shape of the answer; too many problems are cut short."""
    return [
        ProblemItem(pointer=p.pointer, code=p.code, message=p.message)
        for p in problems[:_MAX_PROBLEMS]
    ]


def problem_response(
    status: HTTPStatus,
    detail: str,
    *,
    instance: str = "",
    problems: tuple[Problem, ...] = (),
    headers: dict[str, str] | None = None,
) -> Response:
    """Builds the answer to a request that could not be served."""
    body = ProblemDetails(
        title=status.phrase,
        status=status.value,
        detail=detail,
        instance=instance,
        problems=problem_items(problems),
    )
    return JSONResponse(
        body.model_dump(), status_code=status.value, headers=headers, media_type=MEDIA_TYPE
    )


def json_pointer(location: tuple[int | str, ...]) -> str:
    """Writes the place of a value as a JSON pointer."""
    return "".join(f"/{str(part).replace('~', '~0').replace('/', '~1')}" for part in location)


def install_problem_handlers(api: FastAPI, methods: MethodTable) -> None:
    """Turns every exception that can leave an endpoint into problem details."""

    def http_answer(request: Request, error: Exception) -> Response:
        return _http_answer(request, error, methods)

    for kind in (ApiError, DrivoraError, RequestValidationError, Exception):
        api.add_exception_handler(kind, _answer)
    api.add_exception_handler(HTTPException, http_answer)


def _answer(request: Request, error: Exception) -> Response:
    path = request.url.path
    match error:
        case ApiError():
            return problem_response(
                error.status,
                error.detail,
                instance=path,
                problems=error.problems,
                headers=error.headers,
            )
        case InvalidDocument(problems=problems):
            detail = f"{len(problems)} problem{'s' if len(problems) != 1 else ''} in the document"
            return problem_response(
                HTTPStatus.UNPROCESSABLE_ENTITY, detail, instance=path, problems=problems
            )
        case UnknownName():
            return problem_response(HTTPStatus.NOT_FOUND, str(error), instance=path)
        case Conflict():
            return problem_response(HTTPStatus.CONFLICT, str(error), instance=path)
        case QueueFull():
            headers = {"Retry-After": str(error.retry_after_s)}
            return problem_response(
                HTTPStatus.TOO_MANY_REQUESTS, str(error), instance=path, headers=headers
            )
        case StoreUnavailable():
            headers = {"Retry-After": _UNAVAILABLE_S}
            return problem_response(
                HTTPStatus.SERVICE_UNAVAILABLE, str(error), instance=path, headers=headers
            )
        case NetworkError() | CampaignError():
            return problem_response(HTTPStatus.UNPROCESSABLE_ENTITY, str(error), instance=path)
        case RequestValidationError():
            problems = tuple(_parameter_problem(item) for item in error.errors())
            return problem_response(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                "the request cannot be used",
                instance=path,
                problems=problems,
            )
        case _:
            _log.error("request_failed", path=path, exc_info=error)
            return problem_response(
                HTTPStatus.INTERNAL_SERVER_ERROR,
                "the service failed to answer; its log says why",
                instance=path,
            )


def _parameter_problem(item: dict[str, Any]) -> Problem:
    where, *rest = item["loc"]
    if where == "body":
        return Problem(pointer=json_pointer(tuple(rest)), code=item["type"], message=item["msg"])
    name = ".".join(str(part) for part in rest)
    message = f"{where} parameter {name!r}: {item['msg']} (found {str(item['input'])[:100]!r})"
    return Problem(pointer="", code=item["type"], message=message)


def _http_answer(request: Request, error: Exception, methods: MethodTable) -> Response:
    if not isinstance(error, HTTPException):
        raise error
    status = HTTPStatus(error.status_code)
    headers = dict(error.headers or {})
    if status is HTTPStatus.NOT_FOUND and error.detail == status.phrase:
        detail = "there is nothing at this path; /docs shows what there is"
    elif status is HTTPStatus.METHOD_NOT_ALLOWED:
        headers["Allow"] = ", ".join(methods.allowed(request.url.path))
        detail = f"{request.method} is not allowed here; allowed: {headers['Allow']}"
    else:
        detail = str(error.detail)
    return problem_response(status, detail, instance=request.url.path, headers=headers)
