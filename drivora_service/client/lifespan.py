"""The life of an ASGI application in the same process: its startup and its shutdown."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

from drivora_service.errors import ServiceError

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[MutableMapping[str, Any], Receive, Send], Awaitable[None]]
"""An ASGI 3 application."""

STOPPED = "the application in this process was stopped"

ASGI = {"version": "3.0", "spec_version": "2.3"}


class Lifespan:
    """Starts an application once and stops it once, in the event loop of the first request.

    An application that returns from the lifespan scope at once has no startup; one that raises
    cannot be started.
    """

    def __init__(self, app: Application) -> None:
        """Creates the lifespan; :meth:`start` calls the application."""
        self.state: dict[str, Any] = {}
        self._app = app
        self._task: asyncio.Task[None] | None = None
        self._is_begun, self._ending = asyncio.Event(), asyncio.Event()
        self._is_complete = self._is_told = self._is_stopped = False
        self._message = ""
        self._error: Exception | None = None

    async def start(self) -> None:
        """Starts the application, or waits until it has started.

        Raises:
            Exception: The application raised it at its startup.
            ServiceError: The application is stopped, or says that it cannot start.
        """
        if self._is_stopped:
            raise ServiceError(STOPPED)
        if self._task is None:
            self._task = asyncio.create_task(self._live())
        await self._is_begun.wait()
        if self._error is not None and not self._is_complete:
            raise self._error

    async def stop(self) -> None:
        """Shuts the application down and waits for it; an unfinished startup is cancelled.

        Raises:
            Exception: The application raised it after its startup.
        """
        self._is_stopped = True
        if self._task is None:
            return
        self._ending.set()
        if not self._is_begun.is_set():
            self._task.cancel()
        await asyncio.wait([self._task])
        if self._error is not None and self._is_complete:
            raise self._error

    async def _live(self) -> None:
        scope = {"type": "lifespan", "asgi": ASGI, "state": self.state}
        try:
            await self._app(scope, self._receive, self._send)
            if self._message:
                self._error = ServiceError(f"the application failed: {self._message}")
            elif not self._is_told:
                # It knows no lifespan.
                self._is_complete = True
        except Exception as error:
            self._error = error
        except BaseException as error:
            # Neither an exit nor a cancellation may end the event loop or pass for the caller's.
            self._error = ServiceError("the application was ended at its startup or shutdown")
            self._error.__cause__ = error
        finally:
            self._is_begun.set()

    async def _receive(self) -> Message:
        if not self._is_told:
            self._is_told = True
            return {"type": "lifespan.startup"}
        await self._ending.wait()
        return {"type": "lifespan.shutdown"}

    async def _send(self, message: Message) -> None:
        if message["type"] == "lifespan.startup.complete":
            self._is_complete = True
            self._is_begun.set()
        elif message["type"] in ("lifespan.startup.failed", "lifespan.shutdown.failed"):
            self._message = message.get("message", "") or "it does not say why"
