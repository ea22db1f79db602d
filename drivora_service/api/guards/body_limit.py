"""Refuses bodies that are too large before they are read."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from http import HTTPStatus
from types import MappingProxyType

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from drivora_service.api.guards.client_counts import ClientCounts
from drivora_service.api.guards.client_waits import MOST_OF_A_CLIENT, ClientWaits, client_key
from drivora_service.api.guards.path_prefix import public_path
from drivora_service.api.problem_details import ApiError, problem_response

DRAIN_SECONDS = 2.0
DRAIN_BYTES = 16 << 20
"""Bytes that a client on the same machine sends in some hundredths of a second."""
BODY_SECONDS = 20.0
"""For which a client may send nothing, and after which it must have kept the speed below."""
BODY_BYTES_A_SECOND = 16 << 10
"""A client that sends more slowly, after the first seconds, only holds a connection."""
_CLOSE = {"Connection": "close"}


class BodyLimit:
    """ASGI middleware: 413 for a body of more than ``max_bytes``.

    A path may have a limit of its own. A declared length is judged before the application sees the
    request; a chunked body is counted as it comes. The answer is sent at once and the connection
    closed a little later: until then what still comes is thrown away, because a client that is
    writing to a closed connection may lose the answer before it reads it. A client that continues
    for longer than ``DRAIN_SECONDS`` or ``DRAIN_BYTES`` is cut off. A body that comes too slowly,
    or does not come on, is answered with 408.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        max_bytes: int,
        of_paths: Mapping[str, int] = MappingProxyType({}),
        body_s: float | None = None,
        of_a_client: int = MOST_OF_A_CLIENT,
        counts: ClientCounts | None = None,
    ) -> None:
        """Creates the middleware around an application.

        Args:
            app: What answers.
            max_bytes: Greatest size of a body.
            of_paths: The same for some paths.
            body_s: Seconds for which a client may send nothing; ``None``: ``BODY_SECONDS``.
            of_a_client: Bodies of one client that are waited for at the same moment; of more, the
                one that was waited for longest is given up.
            counts: What happens to clients.
        """
        self._app = app
        self._max_bytes, self._of_paths = max_bytes, of_paths
        self._body_s = body_s
        self._waits = ClientWaits(most_of_a_client=of_a_client)
        self._counts = counts or ClientCounts()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        declared = Headers(scope=scope).get("content-length", "0")
        if not declared.isdecimal():
            await _refuse(scope, receive, send, HTTPStatus.BAD_REQUEST, "bad Content-Length")
            return
        max_bytes = self._of_paths.get(scope["path"], self._max_bytes)
        too_many = f"the body is larger than the {max_bytes} bytes that are allowed"
        if len(declared) > 18 or int(declared) > max_bytes:
            status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
            await _refuse(scope, receive, send, status, too_many)
            return
        received = 0
        is_given_up = False
        too_large = False
        complete = False
        loop = asyncio.get_running_loop()
        began = loop.time()
        client = client_key(scope.get("client"))

        async def receive_in_time() -> Message:
            nonlocal is_given_up
            # What came fast must not pay for a client that then stops.
            body_s = BODY_SECONDS if self._body_s is None else self._body_s
            left = min(began + received / BODY_BYTES_A_SECOND, loop.time()) + body_s

            def give_up() -> None:
                nonlocal is_given_up
                # Its own time may be over, and the task that waits has not had its turn yet.
                if not waiting.expired():
                    is_given_up = True
                    waiting.reschedule(loop.time())

            async with asyncio.timeout_at(left) as waiting:
                with self._waits.wait(client, give_up):
                    return await receive()

        async def receive_within_limits() -> Message:
            nonlocal received, too_large, complete
            if complete:
                # It is waited for the client to leave, as long as it likes.
                return await receive()
            try:
                message = await receive_in_time()
            except TimeoutError:
                self._counts.cut_off("bodies" if is_given_up else "body")
                raise _late(received, is_given_up=is_given_up) from None
            complete = not message.get("more_body", False)
            if message["type"] == "http.request":
                received += len(message.get("body", b""))
                if received > max_bytes:
                    too_large = True
                    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
                    raise ApiError(status, too_many, headers=_CLOSE)
            return message

        async def lingering_send(message: Message) -> None:
            await (_send_and_linger(message, receive, send) if too_large else send(message))

        await self._app(scope, receive_within_limits, lingering_send)


def _late(received: int, *, is_given_up: bool) -> ApiError:
    """Returns the answer to a body that did not come in time."""
    if is_given_up:
        return ApiError(
            HTTPStatus.SERVICE_UNAVAILABLE,
            f"this client has begun too many requests without sending their bodies: this one, with "
            f"{received} bytes so far, was waited for longest. Send the body with its head, and "
            "fewer at once",
            headers={**_CLOSE, "Retry-After": "1"},
        )
    return ApiError(
        HTTPStatus.REQUEST_TIMEOUT,
        f"the body came too slowly: {received} bytes so far",
        headers=_CLOSE,
    )


async def _refuse(
    scope: Scope, receive: Receive, send: Send, status: HTTPStatus, detail: str
) -> None:
    response = problem_response(status, detail, instance=public_path(scope), headers=_CLOSE)

    async def lingering_send(message: Message) -> None:
        await _send_and_linger(message, receive, send)

    await response(scope, receive, lingering_send)


async def _send_and_linger(message: Message, receive: Receive, send: Send) -> None:
    """Sends a part of an answer; after the last the connection stays open for a moment."""
    if message["type"] != "http.response.body":
        await send(message)
        return
    await send({**message, "more_body": True})
    await _drain(receive)
    await send({"type": "http.response.body", "body": b"", "more_body": False})


async def _drain(receive: Receive) -> None:
    """Discards input until the end of the body, the end of the connection or a limit."""
    left = DRAIN_BYTES
    try:
        async with asyncio.timeout(DRAIN_SECONDS):
            while left > 0:
                message = await receive()
                if message["type"] == "http.disconnect" or not message.get("more_body", False):
                    return
                left -= len(message.get("body", b""))
    except TimeoutError:
        return
