"""A limit of the requests that are served at once; further ones are refused at once."""

from __future__ import annotations

from http import HTTPStatus

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from drivora_service.api.guards.path_prefix import public_path
from drivora_service.api.problem_details import problem_response
from drivora_service.api_paths import PREFIX

MOST_REQUESTS = 256
"""More would not be answered sooner: they would only wait here instead of at the client."""
RETRY_AFTER_S = 1

HEALTH_PATHS = frozenset(
    f"{prefix}/{name}" for prefix in ("", PREFIX) for name in ("healthz", "readyz")
)
"""Answered without a thread and without the database."""
EVENTS_PATH = f"{PREFIX}/events"
"""Streams, which last; they have a bound of their own, see ``change_feed``."""

_NOT_COUNTED = HEALTH_PATHS | {EVENTS_PATH}


class LoadGuard:
    """ASGI middleware: 503 with ``Retry-After`` for a request beyond ``most`` at once.

    Whether the service lives and is ready can always be asked. Streams of events are not counted,
    nor is a request while it waits for its client: for the rest of its body, or until the client
    takes what was sent. ``BodyLimit`` and ``BoundedConnection`` bound those.
    """

    def __init__(self, app: ASGIApp, *, most: int = MOST_REQUESTS) -> None:
        self._app = app
        self._most = most
        self._served = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] != "http" or scope["path"] in _NOT_COUNTED:
            await self._app(scope, receive, send)
            return
        if self._served >= self._most:
            # A body that is not read leaves the connection of no further use.
            await _refuse(scope, receive, send, close=scope["method"] not in ("GET", "HEAD"))
            return
        is_served = body_complete = False

        def count(served: bool) -> None:
            nonlocal is_served
            self._served += served - is_served
            is_served = served

        async def receive_uncounted() -> Message:
            nonlocal body_complete
            if body_complete:
                return await receive()
            count(False)
            try:
                message = await receive()
            finally:
                count(True)
            body_complete = not message.get("more_body", False)
            return message

        async def send_uncounted(message: Message) -> None:
            count(False)
            try:
                await send(message)
            finally:
                count(True)

        count(True)
        try:
            await self._app(scope, receive_uncounted, send_uncounted)
        finally:
            count(False)


async def refuse_overload(scope: Scope, receive: Receive, send: Send) -> None:
    """Answers that the service is busy and when to come back; closes the connection."""
    await _refuse(scope, receive, send, close=True)


async def _refuse(scope: Scope, receive: Receive, send: Send, *, close: bool) -> None:
    """Answers that the service is busy and when to come back.

    Args:
        scope: The request.
        receive: Not used.
        send: Takes the answer.
        close: Whether the connection ends; opening another one costs both sides more.
    """
    headers = {"Retry-After": str(RETRY_AFTER_S)}
    response = problem_response(
        HTTPStatus.SERVICE_UNAVAILABLE,
        f"too many requests at once; try again in {RETRY_AFTER_S} s",
        instance=public_path(scope),
        headers={**headers, "Connection": "close"} if close else headers,
    )
    await response(scope, receive, send)
