"""Flows of calls as generators of steps: one implementation for all clients.

A flow yields steps and is sent their outcomes. A client performs the steps, with or
without an event loop.
"""

from __future__ import annotations

import random
import time
import uuid
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from pathlib import Path
from typing import Any, Generic, TypeVar

import httpx

from drivora_service.client.call import Call, Listing
from drivora_service.client.replies import UNAVAILABLE, Reply, Service, no_answer, read_reply
from drivora_service.errors import ServiceError

T = TypeVar("T")

_FIRST_WAIT_S, _LONGEST_WAIT_S = 0.1, 5.0
_PASSING = (
    httpx.NetworkError,
    httpx.TimeoutException,
    httpx.RemoteProtocolError,
    httpx.ProxyError,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """Send a request; the outcome is a ``Reply``, or the error of a request without one.

    Attributes:
        target: File for the body of an answer with 2xx; ``None``: keep it in memory.
    """

    call: Call[Any]
    headers: Mapping[str, str]
    target: Path | None


@dataclass(frozen=True, slots=True)
class Sleep:
    """Wait for some seconds."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Emit(Generic[T]):
    """Hand a value to the caller."""

    value: T


@dataclass(frozen=True, slots=True, kw_only=True)
class Listen:
    """Open the stream of an answer, in place of the last one; the outcome is as of a request.

    The ``Reply`` has no content if its status is 200.
    """

    call: Call[Any]
    headers: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Receive:
    """Wait for the next part of the stream; the outcome is ``None`` at its end."""


Step = Request | Sleep | Listen | Receive
Outcome = Reply | httpx.RequestError | bytes | None
Flow = Generator[Step, Outcome, T]
Items = Generator[Step | Emit[T], Outcome, None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Terms:
    """The terms of requests: address, retries and their listener.

    Attributes:
        retry_s: Seconds for which a request that may be repeated is tried again.
        on_retry: Called with the reason of a retry and the seconds before it.
    """

    service: Service
    retry_s: float
    on_retry: Callable[[ServiceError, float], None]


@dataclass(frozen=True, slots=True)
class Answer(Generic[T]):
    """The value of an answer, and the seconds after which it is worth asking again."""

    value: T
    retry_after_s: float | None


@dataclass(slots=True)
class Patience:
    """The waits between tries.

    Attributes:
        seconds: For which tries are made.
        begun: Monotonic seconds of the first one.
        least_s: Of the next wait.
    """

    seconds: float
    begun: float = field(default_factory=time.monotonic)
    least_s: float = _FIRST_WAIT_S

    def wait_s(self, retry_after_s: float | None) -> float | None:
        """Returns the seconds before the next try, never fewer than asked; ``None``: give up."""
        # Clients that were refused together shall not come back together.
        wait = (retry_after_s or 0.0) + random.uniform(0.5, 1.0) * self.least_s
        self.least_s = min(2.0 * self.least_s, _LONGEST_WAIT_S)
        left = self.begun + self.seconds - time.monotonic()
        return wait if wait <= left else None


def perform_call(call: Call[T], terms: Terms, *, target: Path | None = None) -> Flow[Answer[T]]:
    """Sends the request of a call, again after a failure if that does no harm.

    Raises:
        InvalidDocument: The service refused a document.
        ServiceError: It refused or did not answer, for as long as it was tried.
    """
    headers = dict(call.headers)
    is_repeatable = call.is_repeatable
    if call.is_once and not terms.service.is_local:
        headers["Idempotency-Key"] = uuid.uuid4().hex
        is_repeatable = True
    patience = Patience(terms.retry_s)
    while True:
        outcome = yield Request(call=call, headers=headers, target=target)
        if isinstance(outcome, Reply):
            try:
                return Answer(read_reply(call, outcome, terms.service), outcome.retry_after_s)
            except ServiceError as error:
                fault, is_passing = error, may_pass(outcome)
                retry_after_s = outcome.retry_after_s
                is_harmless = is_repeatable or _was_not_done(outcome, terms.service)
        elif isinstance(outcome, httpx.RequestError):
            fault, retry_after_s = no_answer(outcome, terms.service), None
            is_harmless = is_repeatable
            # What an application in this process does not answer, it would not the next time.
            is_passing = isinstance(outcome, _PASSING) and not terms.service.is_local
        else:
            raise TypeError("a request has an outcome")
        wait = patience.wait_s(retry_after_s) if is_harmless and is_passing else None
        if wait is None:
            raise fault
        terms.on_retry(fault, wait)
        yield Sleep(wait)


def list_items(listing: Listing[T], terms: Terms) -> Items[T]:
    """Asks for the pages of a list and hands out the items.

    Raises:
        ServiceError: The service refused or did not answer.
    """
    token, taken = "", 0
    while listing.most is None or taken < listing.most:
        page = (yield from perform_call(listing.page(token, taken=taken), terms)).value
        for item in page.items[: None if listing.most is None else listing.most - taken]:
            yield Emit(item)
        taken += len(page.items)
        token = page.next_page_token
        if not token:
            return


def may_pass(reply: Reply) -> bool:
    """Returns whether the reason of a refusal may pass."""
    if reply.status in UNAVAILABLE:
        return True
    # The same request, whose answer was lost, is still being done.
    return reply.status == HTTPStatus.CONFLICT and reply.retry_after_s is not None


def _was_not_done(reply: Reply, service: Service) -> bool:
    """Returns whether a service refused a request for now, without having done any of it."""
    refusals = (HTTPStatus.TOO_MANY_REQUESTS, HTTPStatus.SERVICE_UNAVAILABLE)
    return not service.is_local and reply.status in refusals and reply.retry_after_s is not None
