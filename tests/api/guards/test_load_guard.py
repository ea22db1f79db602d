"""The bound on requests at once."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from starlette.responses import PlainTextResponse
from starlette.types import Message, Receive, Scope, Send

from drivora_service.api.guards.load_guard import LoadGuard


class Slow:
    """An application that answers when it is let."""

    def __init__(self) -> None:
        self.gate = asyncio.Event()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["path"] == "/raises":
            raise ValueError("on purpose")
        if scope["path"] == "/slow":
            await self.gate.wait()
        await PlainTextResponse("done")(scope, receive, send)


async def ask(app: LoadGuard, path: str) -> dict[Any, Any]:
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    await app({"type": "http", "method": "GET", "path": path, "headers": []}, receive, send)
    return {"status": sent[0]["status"], **dict(sent[0]["headers"])}


def test_what_is_beyond_the_bound_is_told_to_come_back() -> None:
    async def scene() -> None:
        inner = Slow()
        app = LoadGuard(inner, most=3)
        waiting = [asyncio.create_task(ask(app, "/slow")) for _ in range(3)]
        await asyncio.sleep(0)
        refused = await ask(app, "/other")
        assert refused["status"] == 503
        assert refused[b"retry-after"] == b"1"
        assert refused[b"content-type"] == b"application/problem+json"
        for health in ("/healthz", "/api/v1/healthz", "/readyz", "/api/v1/readyz"):
            assert (await ask(app, health))["status"] == 200
        inner.gate.set()
        assert [answer["status"] for answer in await asyncio.gather(*waiting)] == [200] * 3
        assert (await ask(app, "/other"))["status"] == 200

    asyncio.run(scene())


def test_a_request_that_fails_is_over() -> None:
    async def scene() -> None:
        app = LoadGuard(Slow(), most=1)
        for _ in range(3):
            with pytest.raises(ValueError, match="on purpose"):
                await ask(app, "/raises")
        assert (await ask(app, "/other"))["status"] == 200

    asyncio.run(scene())
