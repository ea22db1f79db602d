"""Transports to an application in the same process, against small applications."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest

from drivora_service.client import ApplicationTransport, AsyncApplicationTransport
from drivora_service.client.lifespan import Application, Message, Receive, Send
from drivora_service.errors import ServiceError, StoreError

CHUNK = b"x" * 65536


class Small:
    """An application with a lifespan that answers as a test says.

    Attributes:
        events: What happened, in order.
        messages: What the application received.
    """

    def __init__(self, answer: Callable[[dict[str, Any], Receive, Send], Any]) -> None:
        self.answer = answer
        self.events: list[str] = []
        self.messages: list[Message] = []
        self.scopes: list[dict[str, Any]] = []

    async def __call__(self, scope: Any, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self.live(scope, receive, send)
            return
        self.scopes.append(scope)
        self.events.append("request")

        async def noting_receive() -> Message:
            message = await receive()
            self.messages.append(message)
            return message

        await self.answer(scope, noting_receive, send)

    async def live(self, scope: Any, receive: Receive, send: Send) -> None:
        assert (await receive())["type"] == "lifespan.startup"
        scope["state"]["started"] = True
        self.events.append("startup")
        await send({"type": "lifespan.startup.complete"})
        assert (await receive())["type"] == "lifespan.shutdown"
        self.events.append("shutdown")
        await send({"type": "lifespan.shutdown.complete"})


async def begin(send: Send, status: int = 200, **headers: str) -> None:
    pairs = [(name.encode(), value.encode()) for name, value in headers.items()]
    await send({"type": "http.response.start", "status": status, "headers": pairs})


async def body(send: Send, content: bytes = b"", *, more: bool = False) -> None:
    await send({"type": "http.response.body", "body": content, "more_body": more})


async def hello(scope: Any, receive: Receive, send: Send) -> None:
    await begin(send, 201, greeting="yes")
    await body(send, b"hello")


async def echo(scope: Any, receive: Receive, send: Send) -> None:
    """Sends every part of the body back as soon as it is there."""
    await begin(send)
    more = True
    while more:
        message = await receive()
        assert message["type"] == "http.request"
        more = message["more_body"]
        await body(send, message["body"], more=True)
    await body(send)


def client_of(app: Application, **options: Any) -> httpx.Client:
    return httpx.Client(transport=ApplicationTransport(app), base_url="http://127.0.0.1", **options)


def async_client_of(app: Application, **options: Any) -> httpx.AsyncClient:
    return httpx.AsyncClient(
        transport=AsyncApplicationTransport(app), base_url="http://127.0.0.1", **options
    )


def eventually(condition: Callable[[], object], seconds: float = 20.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.01)


def test_the_application_starts_with_the_first_request_and_stops_with_the_client() -> None:
    app = Small(hello)
    with client_of(app) as client:
        assert app.events == []
        response = client.get("/x")
        client.get("/y")
        assert app.events == ["startup", "request", "request"]
    assert app.events == ["startup", "request", "request", "shutdown"]
    assert (response.status_code, response.headers["greeting"]) == (201, "yes")
    assert (response.text, response.http_version) == ("hello", "HTTP/1.1")


def test_an_application_that_was_not_asked_anything_does_not_start() -> None:
    app = Small(hello)
    with client_of(app):
        pass
    assert app.events == []


def test_the_scope_is_that_of_a_request_over_http() -> None:
    app = Small(hello)
    with client_of(app) as client:
        client.get("/a%20b/%2F", params={"q": "1 2"}, headers={"X-Name": "value"})
    (scope,) = app.scopes
    assert scope["method"] == "GET"
    assert scope["path"] == "/a b//"
    assert scope["raw_path"] == b"/a%20b/%2F"
    assert scope["query_string"] == b"q=1+2"
    assert scope["http_version"] == "1.1"
    assert scope["client"][0] == "127.0.0.1"
    assert scope["server"] == ("127.0.0.1", 80)
    assert (b"x-name", b"value") in scope["headers"]
    assert (b"host", b"127.0.0.1") in scope["headers"]
    assert scope["state"] == {"started": True}


def test_a_request_without_a_body_is_one_empty_message() -> None:
    async def read(scope: Any, receive: Receive, send: Send) -> None:
        await receive()
        await hello(scope, receive, send)

    app = Small(read)
    with client_of(app) as client:
        client.get("/")
    assert app.messages == [{"type": "http.request", "body": b"", "more_body": False}]


def test_an_application_without_a_lifespan_is_served() -> None:
    async def app(scope: Any, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            await hello(scope, receive, send)

    with client_of(app) as client:
        assert client.get("/").text == "hello"


class Refusing(Small):
    """Fails at its startup, as Starlette does it."""

    def __init__(self, error: Exception) -> None:
        super().__init__(hello)
        self.error = error

    async def live(self, scope: Any, receive: Receive, send: Send) -> None:
        await receive()
        await send({"type": "lifespan.startup.failed", "message": "no"})
        raise self.error from OSError("the disk is gone")


def test_an_error_of_the_startup_is_raised_as_it_is_at_every_request() -> None:
    error = StoreError("no database")
    with client_of(Refusing(error)) as client:
        for _ in range(2):
            with pytest.raises(StoreError) as raised:
                client.get("/")
            assert raised.value is error
            assert isinstance(raised.value.__cause__, OSError)


def test_an_error_of_the_startup_is_raised_as_it_is_in_an_event_loop() -> None:
    error = StoreError("no database")

    async def ask() -> None:
        async with async_client_of(Refusing(error)) as client:
            await client.get("/")

    with pytest.raises(StoreError) as raised:
        asyncio.run(ask())
    assert raised.value is error
    assert isinstance(raised.value.__cause__, OSError)


def test_a_startup_that_only_says_that_it_failed_is_an_error() -> None:
    class Saying(Small):
        async def live(self, scope: Any, receive: Receive, send: Send) -> None:
            await receive()
            await send({"type": "lifespan.startup.failed", "message": "no room"})

    with client_of(Saying(hello)) as client, pytest.raises(ServiceError, match="no room"):
        client.get("/")


def test_an_exit_at_the_startup_does_not_end_the_event_loop() -> None:
    class Leaving(Small):
        async def live(self, scope: Any, receive: Receive, send: Send) -> None:
            raise SystemExit(3)

    with client_of(Leaving(hello)) as client, pytest.raises(ServiceError) as raised:
        client.get("/")
    assert isinstance(raised.value.__cause__, SystemExit)


def test_an_error_of_the_shutdown_is_raised_by_closing() -> None:
    class Failing(Small):
        async def live(self, scope: Any, receive: Receive, send: Send) -> None:
            await super().live(scope, receive, send)
            raise StoreError("cannot write the end")

    client = client_of(Failing(hello))
    assert client.get("/").text == "hello"
    with pytest.raises(StoreError, match="cannot write the end"):
        client.close()
    with pytest.raises(RuntimeError):
        client.get("/")


def test_the_shutdown_runs_after_an_interrupt() -> None:
    async def interrupting(scope: Any, receive: Receive, send: Send) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        message = await receive()
        while message["type"] != "http.disconnect":
            message = await receive()
        app.events.append("disconnect")

    app = Small(interrupting)
    with pytest.raises(KeyboardInterrupt), client_of(app) as client:
        client.get("/")
    assert app.events == ["startup", "request", "disconnect", "shutdown"]


def test_an_interrupt_while_the_application_starts_cancels_the_startup() -> None:
    class Slow(Small):
        async def live(self, scope: Any, receive: Receive, send: Send) -> None:
            try:
                os.kill(os.getpid(), signal.SIGINT)
                await asyncio.sleep(600)
            finally:
                self.events.append("cleaned")

    app = Slow(hello)
    with pytest.raises(KeyboardInterrupt), client_of(app) as client:
        client.get("/")
    assert app.events == ["cleaned"]


def test_an_interrupt_while_closing_waits_for_the_shutdown() -> None:
    class Slow(Small):
        async def live(self, scope: Any, receive: Receive, send: Send) -> None:
            await super().live(scope, receive, send)
            os.kill(os.getpid(), signal.SIGINT)
            await asyncio.sleep(0.2)
            self.events.append("done")

    app = Slow(hello)
    client = client_of(app)
    client.get("/")
    with pytest.raises(KeyboardInterrupt):
        client.close()
    assert app.events[-1] == "done"


def test_an_interrupt_before_the_closing_has_begun_waits_for_the_shutdown(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Known(Small):
        async def live(self, scope: Any, receive: Receive, send: Send) -> None:
            self.loop = asyncio.get_running_loop()
            await super().live(scope, receive, send)

    def interrupted(*_: Any) -> None:
        monkeypatch.undo()
        raise KeyboardInterrupt

    app = Known(hello)
    client = client_of(app)
    client.get("/")
    monkeypatch.setattr(app.loop, "call_soon_threadsafe", interrupted)
    with pytest.raises(KeyboardInterrupt):
        client.close()
    assert app.events[-1] == "shutdown"


def test_the_shutdown_runs_after_a_cancellation() -> None:
    app = Small(echo)

    async def ask() -> None:
        async with async_client_of(app) as client:
            await client.get("/")
            await asyncio.sleep(600)

    async def cancel() -> None:
        task = asyncio.create_task(ask())
        while "request" not in app.events:
            await asyncio.sleep(0.01)
        await asyncio.sleep(0.05)
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task

    asyncio.run(cancel())
    assert app.events[-1] == "shutdown"


def test_the_shutdown_runs_when_the_interpreter_ends_without_closing() -> None:
    program = """
import httpx
from drivora_service.client import ApplicationTransport

async def app(scope, receive, send):
    if scope["type"] == "lifespan":
        await receive()
        await send({"type": "lifespan.startup.complete"})
        await receive()
        print("shutdown")
    else:
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"hello"})

client = httpx.Client(transport=ApplicationTransport(app))
print(client.get("http://127.0.0.1/").text)
"""
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=False
    )
    assert (ended.returncode, ended.stdout) == (0, "hello\nshutdown\n"), ended.stderr


class Pouring(Small):
    """Sends far more than is read, and counts what it got rid of."""

    def __init__(self, chunks: int) -> None:
        super().__init__(self.pour)
        self.chunks, self.poured = chunks, 0
        self.gone = threading.Event()

    async def pour(self, scope: Any, receive: Receive, send: Send) -> None:
        await begin(send)
        watching = asyncio.create_task(self.watch(receive))
        for _ in range(self.chunks):
            await body(send, CHUNK, more=True)
            self.poured += 1
            if self.gone.is_set():
                break
        await body(send)
        await watching

    async def watch(self, receive: Receive) -> None:
        while (await receive())["type"] != "http.disconnect":
            pass
        self.gone.set()


def test_an_answer_of_many_megabytes_comes_chunk_by_chunk() -> None:
    app = Pouring(chunks=500)
    with client_of(app) as client, client.stream("GET", "/") as response:
        parts = response.iter_raw()
        for read in range(1, 20):
            assert next(parts) == CHUNK
            time.sleep(0.005)
            assert app.poured <= read + 6
        assert sum(map(len, parts)) == len(CHUNK) * (500 - 19)
    assert app.poured == 500


def test_an_answer_of_many_megabytes_comes_chunk_by_chunk_in_an_event_loop() -> None:
    app = Pouring(chunks=500)

    async def ask() -> int:
        async with async_client_of(app) as client, client.stream("GET", "/") as response:
            read = 0
            async for part in response.aiter_raw():
                read += 1
                assert part == CHUNK
                assert app.poured <= read + 6
            return read

    assert asyncio.run(ask()) == 500


def test_an_application_hears_of_a_client_that_closes_early() -> None:
    app = Pouring(chunks=100_000)
    with client_of(app) as client:
        with client.stream("GET", "/") as response:
            next(response.iter_raw())
        assert app.gone.wait(20)
        assert app.poured < 100
        # The transport is of use afterwards.
        with client.stream("GET", "/") as response:
            assert response.status_code == 200


def test_an_application_hears_of_a_client_that_closes_early_in_an_event_loop() -> None:
    app = Pouring(chunks=100_000)

    async def ask() -> None:
        async with async_client_of(app) as client:
            async with client.stream("GET", "/") as response:
                await anext(response.aiter_raw())
            while not app.gone.is_set():
                await asyncio.sleep(0.01)

    asyncio.run(asyncio.wait_for(ask(), 20))
    assert app.poured < 100


def test_an_endless_application_that_does_not_listen_is_cancelled_by_closing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("drivora_service.client.transport._LEAVE_S", 0.2)
    ended = threading.Event()

    async def endless(scope: Any, receive: Receive, send: Send) -> None:
        await begin(send)
        try:
            while True:
                await body(send, CHUNK, more=True)
        finally:
            ended.set()

    app = Small(endless)
    with client_of(app) as client, client.stream("GET", "/") as response:
        next(response.iter_raw())
    assert ended.is_set()
    assert app.events[-1] == "shutdown"


def test_both_bodies_stream_at_once() -> None:
    """More than both buffers hold: it would never end if one body waited for the other."""
    given = itertools.count()

    def parts() -> Iterator[bytes]:
        for number in itertools.islice(given, 200):
            yield b"%06d" % number + CHUNK

    with client_of(Small(echo)) as client:
        with client.stream("POST", "/", content=parts()) as response:
            answered = response.iter_raw()
            first = next(answered)
            assert first.startswith(b"000000")
            assert next(given) < 50
            rest = b"".join(answered)
        assert len(first) + len(rest) == 200 * (len(CHUNK) + 6)


def test_both_bodies_stream_at_once_in_an_event_loop() -> None:
    async def parts() -> AsyncIterator[bytes]:
        for number in range(200):
            yield b"%06d" % number + CHUNK

    async def ask() -> int:
        async with (
            async_client_of(Small(echo)) as client,
            client.stream("POST", "/", content=parts()) as response,
        ):
            return sum([len(part) async for part in response.aiter_raw()])

    assert asyncio.run(ask()) == 200 * (len(CHUNK) + 6)


def test_an_application_that_does_not_read_on_may_answer() -> None:
    def parts() -> Iterator[bytes]:
        for _ in range(200):
            yield CHUNK

    with client_of(Small(hello)) as client:
        assert client.post("/", content=parts()).text == "hello"


def test_an_error_of_the_body_is_raised_and_the_application_hears_of_it() -> None:
    async def read(scope: Any, receive: Receive, send: Send) -> None:
        while (await receive())["type"] != "http.disconnect":
            pass

    def parts() -> Iterator[bytes]:
        yield b"one"
        raise LookupError("no more")

    app = Small(read)
    with client_of(app) as client:
        with pytest.raises(LookupError, match="no more"):
            client.post("/", content=parts())
        eventually(lambda: app.messages[-1]["type"] == "http.disconnect")
    assert [message["type"] for message in app.messages] == ["http.request", "http.disconnect"]


def test_what_an_application_raises_before_its_answer_is_raised() -> None:
    async def fail(scope: Any, receive: Receive, send: Send) -> None:
        raise StoreError("no such table") from OSError("gone")

    with client_of(Small(fail)) as client:
        with pytest.raises(StoreError, match="no such table") as raised:
            client.get("/")
        assert isinstance(raised.value.__cause__, OSError)


def test_an_application_that_ends_without_an_answer_is_an_error() -> None:
    async def nothing(scope: Any, receive: Receive, send: Send) -> None:
        return

    with client_of(Small(nothing)) as client, pytest.raises(httpx.RemoteProtocolError):
        client.get("/")


def test_an_answer_that_breaks_off_is_an_error() -> None:
    async def break_off(scope: Any, receive: Receive, send: Send) -> None:
        await begin(send)
        await body(send, b"half", more=True)
        raise StoreError("gone")

    with client_of(Small(break_off)) as client:
        with pytest.raises(httpx.RemoteProtocolError) as raised:
            client.get("/")
        assert isinstance(raised.value.__cause__, StoreError)


def test_what_comes_after_the_answer_does_not_hold_it_up() -> None:
    may_end, done = threading.Event(), threading.Event()

    async def go_on(scope: Any, receive: Receive, send: Send) -> None:
        await hello(scope, receive, send)
        await asyncio.to_thread(may_end.wait)
        done.set()

    with client_of(Small(go_on)) as client:
        assert client.get("/").text == "hello"
        may_end.set()
    assert done.is_set()


def test_the_read_timeout_is_kept() -> None:
    async def silent(scope: Any, receive: Receive, send: Send) -> None:
        if scope["path"] == "/half":
            await begin(send)
            await body(send, b"half", more=True)
        while (await receive())["type"] != "http.disconnect":
            pass

    with client_of(Small(silent), timeout=0.2) as client:
        for path in ("/", "/half"):
            with pytest.raises(httpx.ReadTimeout):
                client.get(path)


def test_the_write_timeout_is_kept() -> None:
    async def deaf(scope: Any, receive: Receive, send: Send) -> None:
        await asyncio.sleep(30)

    def parts() -> Iterator[bytes]:
        for _ in range(200):
            yield CHUNK

    with client_of(Small(deaf), timeout=httpx.Timeout(None, write=0.2)) as client:
        with pytest.raises(httpx.WriteTimeout):
            client.post("/", content=parts())
        client.close()


def test_the_startup_may_take_longer_than_any_timeout() -> None:
    class Slow(Small):
        async def live(self, scope: Any, receive: Receive, send: Send) -> None:
            await asyncio.sleep(0.5)
            await super().live(scope, receive, send)

    with client_of(Slow(hello), timeout=0.2) as client:
        assert client.get("/").text == "hello"


def test_many_threads_use_one_client_at_once() -> None:
    waiting: list[str] = []

    async def meet(scope: Any, receive: Receive, send: Send) -> None:
        waiting.append(scope["path"])
        while len(waiting) < 8:
            await asyncio.sleep(0.01)
        await begin(send)
        await body(send, scope["path"].encode())

    app = Small(meet)
    with client_of(app, timeout=60) as client, ThreadPoolExecutor(8) as pool:
        paths = [f"/{number}" for number in range(8)]
        assert list(pool.map(lambda path: client.get(path).text, paths)) == paths
    assert app.events.count("startup") == 1


def test_a_transport_that_was_closed_is_of_no_use() -> None:
    transport = ApplicationTransport(Small(hello))
    transport.close()
    with pytest.raises(ServiceError, match="stopped"):
        transport.handle_request(httpx.Request("GET", "http://127.0.0.1/"))


def test_an_answer_cannot_be_read_on_after_closing() -> None:
    app = Pouring(chunks=100_000)
    with client_of(app) as client:
        response = client.send(client.build_request("GET", "/"), stream=True)
        parts = response.iter_raw()
        next(parts)
    with pytest.raises(ServiceError, match="stopped"):
        for _ in parts:
            pass
    assert app.events[-1] == "shutdown"


def test_a_client_may_be_closed_twice() -> None:
    app = Small(hello)
    transport = ApplicationTransport(app)
    transport.handle_request(httpx.Request("GET", "http://127.0.0.1/")).close()
    transport.close()
    transport.close()
    assert app.events.count("shutdown") == 1
