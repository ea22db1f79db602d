"""Errors as problem details (RFC 9457): one shape for all errors."""

from __future__ import annotations

from collections import Counter
from http import HTTPStatus
from typing import Any

import structlog
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from drivora_service.api.context import context_of
from drivora_service.api.guards.method_table import MethodTable
from drivora_service.api.guards.path_prefix import public_path
from drivora_service.api.schemas.problems import ProblemItem
from drivora_service.errors import (
    AmbiguousName,
    CampaignError,
    Conflict,
    CredentialsUnusable,
    DrivoraError,
    InvalidDocument,
    NetworkError,
    NetworkTaken,
    NothingStored,
    Problem,
    QueueFull,
    StoreError,
    StoreUnavailable,
    TraceDamaged,
    UnknownName,
    count_problems,
)
from drivora_service.fault_log import FaultLog

MEDIA_TYPE = "application/problem+json"
_MAX_PROBLEMS = 200
_UNAVAILABLE_S = "5"
_CLIENT_LEFT = 499
"""Status that proxies use in their logs, and here only the figures of requests."""

_log = structlog.stdlib.get_logger(__name__)


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
    """Returns problems in the shape of the answer; too many problems are cut short.

    Each document of a batch keeps its first problems, and at least one.
    """
    documents = Counter(_place_in_batch(problem) for problem in problems)
    most = max(1, _MAX_PROBLEMS // max(1, len(documents)))
    taken: Counter[str] = Counter()
    items = []
    for problem in problems:
        place = _place_in_batch(problem)
        taken[place] += 1
        if taken[place] <= most:
            items.append(
                ProblemItem(pointer=problem.pointer, code=problem.code, message=problem.message)
            )
    return items


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
        body.model_dump(),
        status_code=status.value,
        # Also here: the answer to an unexpected error, or to an overload, passes no middleware.
        headers={"X-Content-Type-Options": "nosniff", "Cache-Control": "no-store"}
        | (headers or {}),
        media_type=MEDIA_TYPE,
    )


def json_pointer(location: tuple[int | str, ...]) -> str:
    """Writes the place of a value as a JSON pointer."""
    return "".join(f"/{str(part).replace('~', '~0').replace('/', '~1')}" for part in location)


def install_problem_handlers(api: FastAPI, methods: MethodTable) -> None:
    """Turns every exception that can leave an endpoint into problem details."""
    faults = FaultLog(structlog.get_logger(__name__))

    def answer(request: Request, error: Exception) -> Response:
        if isinstance(error, CredentialsUnusable):
            # Every request meets it.
            faults.error("credentials_unusable", problem=str(error))
        return _answer(request, error)

    def http_answer(request: Request, error: Exception) -> Response:
        return _http_answer(request, error, methods)

    for kind in (ApiError, ClientDisconnect, DrivoraError, RequestValidationError, Exception):
        api.add_exception_handler(kind, answer)
    api.add_exception_handler(HTTPException, http_answer)


def _answer(request: Request, error: Exception) -> Response:
    path = public_path(request.scope)
    match error:
        case ApiError():
            return problem_response(
                error.status,
                error.detail,
                instance=path,
                problems=error.problems,
                headers=error.headers,
            )
        case ClientDisconnect():
            # Counted by its connection; there is no client any more to answer.
            _log.debug("client_left", path=path)
            return Response(status_code=_CLIENT_LEFT)
        case InvalidDocument(problems=problems):
            count = count_problems(problems)
            detail = f"{count} problem{'s' if count != 1 else ''} in the document"
            return problem_response(
                HTTPStatus.UNPROCESSABLE_ENTITY, detail, instance=path, problems=problems
            )
        case UnknownName() | AmbiguousName() | NothingStored():
            return problem_response(HTTPStatus.NOT_FOUND, str(error), instance=path)
        case Conflict():
            return problem_response(HTTPStatus.CONFLICT, str(error), instance=path)
        case TraceDamaged():
            if context_of(request).is_service:
                # A fault of the storage, not of the request: the log names the file's folder, too.
                _log.error("trace_damaged", path=path, file=error.file, problem=error.code)
            is_missing = error.code == "trace_missing"
            return problem_response(
                HTTPStatus.NOT_FOUND if is_missing else HTTPStatus.CONFLICT,
                str(error),
                instance=path,
                problems=(Problem(pointer="", code=error.code, message=str(error)),),
            )
        case NetworkTaken():
            code = "network_shipped" if error.is_shipped else "network_imported"
            problem = Problem(pointer="", code=code, message=str(error))
            return problem_response(
                HTTPStatus.CONFLICT, str(error), instance=path, problems=(problem,)
            )
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
        case CredentialsUnusable():
            return problem_response(
                HTTPStatus.SERVICE_UNAVAILABLE,
                "the service cannot read or write its API tokens or sessions; its log says which "
                "file, and what to do",
                instance=path,
                headers={"Retry-After": _UNAVAILABLE_S},
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
        case StoreError() if not context_of(request).is_service:
            return problem_response(HTTPStatus.INTERNAL_SERVER_ERROR, str(error), instance=path)
        case _:
            _log.error("request_failed", path=path, exc_info=error)
            return problem_response(
                HTTPStatus.INTERNAL_SERVER_ERROR, _internal(request, error), instance=path
            )


def _internal(request: Request, error: Exception) -> str:
    """Returns the text for an error that no request should cause."""
    if context_of(request).is_service:
        return "the service failed to answer; its log says why"
    return (
        f"internal error: {type(error).__name__}: {error}; the log on standard error shows where "
        "it was raised"
    )


def _place_in_batch(problem: Problem) -> str:
    """Returns the place of a problem's document in its batch; "" if the body is one document."""
    place = problem.pointer.removeprefix("/").partition("/")[0]
    return place if place.isdecimal() else ""


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
    if status is HTTPStatus.BAD_REQUEST and isinstance(
        error.__cause__, ValueError | RecursionError
    ):
        # FastAPI's answer to a body that its parser of JSON cannot decode or is too deep for it.
        problem = Problem(pointer="", code="json_invalid", message=f"not JSON: {error.__cause__}")
        return problem_response(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            "the request cannot be used",
            instance=public_path(request.scope),
            problems=(problem,),
        )
    headers = dict(error.headers or {})
    if status is HTTPStatus.NOT_FOUND and error.detail == status.phrase:
        docs = f"{context_of(request).root_path}/docs"
        detail = f"there is nothing at this path; {docs} shows what there is"
    elif status is HTTPStatus.METHOD_NOT_ALLOWED:
        headers["Allow"] = ", ".join(methods.allowed_methods(request.url.path))
        detail = f"{request.method} is not allowed here; allowed: {headers['Allow']}"
    else:
        detail = str(error.detail)
    return problem_response(status, detail, instance=public_path(request.scope), headers=headers)
