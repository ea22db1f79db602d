"""The asynchronous client behind the methods of the synchronous one, for tests of both."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Iterator
from typing import Any, cast

from drivora_service.client import AsyncClient, Client


class _Blocking:
    """Runs every coroutine of a client in an event loop of its own."""

    def __init__(self, make: Callable[[], AsyncClient]) -> None:
        self._runner = asyncio.Runner()
        self._client = make()

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._client, name)

        def call(*arguments: Any, **options: Any) -> Any:
            result = method(*arguments, **options)
            if isinstance(result, AsyncIterator):
                return self._iterated(result)
            assert inspect.isawaitable(result)
            return self._runner.run(_awaited(result))

        return call

    def _iterated(self, items: AsyncIterator[Any]) -> Iterator[Any]:
        end = object()
        try:
            while (item := self._runner.run(_awaited(anext(items, end)))) is not end:
                yield item
        finally:
            if isinstance(items, AsyncGenerator):
                self._runner.run(items.aclose())

    def close(self) -> None:
        self._runner.run(self._client.aclose())
        self._runner.close()


async def _awaited(result: Any) -> Any:
    return await result


def blocking(make: Callable[[], AsyncClient]) -> Client:
    """Returns an asynchronous client whose methods wait, as those of the synchronous one do."""
    return cast("Client", _Blocking(make))
