"""Refuses bodies that are too large before they are read."""

from __future__ import annotations

import asyncio
from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from drivora_service.api.problems import ApiError, problem_response

_DRAIN_SECONDS = 5.0


class BodyLimit:
    """ASGI middleware: 413 for a body of more than ``max_bytes``.

    A declared length is judged before the application sees the request; a chunked body is counted
    as it comes. After an early answer the rest of the body is thrown away for a few seconds, so
    that a client that is still sending gets to read the answer rather than a reset connection.
    """

    def __init__(self, app: ASGIApp, *, max_bytes: int) -> None:
        self._app = app
        self._max_bytes = max_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        declared = Headers(scope=scope).get("content-length", "0")
        if not declared.isdecimal():
            await _answer(scope, receive, send, HTTPStatus.BAD_REQUEST, "bad Content-Length")
            return
        if len(declared) > 18 or int(declared) > self._max_bytes:
            detail = self._detail()
            await _answer(
                scope, receive, send, HTTPStatus.REQUEST_ENTITY_TOO_LARGE, detail, drain=True
            )
            return
        received = 0
        too_large = False

        async def counted_receive() -> Message:
            nonlocal received, too_large
            message = await receive()
            if message["type"] == "http.request":
                received += len(message.get("body", b""))
                if received > self._max_bytes:
                    too_large = True
                    raise ApiError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, self._detail())
            return message

        async def draining_send(message: Message) -> None:
            if too_large and message["type"] == "http.response.body":
                await send({**message, "more_body": True})
                await _drain(receive)
                message = {"type": "http.response.body", "body": b"", "more_body": False}
            await send(message)

        await self._app(scope, counted_receive, draining_send)

    def _detail(self) -> str:
        return f"the body is larger than the {self._max_bytes} bytes that are allowed"


async def _answer(
    scope: Scope,
    receive: Receive,
    send: Send,
    status: HTTPStatus,
    detail: str,
    *,
    drain: bool = False,
) -> None:
    response = problem_response(
        status, detail, instance=scope["path"], headers={"Connection": "close"}
    )

    async def send_then_drain(message: Message) -> None:
        if drain and message["type"] == "http.response.body":
            await send({**message, "more_body": True})
            await _drain(receive)
            message = {"type": "http.response.body", "body": b"", "more_body": False}
        await send(message)

    await response(scope, receive, send_then_drain)


async def _drain(receive: Receive) -> None:
    try:
        async with asyncio.timeout(_DRAIN_SECONDS):
            while True:
                message = await receive()
                if message["type"] == "http.disconnect" or not message.get("more_body", False):
                    return
    except TimeoutError:
        return
