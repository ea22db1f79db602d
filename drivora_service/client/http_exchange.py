"""One request to an ASGI application in the same process, and its answer."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, MutableMapping
from typing import Any

import anyio
import httpx
import structlog

from drivora_service.client.lifespan import ASGI, Application, Message

_BUFFERED_CHUNKS = 4
"""Of either body; the sender waits beyond."""

_log = structlog.stdlib.get_logger(__name__)


class Exchange:
    """A request that is being answered. Both bodies are bounded streams.

    Use it in one event loop: :meth:`begin`, :meth:`head`, then :meth:`chunk` until it returns
    ``None``, and :meth:`disconnect` in any case.
    """

    def __init__(self, app: Application, request: httpx.Request, state: dict[str, Any]) -> None:
        """Creates the exchange; :meth:`begin` calls the application.

        Args:
            app: What answers.
            request: Its body is an asynchronous stream.
            state: What the lifespan of the application has left for requests.
        """
        self._app, self._request = app, request
        self._scope = _scope(request, state)
        self._timeouts: dict[str, float | None] = request.extensions.get("timeout", {})
        # The request's body, to the application.
        self._body_in, self._body_out = anyio.create_memory_object_stream[bytes](_BUFFERED_CHUNKS)
        # The answer's body, from the application.
        self._sent, self._received = anyio.create_memory_object_stream[bytes](_BUFFERED_CHUNKS)
        self._is_sent_or_begun, self._is_begun = asyncio.Event(), asyncio.Event()
        self._is_gone = asyncio.Event()
        self._has_read_all = self._is_complete = False
        self._status = 0
        self._headers: list[tuple[bytes, bytes]] = []
        self._error: BaseException | None = None
        self._pump: asyncio.Task[None] | None = None

    def begin(self) -> asyncio.Task[None]:
        """Calls the application with the request; returns the task in which it answers."""
        self._pump = asyncio.create_task(self._send_body())
        self._pump.add_done_callback(lambda _: self._body_in.close())
        return asyncio.create_task(self._answer())

    async def head(self) -> tuple[int, list[tuple[bytes, bytes]]]:
        """Waits until the answer begins.

        Returns:
            Its status and its headers.

        Raises:
            Exception: The application, or the stream of the request's body, raised it.
            TransportError: A timeout, or the application ended without an answer.
        """
        await self._is_sent_or_begun.wait()
        try:
            async with asyncio.timeout(self._timeouts.get("read")):
                await self._is_begun.wait()
        except TimeoutError as error:
            raise self._timeout(httpx.ReadTimeout, "the application did not answer") from error
        if self._status:
            return self._status, self._headers
        if isinstance(self._error, Exception):
            raise self._error
        raise self._make_error("the application ended without an answer")

    async def chunk(self) -> bytes | None:
        """Returns the next part of the answer's body, ``None`` at its end.

        Raises:
            TransportError: A timeout, or the application ended within the answer.
        """
        try:
            async with asyncio.timeout(self._timeouts.get("read")):
                return await self._received.receive()
        except TimeoutError as error:
            raise self._timeout(httpx.ReadTimeout, "the answer did not go on") from error
        except (anyio.EndOfStream, anyio.ClosedResourceError):
            if self._is_complete:
                return None
            raise self._make_error("the application ended within its answer") from self._error

    def disconnect(self) -> None:
        """Tells the application that the client is gone; what it still sends is dropped."""
        self._is_gone.set()
        self._received.close()
        if self._pump is not None:
            self._pump.cancel()

    async def _answer(self) -> None:
        try:
            await self._app(self._scope, self._receive, self._send)
        except BaseException as error:
            if self._is_complete and isinstance(error, Exception):
                _log.warning("application_raised_after_its_answer", exc_info=error)
            self._error = self._error or error
        finally:
            self._is_gone.set()
            self._is_sent_or_begun.set()
            self._is_begun.set()
            self._sent.close()
            self._body_out.close()

    async def _receive(self) -> Message:
        if not self._has_read_all:
            try:
                chunk = await self._body_out.receive()
            except (anyio.EndOfStream, anyio.ClosedResourceError):
                self._has_read_all = True
                if not self._is_gone.is_set():
                    return {"type": "http.request", "body": b"", "more_body": False}
            else:
                return {"type": "http.request", "body": chunk, "more_body": True}
        await self._is_gone.wait()
        return {"type": "http.disconnect"}

    async def _send(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            if self._status:
                raise RuntimeError("the application began its answer twice")
            self._headers = [(bytes(name), bytes(value)) for name, value in message["headers"]]
            self._status = message["status"]
            self._is_sent_or_begun.set()
            self._is_begun.set()
        elif message["type"] == "http.response.body":
            if not self._status or self._is_complete:
                raise RuntimeError("the application sent a body outside of its answer")
            await self._send_part(bytes(message.get("body", b"")))
            if not message.get("more_body", False):
                self._is_complete = True
                self._sent.close()
                self._is_gone.set()

    async def _send_part(self, part: bytes) -> None:
        if not part or self._request.method == "HEAD":
            return
        try:
            await self._sent.send(part)
        except anyio.BrokenResourceError:
            # The client is gone, which `receive` tells. Others shall get their turn meanwhile.
            await asyncio.sleep(0)

    async def _send_body(self) -> None:
        """Hands the request's body to the application, as fast as that reads."""
        try:
            async for part in _parts(self._request):
                try:
                    async with asyncio.timeout(self._timeouts.get("write")):
                        await self._body_in.send(part)
                except TimeoutError as error:
                    message = "the application did not read the request"
                    raise self._timeout(httpx.WriteTimeout, message) from error
        except anyio.BrokenResourceError:
            # The application has ended, or has answered without reading on.
            pass
        except Exception as error:
            self._error = error
            self._is_gone.set()
            self._is_begun.set()
        finally:
            self._is_sent_or_begun.set()

    def _make_error(self, message: str) -> httpx.TransportError:
        return httpx.RemoteProtocolError(message, request=self._request)

    def _timeout(self, kind: type[httpx.TimeoutException], message: str) -> httpx.TimeoutException:
        return kind(f"{message} in time", request=self._request)


async def _parts(request: httpx.Request) -> AsyncIterator[bytes]:
    if not isinstance(request.stream, httpx.AsyncByteStream):
        raise TypeError("the body of an asynchronous request must be an asynchronous stream")
    async for part in request.stream:
        if part:
            yield part


def _scope(request: httpx.Request, state: dict[str, Any]) -> MutableMapping[str, Any]:
    url = request.url
    return {
        "type": "http",
        "asgi": ASGI,
        "http_version": "1.1",
        "method": request.method,
        "scheme": url.scheme,
        "path": url.path,
        "raw_path": url.raw_path.partition(b"?")[0],
        "query_string": url.query,
        "root_path": "",
        "headers": [(name.lower(), value) for name, value in request.headers.raw],
        "client": ("127.0.0.1", 0),
        "server": (url.host, url.port or {"https": 443}.get(url.scheme, 80)),
        "state": dict(state),
    }
