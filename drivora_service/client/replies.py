"""Replies of a service: values, or errors with the reason."""

from __future__ import annotations

import email.utils
from dataclasses import dataclass
from datetime import UTC, datetime
from http import HTTPStatus
from typing import TYPE_CHECKING, TypeVar

from drivora_service.client.call import Call
from drivora_service.errors import (
    DrivoraError,
    InvalidDocument,
    NotAuthorised,
    NotFound,
    Problem,
    RequestConflict,
    ServiceError,
    ServiceUnavailable,
)
from drivora_service.shapes import adapter

if TYPE_CHECKING:
    import httpx

T = TypeVar("T")

UNAVAILABLE = frozenset(
    {
        HTTPStatus.TOO_MANY_REQUESTS,
        HTTPStatus.SERVICE_UNAVAILABLE,
        # Of a proxy whose service does not answer.
        HTTPStatus.BAD_GATEWAY,
        HTTPStatus.GATEWAY_TIMEOUT,
    }
)
"""Statuses of temporary failures."""

_KINDS: dict[int, type[ServiceError]] = {
    HTTPStatus.UNAUTHORIZED: NotAuthorised,
    HTTPStatus.FORBIDDEN: NotAuthorised,
    HTTPStatus.NOT_FOUND: NotFound,
    HTTPStatus.CONFLICT: RequestConflict,
    **dict.fromkeys(UNAVAILABLE, ServiceUnavailable),
}
_MOST_SHOWN = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """The reply to a request.

    Attributes:
        content: The body; empty if it was written to a file.
    """

    status: int
    headers: httpx.Headers
    content: bytes

    @property
    def retry_after_s(self) -> float | None:
        """Seconds after which it is sensible to ask again; ``None``: not stated."""
        text = self.headers.get("retry-after", "").strip()
        if text.isascii() and text.isdigit():
            return float(text)
        try:
            when = email.utils.parsedate_to_datetime(text)
        except ValueError:
            return None
        when = when if when.tzinfo is not None else when.replace(tzinfo=UTC)
        return max(0.0, (when - datetime.now(UTC)).total_seconds())


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """The service of a request.

    Attributes:
        url: Its address.
        is_local: Whether it is the application in this process.
    """

    url: str
    is_local: bool

    @property
    def name(self) -> str:
        """Its name in messages."""
        return "the application" if self.is_local else f"the service at {self.url}"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Details:
    """Problem details (RFC 9457), as far as they are needed."""

    detail: str = ""
    problems: tuple[Problem, ...] = ()


def read_reply(call: Call[T], reply: Reply, service: Service) -> T:
    """Returns the value of a reply; keys that its type does not have are left out.

    Raises:
        InvalidDocument: The service refused a document.
        ServiceError: It refused, or the reply cannot be read.
    """
    if not 200 <= reply.status < 300 and reply.status not in call.accepted:
        raise _refusal(reply, service)
    if call.answer is type(None):
        return None
    if call.answer is bytes:
        return reply.content  # type: ignore[return-value] # T is bytes here
    try:
        if call.answer is str:
            return reply.content.decode()  # type: ignore[return-value] # T is str here
        value: T = adapter(call.answer).validate_json(reply.content, extra="ignore")
    except ValueError as error:
        if reply.status in call.accepted:
            # Such as the page of a proxy with the same status.
            raise _refusal(reply, service) from error
        raise ServiceError(
            f"{service.name} answered {call.method} {call.path} with what this version of the "
            f"client cannot read: {_short(str(error))}. Is it the address of Drivora, and of a "
            "version near this one?",
            status=reply.status,
        ) from error
    return value


def no_answer(error: httpx.RequestError, service: Service) -> ServiceError:
    """Returns the error for a request without an answer."""
    said = str(error) or type(error).__name__
    unanswered = ServiceUnavailable(f"{service.name} does not answer: {said}")
    unanswered.__cause__ = error
    return unanswered


def _refusal(reply: Reply, service: Service) -> DrivoraError:
    try:
        details: _Details = adapter(_Details).validate_json(reply.content, extra="ignore")
    except ValueError:
        details = _Details()
    if details.problems and reply.status == HTTPStatus.UNPROCESSABLE_ENTITY:
        return InvalidDocument(details.problems)
    kind = _KINDS.get(reply.status, ServiceError)
    if not details.detail:
        form = reply.headers.get("content-type", "no media type")
        return kind(
            f"{service.name} answered {reply.status} {_phrase(reply.status)} without a reason "
            f"({form}); such answers come from a proxy, or from another server at this address",
            status=reply.status,
        )
    said = details.detail
    if reply.status == HTTPStatus.UNAUTHORIZED:
        said += (
            "; set DRIVORA_TOKEN to a token, which `drivora tokens create NAME` makes on the "
            "machine of the service"
        )
    return kind(said if service.is_local else f"the service refused: {said}", status=reply.status)


def _phrase(status: int) -> str:
    try:
        return HTTPStatus(status).phrase
    except ValueError:
        return "(unknown status)"


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _MOST_SHOWN else f"{line[:_MOST_SHOWN]}…"
