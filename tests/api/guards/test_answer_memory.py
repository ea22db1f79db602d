"""Answers that are given again: their validity and their clients."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from starlette.responses import PlainTextResponse, StreamingResponse
from starlette.types import Message, Receive, Scope, Send

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards import answer_memory
from drivora_service.api.guards.answer_memory import AnswerMemory
from drivora_service.api.guards.api_tokens import Scope as TokenScope
from drivora_service.api.guards.api_tokens import TokenFile
from tests.api.conftest import MakeOffline, Offline
from tests.api.guards.test_api_tokens import bearer

TAG = {"ETag": '"tag"'}


class Counting:
    """An application that tells how often it was asked, once it is let."""

    def __init__(self) -> None:
        self.asked = 0
        self.gate = asyncio.Event()
        self.gate.set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.asked += 1
        content = f"{self.asked}"
        await self.gate.wait()
        scope["route"] = scope["path"]
        match scope["path"].rpartition("/")[2]:
            case "raises":
                raise ValueError("on purpose")
            case "untagged":
                response: Any = PlainTextResponse(content)
            case "missing":
                response = PlainTextResponse(content, 404, headers=TAG)
            case "large":
                response = PlainTextResponse(content * (1 << 17), headers=TAG)
            case "parts":
                response = StreamingResponse(_parts(content), headers=TAG)
            case _:
                response = PlainTextResponse(content, headers=TAG)
        await response(scope, receive, send)


async def _parts(content: str) -> AsyncIterator[str]:
    yield content
    yield ""


class Scene:
    """A memory, what it stands before, and the version of what that shows."""

    def __init__(self, tokens: TokenFile | None = None) -> None:
        self.inner = Counting()
        self.version: int | None = 1
        self.app = AnswerMemory(self.inner, version=lambda: self.version, tokens=lambda: tokens)

    async def ask(
        self,
        path: str = "/api/v1/jobs",
        method: str = "GET",
        until: asyncio.Event | None = None,
        **headers: str,
    ) -> str:
        """Asks; takes nothing of the answer until then."""
        sent: list[Message] = []

        async def send(message: Message) -> None:
            if until is not None:
                await until.wait()
            sent.append(message)

        async def receive() -> Message:
            await asyncio.Event().wait()
            raise AssertionError

        scope = {
            "type": "http",
            "method": method,
            "path": path,
            "query_string": b"",
            "headers": [(k.replace("_", "-").encode(), v.encode()) for k, v in headers.items()],
        }
        await self.app(scope, receive, send)
        assert [message["type"] for message in sent[:2]] == [
            "http.response.start",
            "http.response.body",
        ]
        assert scope["route"] == path
        return b"".join(message["body"] for message in sent[1:]).decode()


def play(scene: Callable[[], Any]) -> None:
    asyncio.run(scene())


def test_the_same_is_answered_once_until_something_changes() -> None:
    async def scene() -> None:
        s = Scene()
        assert [await s.ask() for _ in range(3)] == ["1", "1", "1"]
        s.version = 2
        assert [await s.ask() for _ in range(2)] == ["2", "2"]
        s.version = None
        assert [await s.ask() for _ in range(2)] == ["3", "4"]

    play(scene)


def test_what_an_answer_depends_on_is_told_apart() -> None:
    async def scene() -> None:
        s = Scene()
        seen = [
            await s.ask(),
            await s.ask("/api/v1/runs"),
            await s.ask(accept="application/x-ndjson"),
            await s.ask(if_none_match='"tag"'),
            await s.ask(authorization="Bearer one"),
        ]
        assert seen == ["1", "2", "3", "4", "5"]
        assert await s.ask() == "1"

    play(scene)


@pytest.mark.parametrize("name", ["untagged", "missing", "large", "parts"])
def test_other_answers_are_made_each_time(name: str) -> None:
    async def scene() -> None:
        s = Scene()
        assert (await s.ask(f"/api/v1/{name}"))[0] == "1"
        assert (await s.ask(f"/api/v1/{name}"))[0] == "2"

    play(scene)


def test_nothing_but_plain_reads_of_the_api_is_kept() -> None:
    async def scene() -> None:
        s = Scene()
        for _ in range(2):
            await s.ask(method="POST")
            await s.ask("/metrics")
            await s.ask("/api/v1/healthz")
            await s.ask(content_length="2")
        assert s.inner.asked == 8

    play(scene)


@pytest.mark.parametrize("name", ["large", "parts", "untagged"])
def test_no_request_waits_for_a_slow_client_of_what_is_not_kept(name: str) -> None:
    async def scene() -> None:
        s = Scene()
        slow = asyncio.Event()
        first = asyncio.create_task(s.ask(f"/api/v1/{name}", until=slow))
        await asyncio.sleep(0.01)
        assert not first.done()
        assert (await s.ask(f"/api/v1/{name}"))[0] == "2"
        slow.set()
        assert (await first)[0] == "1"

    play(scene)


def test_an_answer_grows_old(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(answer_memory, "LONGEST_S", 0.0)

    async def scene() -> None:
        s = Scene()
        assert [await s.ask() for _ in range(3)] == ["1", "2", "3"]
        # A request that comes while an answer is made takes it, however long that takes.
        s.inner.gate.clear()
        asked = [asyncio.create_task(s.ask()) for _ in range(5)]
        await asyncio.sleep(0.01)
        s.inner.gate.set()
        assert await asyncio.gather(*asked) == ["4"] * 5

    play(scene)


def test_a_request_after_a_change_does_not_get_what_was_begun_before_it() -> None:
    async def scene() -> None:
        s = Scene()
        s.inner.gate.clear()
        before = asyncio.create_task(s.ask())
        await asyncio.sleep(0)
        s.version = 2
        after = asyncio.create_task(s.ask())
        await asyncio.sleep(0)
        s.inner.gate.set()
        assert await before == "1"
        assert await after == "2"
        assert await s.ask() == "2"

    play(scene)


def test_requests_that_wait_are_answered_when_the_one_before_is_not() -> None:
    async def scene() -> None:
        s = Scene()
        s.inner.gate.clear()
        first = asyncio.create_task(s.ask())
        await asyncio.sleep(0)
        others = [asyncio.create_task(s.ask()) for _ in range(2)]
        await asyncio.sleep(0)
        first.cancel()
        await asyncio.sleep(0)
        s.inner.gate.set()
        assert sorted(await asyncio.gather(*others)) == ["2", "3"]
        with pytest.raises(ValueError, match="on purpose"):
            await s.ask("/api/v1/raises")
        with pytest.raises(ValueError, match="on purpose"):
            await s.ask("/api/v1/raises")

    play(scene)


def test_a_token_that_is_revoked_gets_nothing_of_what_is_kept(tmp_path: Path) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    secret = tokens.create("reader", TokenScope.READ)

    async def scene() -> None:
        s = Scene(tokens)
        assert await s.ask(authorization=f"Bearer {secret}") == "1"
        assert await s.ask(authorization=f"Bearer {secret}") == "1"
        tokens.revoke("reader")
        assert await s.ask(authorization=f"Bearer {secret}") == "2"
        # The application tells the client that the file cannot be read.
        (tmp_path / "tokens.json").write_text("[")
        assert await s.ask(authorization=f"Bearer {secret}") == "3"

    play(scene)


def test_only_so_many_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(answer_memory, "MOST_ANSWERS", 2)

    async def scene() -> None:
        s = Scene()
        for name in "abc":
            await s.ask(f"/api/v1/{name}")
        assert await s.ask("/api/v1/c") == "3"
        assert await s.ask("/api/v1/a") == "4"

    play(scene)


def test_a_client_finds_what_it_has_just_posted(offline: Offline) -> None:
    for number in range(1, 4):
        offline.client.post("/api/v1/jobs", json=SCENARIO).raise_for_status()
        for _ in range(2):
            answer = offline.client.get("/api/v1/jobs")
            assert len(answer.json()["items"]) == number
        known = offline.client.get(
            "/api/v1/jobs", headers={"If-None-Match": answer.headers["ETag"]}
        )
        assert known.status_code == 304


def test_what_one_token_may_see_no_other_is_shown(
    make_offline: MakeOffline, tmp_path: Path
) -> None:
    tokens = TokenFile(tmp_path / "tokens.json")
    secret = tokens.create("reader", TokenScope.READ)
    client: httpx.Client = make_offline(tokens=tokens).client
    assert client.get("/api/v1/jobs", headers=bearer(secret)).status_code == 200
    assert client.get("/api/v1/jobs").status_code == 401
    assert client.get("/api/v1/jobs", headers=bearer("drv_other")).status_code == 401
