"""Transports of httpx that speak to an ASGI application in the same process.

Unlike httpx's own, they start and stop the application, stream both bodies with bounded buffers,
and have a synchronous side.
"""

from __future__ import annotations

import asyncio
import atexit
import contextlib
import threading
from collections.abc import AsyncIterator, Coroutine, Iterator
from concurrent.futures import Future, wait
from typing import Any, TypeVar

import anyio
import httpx
from anyio.from_thread import start_blocking_portal

from drivora_service.client.http_exchange import Exchange
from drivora_service.client.lifespan import STOPPED, Application, Lifespan
from drivora_service.errors import ServiceError

_LEAVE_S = 5.0
"""For requests that go on when the transport is closed; they are cancelled then."""

T = TypeVar("T")


class AsyncApplicationTransport(httpx.AsyncBaseTransport):
    """Speaks to an application in the event loop of its requests.

    The application starts with the first request and is shut down by closing, in one event loop.
    What it raises before its answer has begun is raised as it is. Of the timeouts, ``read`` and
    ``write`` count; the startup may take as long as it needs.
    """

    def __init__(self, app: Application) -> None:
        """Creates the transport; the application is not called before the first request."""
        self._app = app
        self._lifespan = Lifespan(app)
        self._open: dict[asyncio.Task[None], Exchange] = {}

    async def handle_async_request(self, request: httpx.Request) -> httpx.Response:
        """Calls the application; the body of the answer is read from the response."""
        exchange, status, headers = await self.exchange(request)
        return httpx.Response(
            status, headers=headers, stream=_AsyncBody(exchange), extensions=_EXTENSIONS
        )

    async def exchange(
        self, request: httpx.Request
    ) -> tuple[Exchange, int, list[tuple[bytes, bytes]]]:
        """Has the application begin an answer; returns it with its status and headers."""
        await self._lifespan.start()
        exchange = Exchange(self._app, request, self._lifespan.state)
        task = exchange.begin()
        self._open[task] = exchange
        task.add_done_callback(self._open.pop)
        try:
            status, headers = await exchange.head()
        except BaseException:
            exchange.disconnect()
            raise
        return exchange, status, headers

    async def aclose(self) -> None:
        """Cancels pending requests and shuts the application down, even if cancelled meanwhile.

        Raises:
            Exception: The application raised it at its shutdown.
        """
        closing = asyncio.ensure_future(self._close())
        cancelled: asyncio.CancelledError | None = None
        while not closing.done():
            try:
                await asyncio.wait([closing])
            except asyncio.CancelledError as error:
                cancelled = error
        closing.result()
        if cancelled is not None:
            raise cancelled

    async def _close(self) -> None:
        open_exchanges = dict(self._open)
        for exchange in open_exchanges.values():
            exchange.disconnect()
        if open_exchanges:
            _, late = await asyncio.wait(open_exchanges, timeout=_LEAVE_S)
            for task in late:
                task.cancel()
            if late:
                await asyncio.wait(late)
        await self._lifespan.stop()


class ApplicationTransport(httpx.BaseTransport):
    """Speaks to an application in an event loop of its own, in a thread; for any threads.

    See :class:`AsyncApplicationTransport`. The thread lives from the first request to the closing.
    """

    def __init__(self, app: Application) -> None:
        """Creates the transport; the application is not called before the first request."""
        self._inner = AsyncApplicationTransport(app)
        self._lock = threading.Lock()
        self._stack = contextlib.ExitStack()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._closing: asyncio.Future[None] | None = None
        self._closed: Future[None] = Future()
        self._is_closed = False

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """Calls the application; the body of the answer is read from the response."""
        stream = request.stream
        if isinstance(stream, httpx.SyncByteStream) and not isinstance(stream, httpx.ByteStream):
            stream = _InThreads(stream)
        inner = httpx.Request(
            request.method,
            request.url,
            headers=request.headers,
            stream=stream,
            extensions=request.extensions,
        )
        loop = self._ensure_loop()
        exchange, status, headers = _call(loop, self._inner.exchange(inner))
        return httpx.Response(
            status, headers=headers, stream=_Body(loop, exchange), extensions=_EXTENSIONS
        )

    def close(self) -> None:
        """Cancels pending requests and shuts the application down.

        An interrupt waits until that is done.

        Raises:
            Exception: The application raised it at its shutdown.
        """
        interrupt: KeyboardInterrupt | None = None
        while not self._closed.done():
            try:
                with self._lock:
                    self._is_closed = True
                    if self._loop is None:
                        break
                    # Again after an interrupt, which may have come before this had an effect.
                    self._loop.call_soon_threadsafe(self._begin_closing)
                wait([self._closed])
            except KeyboardInterrupt as error:
                interrupt = error
        atexit.unregister(self.close)
        with self._stack:
            if self._closed.done():
                self._closed.result()
            if interrupt is not None:
                raise interrupt

    def _begin_closing(self) -> None:
        """Closes the application, in its event loop, unless that has begun."""
        if self._closing is None:
            self._closing = asyncio.ensure_future(self._inner.aclose())
            self._closing.add_done_callback(self._tell_closed)

    def _tell_closed(self, closing: asyncio.Future[None]) -> None:
        if closing.cancelled():
            self._closed.cancel()
        elif (error := closing.exception()) is not None:
            self._closed.set_exception(error)
        else:
            self._closed.set_result(None)

    def _ensure_loop(self) -> asyncio.AbstractEventLoop:
        with self._lock:
            if self._is_closed:
                raise ServiceError(STOPPED)
            if self._loop is None:
                portal = self._stack.enter_context(start_blocking_portal(name="application"))
                self._loop = portal.call(asyncio.get_running_loop)
                # An interpreter that ends freezes the thread, which could not be stopped any more.
                atexit.register(self.close)
            return self._loop


class _AsyncBody(httpx.AsyncByteStream):
    """The body of an answer, in the application's event loop."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange

    async def __aiter__(self) -> AsyncIterator[bytes]:
        while (part := await self._exchange.chunk()) is not None:
            yield part

    async def aclose(self) -> None:
        """Tells the application that the client is gone."""
        self._exchange.disconnect()


class _Body(httpx.SyncByteStream):
    """The body of an answer, in the thread of the client."""

    def __init__(self, loop: asyncio.AbstractEventLoop, exchange: Exchange) -> None:
        self._loop, self._exchange = loop, exchange

    def __iter__(self) -> Iterator[bytes]:
        while (part := _call(self._loop, self._exchange.chunk())) is not None:
            yield part

    def close(self) -> None:
        """Tells the application that the client is gone."""
        # The event loop of a transport that was closed has told it.
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._exchange.disconnect)


class _InThreads(httpx.AsyncByteStream):
    """The body of a synchronous request, read in threads, as reading it may take its time."""

    def __init__(self, stream: httpx.SyncByteStream) -> None:
        self._stream = stream

    async def __aiter__(self) -> AsyncIterator[bytes]:
        parts = iter(self._stream)
        while (part := await anyio.to_thread.run_sync(next, parts, None)) is not None:
            yield part


_EXTENSIONS = {"http_version": b"HTTP/1.1"}


def _call(loop: asyncio.AbstractEventLoop, coroutine: Coroutine[Any, Any, T]) -> T:
    """Runs a coroutine in the event loop of another thread; an interrupt cancels it there."""
    try:
        future = asyncio.run_coroutine_threadsafe(coroutine, loop)
    except RuntimeError as error:
        coroutine.close()
        raise ServiceError(STOPPED) from error
    try:
        return future.result()
    except BaseException:
        future.cancel()
        raise
