"""The limit of a body, at the door of the application."""

from __future__ import annotations

import asyncio
import time
from dataclasses import dataclass, field

import pytest
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.types import Message, Receive, Scope, Send

from drivora_service.api.guards import body_limit
from drivora_service.api.guards.body_limit import BodyLimit
from drivora_service.api.guards.client_counts import ClientCounts
from drivora_service.api.problem_details import ApiError, problem_response

LIMIT = 1000
CUT_OFF = "drivora_clients_cut_off_total"


async def echo(scope: Scope, receive: Receive, send: Send) -> None:
    """An application that reads the whole body and answers as the real one does."""
    try:
        body = await Request(scope, receive).body()
        answer = PlainTextResponse(str(len(body)))
    except ApiError as error:
        answer = problem_response(error.status, error.detail, headers=error.headers)  # type: ignore[assignment]  # either is a response
    await answer(scope, receive, send)


@dataclass(slots=True, kw_only=True)
class Client:
    """A client that sends chunks of one size and, after the last, nothing more.

    Attributes:
        chunks: How many; with ``stalls`` the body does not end with them.
        events: What happened, in order: ``"read"`` and the messages that the server sent.
    """

    chunk: int
    chunks: int
    stalls: bool = False
    events: list[str | Message] = field(default_factory=list)

    async def receive(self) -> Message:
        if self.taken == self.chunks:
            await asyncio.Event().wait()
        self.events.append("read")
        more = self.stalls or self.taken < self.chunks
        return {"type": "http.request", "body": b" " * self.chunk, "more_body": more}

    async def send(self, message: Message) -> None:
        self.events.append(message)

    @property
    def taken(self) -> int:
        """Chunks that the server has read."""
        return self.events.count("read")

    def post(self, declared: int | None, path: str = "/") -> None:
        """Posts the chunks to an application behind the limit."""
        length = [] if declared is None else [(b"content-length", str(declared).encode())]
        scope = {"type": "http", "method": "POST", "path": path, "headers": length}
        limit = BodyLimit(echo, max_bytes=LIMIT, of_paths={"/files": 3 * LIMIT})
        asyncio.run(limit(scope, self.receive, self.send))

    @property
    def answer(self) -> dict[str, object]:
        """Status, whether the connection is to be closed, and whether the answer is complete."""
        sent = [event for event in self.events if not isinstance(event, str)]
        return {
            "status": sent[0]["status"],
            "close": (b"connection", b"close") in sent[0]["headers"],
            "complete": not sent[-1].get("more_body", False),
        }


REFUSED = {"status": 413, "close": True, "complete": True}


@pytest.mark.parametrize("declared", [LIMIT, None])
def test_a_body_within_the_limit_is_read(declared: int | None) -> None:
    client = Client(chunk=LIMIT // 4, chunks=4)
    client.post(declared)
    assert client.answer == {"status": 200, "close": False, "complete": True}


def test_a_declared_length_is_refused_unread() -> None:
    client = Client(chunk=LIMIT, chunks=2)
    client.post(2 * LIMIT)
    head, body, *rest = client.events
    assert not isinstance(head, str)
    assert head["status"] == 413
    assert not isinstance(body, str)
    assert rest.count("read") == 2
    assert client.answer == REFUSED


def test_chunks_are_read_up_to_the_limit() -> None:
    client = Client(chunk=LIMIT // 2, chunks=8)
    client.post(None)
    before = [isinstance(event, str) for event in client.events].index(False)
    assert before == 3
    assert client.taken == 8
    assert client.answer == REFUSED


@pytest.mark.parametrize("declared", [10**12, None])
def test_a_client_that_never_stops_is_cut_off(declared: int | None) -> None:
    client = Client(chunk=1 << 20, chunks=10**6, stalls=True)
    client.post(declared)
    assert client.taken <= (body_limit.DRAIN_BYTES >> 20) + 1
    assert client.answer == REFUSED


@pytest.mark.parametrize("declared", [10**12, None])
def test_a_client_that_stalls_is_cut_off(
    monkeypatch: pytest.MonkeyPatch, declared: int | None
) -> None:
    monkeypatch.setattr(body_limit, "DRAIN_SECONDS", 0.01)
    client = Client(chunk=LIMIT + 1, chunks=1, stalls=True)
    client.post(declared)
    assert client.taken == 1
    assert client.answer == REFUSED


def test_a_client_that_was_fast_and_stalls_is_not_waited_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(body_limit, "BODY_SECONDS", 0.05)
    # At this speed its bytes would last for a quarter of an hour.
    monkeypatch.setattr(body_limit, "BODY_BYTES_A_SECOND", 1)
    client = Client(chunk=LIMIT - 1, chunks=1, stalls=True)
    client.post(None)
    assert client.answer == {"status": 408, "close": True, "complete": True}


@pytest.mark.parametrize("declared", [3 * LIMIT, None])
def test_a_path_with_a_limit_of_its_own(declared: int | None) -> None:
    for path, expected in (("/files", 200), ("/files/x", 413), ("/", 413)):
        client = Client(chunk=LIMIT, chunks=3)
        client.post(declared, path)
        assert client.answer["status"] == expected
    client = Client(chunk=LIMIT, chunks=4)
    client.post(None if declared is None else 4 * LIMIT, "/files")
    assert client.answer == REFUSED


@pytest.mark.parametrize("declared", ["-1", "1.5", "many"])
def test_a_length_that_is_none(declared: str) -> None:
    client = Client(chunk=0, chunks=1)
    scope = {
        "type": "http",
        "method": "POST",
        "path": "/",
        "headers": [(b"content-length", declared.encode())],
    }
    asyncio.run(BodyLimit(echo, max_bytes=LIMIT)(scope, client.receive, client.send))
    assert client.answer == {"status": 400, "close": True, "complete": True}


def test_a_body_whose_time_is_over_is_not_given_up_as_well() -> None:
    counts = ClientCounts()
    faults: list[dict[str, object]] = []

    async def scene() -> None:
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(lambda _loop, context: faults.append(context))
        limit = BodyLimit(echo, max_bytes=LIMIT, body_s=0.1, of_a_client=1, counts=counts)

        def post() -> asyncio.Task[None]:
            client = Client(chunk=0, chunks=0)
            scope = {"type": "http", "method": "POST", "path": "/", "headers": []}
            return asyncio.create_task(limit(scope, client.receive, client.send))

        first = post()
        await asyncio.sleep(0.05)
        second = post()
        # Busy until the time of the first is over: it ends in the turn in which the second begins.
        time.sleep(0.1)
        await first
        await second

    asyncio.run(scene())
    assert faults == []
    assert counts.registry.get_sample_value(CUT_OFF, {"reason": "body"}) == 2.0
    assert counts.registry.get_sample_value(CUT_OFF, {"reason": "bodies"}) == 0.0
