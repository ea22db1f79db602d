"""Answers that are read as they come, one at a time."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Iterator

import httpx

from drivora_service.client.flows import Listen
from drivora_service.client.replies import Reply

_SILENCE_S = 45.0
"""Seconds without a byte after which a stream is taken for broken; the service sends a heartbeat
every 15 s."""


def _timeout(client: httpx.Client | httpx.AsyncClient) -> httpx.Timeout:
    usual = client.timeout
    return httpx.Timeout(connect=usual.connect, write=usual.write, pool=usual.pool, read=_SILENCE_S)


class Stream:
    """The answer that a flow listens to, if any; a context manager that closes it."""

    def __init__(self, client: httpx.Client) -> None:
        """Creates it without an answer; ``client`` sends the requests."""
        self._client = client
        self._open = contextlib.ExitStack()
        self._parts: Iterator[bytes] = iter(())

    def __enter__(self) -> Stream:
        """Returns itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Closes the answer."""
        self._open.close()

    def listen(self, step: Listen) -> Reply:
        """Asks; the body of an answer with 200 is received in parts, others are in the reply.

        Raises:
            RequestError: There is no answer.
        """
        self._open.close()
        call = step.call
        response = self._open.enter_context(
            self._client.stream(
                call.method,
                call.path,
                params=call.parameters,
                headers=step.headers,
                timeout=_timeout(self._client),
            )
        )
        content = b""
        if response.status_code == httpx.codes.OK:
            self._parts = response.iter_bytes()
        else:
            content = response.read()
            self._open.close()
        return Reply(status=response.status_code, headers=response.headers, content=content)

    def receive(self) -> bytes | None:
        """Waits for the next part; ``None``: the body has ended.

        Raises:
            RequestError: It broke off.
        """
        return next(self._parts, None)


class AsyncStream:
    """The same for an asynchronous client."""

    def __init__(self, client: httpx.AsyncClient) -> None:
        """Creates it without an answer; ``client`` sends the requests."""
        self._client = client
        self._open = contextlib.AsyncExitStack()
        self._parts: AsyncIterator[bytes] | None = None

    async def __aenter__(self) -> AsyncStream:
        """Returns itself."""
        return self

    async def __aexit__(self, *_: object) -> None:
        """Closes the answer."""
        await self._open.aclose()

    async def listen(self, step: Listen) -> Reply:
        """Asks, as :meth:`Stream.listen` does.

        Raises:
            RequestError: There is no answer.
        """
        await self._open.aclose()
        call = step.call
        response = await self._open.enter_async_context(
            self._client.stream(
                call.method,
                call.path,
                params=call.parameters,
                headers=step.headers,
                timeout=_timeout(self._client),
            )
        )
        content = b""
        if response.status_code == httpx.codes.OK:
            self._parts = response.aiter_bytes()
        else:
            content = await response.aread()
            await self._open.aclose()
        return Reply(status=response.status_code, headers=response.headers, content=content)

    async def receive(self) -> bytes | None:
        """Waits for the next part; ``None``: the body has ended.

        Raises:
            RequestError: It broke off.
        """
        return None if self._parts is None else await anext(self._parts, None)
