"""A cache of answers, valid until the database changes."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from drivora_service.api.guards.api_tokens import TokenFile
from drivora_service.api.guards.load_guard import EVENTS_PATH, HEALTH_PATHS
from drivora_service.api.guards.page_sessions import SessionFile, session_secret, token_of
from drivora_service.api_paths import PREFIX
from drivora_service.errors import CredentialsUnusable

MOST_BYTES = 64 << 10
"""Of one answer."""
MOST_ANSWERS = 256
LONGEST_S = 0.5
"""For which an answer may be given again; some tell of files, or of how long ago something was."""

_NOT_KEPT = HEALTH_PATHS | {EVENTS_PATH}

_Key = tuple[str, bytes, str, str, str, str, str]


@dataclass(frozen=True, slots=True)
class _Answer:
    """The answer of an operation.

    Attributes:
        messages: Head and body, as ASGI has them.
        route: Route of the operation, by which requests are counted.
        until: Monotonic seconds.
    """

    messages: tuple[Message, ...]
    route: object
    until: float


class _Memory:
    """The answers of one state of the database."""

    def __init__(self, version: int | None) -> None:
        self.version = version
        self.answers: dict[_Key, asyncio.Future[_Answer | None]] = {}


class AnswerMemory:
    """ASGI middleware: repeated requests get the same answer from memory.

    Many clients look at the same lists. An answer holds until the database changes, so that a
    client finds everything that was written before it asked. Requests for the same that come
    at once are answered by one look at the database. Only answers with an ``ETag`` are kept.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        version: Callable[[], int | None],
        tokens: Callable[[], TokenFile | None],
        sessions: SessionFile | None = None,
    ) -> None:
        """Creates the middleware around an application, with an empty memory.

        Args:
            app: What answers.
            version: Returns another number after each change of the database, without waiting;
                ``None`` where it cannot be told: then nothing is kept.
            tokens: Returns the API tokens; ``None`` while no token is needed.
            sessions: Sessions of web pages, if there are any.
        """
        self._app, self._version = app, version
        self._tokens, self._sessions = tokens, sessions
        self._memory = _Memory(None)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        key = self._key(scope)
        version = None if key is None else self._version()
        if key is None or version is None:
            await self._app(scope, receive, send)
            return
        if version != self._memory.version:
            self._memory = _Memory(version)
        known = self._memory.answers.get(key)
        if known is not None and _holds(known):
            answer = await asyncio.shield(known)
            if answer is not None:
                scope["route"] = answer.route
                for message in answer.messages:
                    await send(message)
                return
        await self._make(self._memory, key, scope, receive, send)

    def _key(self, scope: Scope) -> _Key | None:
        """Returns all that an answer depends on, or ``None`` if it is not to be kept."""
        if scope["type"] != "http" or scope["method"] != "GET":
            return None
        if not scope["path"].startswith(PREFIX) or scope["path"] in _NOT_KEPT:
            return None
        headers = Headers(scope=scope)
        if "content-length" in headers or "transfer-encoding" in headers:
            return None
        authorization, session = headers.get("authorization", ""), ""
        tokens = self._tokens()
        if tokens is not None:
            if not _is_known(tokens, self._sessions, headers):
                return None
            session = session_secret(headers)
        known = headers.get("if-none-match", "")
        query: bytes = scope["query_string"]
        form, coding = headers.get("accept", ""), headers.get("accept-encoding", "")
        return scope["path"], query, form, coding, known, authorization, session

    async def _make(
        self, memory: _Memory, key: _Key, scope: Scope, receive: Receive, send: Send
    ) -> None:
        """Calls the application, and keeps its answer for equal requests meanwhile and later."""
        made: asyncio.Future[_Answer | None] = asyncio.get_running_loop().create_future()
        while len(memory.answers) >= MOST_ANSWERS:
            del memory.answers[next(iter(memory.answers))]
        memory.answers[key] = made
        begun = time.monotonic()
        head: Message | None = None

        async def send_and_keep(message: Message) -> None:
            nonlocal head
            if message["type"] == "http.response.start" and _may_be_kept(message):
                # Held back until its body is there: no other shall wait for a slow client.
                head = message
                return
            if head is None:
                give_up()
            else:
                start, head = head, None
                if message.get("more_body", False):
                    give_up()
                else:
                    until = begun + LONGEST_S
                    made.set_result(_Answer((start, message), scope.get("route"), until))
                await send(start)
            await send(message)

        def give_up() -> None:
            """Releases the waiting requests to the application, before this client is served."""
            if not made.done():
                made.set_result(None)
                if memory.answers.get(key) is made:
                    del memory.answers[key]

        try:
            await self._app(scope, receive, send_and_keep)
        finally:
            give_up()


def _is_known(tokens: TokenFile, sessions: SessionFile | None, headers: Headers) -> bool:
    try:
        return token_of(tokens, sessions, headers) is not None
    except CredentialsUnusable:
        # The application tells the client, in the form of all errors.
        return False


def _holds(answer: asyncio.Future[_Answer | None]) -> bool:
    """Whether an answer is still being made, or was made a short while ago."""
    made = answer.result() if answer.done() else None
    return made is None or time.monotonic() < made.until


def _may_be_kept(start: Message) -> bool:
    if start["status"] not in (200, 304):
        return False
    headers = Headers(raw=list(start["headers"]))
    length = headers.get("content-length", "0")
    return "etag" in headers and int(length) <= MOST_BYTES
