"""One client's stream of server-sent events."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from typing import Any

from starlette.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from drivora_service.api.answers.change_feed import WORKERS_S, ChangeFeed
from drivora_service.api.documentation.openapi import EVENTS
from drivora_service.api.schemas.events import Begin, Changes, Reset
from drivora_service.api.schemas.workers import Workers
from drivora_service.errors import StoreError
from drivora_service.shapes import to_json
from drivora_service.store.changes.change_lists import ChangedKind
from drivora_service.store.changes.revisions import Position

HEARTBEAT_S = 15.0
"""Seconds of silence after which a comment is sent, with the position of the stream."""
_CHECK_S = 1.0
"""Seconds between two looks at the token of a stream that tells nothing."""
_FAULT_S = 1.0

HEADERS = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
"""No cache and no proxy may hold events back."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """What a stream tells.

    Attributes:
        kinds: Kinds of objects.
        tells_workers: Whether it tells what the workers do.
        of: Id of the object that they are or belong to; "": all.
        begin: Position after which changes are sent.
        is_reset: Whether the client has seen changes that this database does not know.
    """

    kinds: frozenset[ChangedKind]
    tells_workers: bool
    of: str
    begin: Position
    is_reset: bool


class EventStream(StreamingResponse):
    """An answer that sends what changes until the client goes or the service is stopped.

    A client that reads slowly gets what has changed meanwhile as it is then; nothing is kept for
    it. One that reads nothing is dropped with its connection.
    """

    def __init__(self, feed: ChangeFeed, wanted: Wanted, is_allowed: Callable[[], bool]) -> None:
        """Creates the answer of a stream that has joined the feed; it leaves the feed at its end.

        Args:
            feed: What changes.
            wanted: What of it is sent.
            is_allowed: Returns whether the client's token is still valid. It is asked before
                each event, so it must be cheap.
        """
        super().__init__(_events(feed, wanted, is_allowed), headers=HEADERS, media_type=EVENTS)
        self._feed = feed

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves the request."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._feed.leave()


async def _events(
    feed: ChangeFeed, wanted: Wanted, is_allowed: Callable[[], bool]
) -> AsyncIterator[bytes]:
    position = wanted.begin
    yield _frame("begin", position, Begin, Begin(revision=position.revision))
    if wanted.is_reset:
        yield _frame("reset", position, Reset, Reset(revision=position.revision))
    beat_at = time.monotonic() + HEARTBEAT_S
    workers: Workers | None = None
    while not feed.is_closed:
        found = await _workers(feed) if wanted.tells_workers else None
        if found is not None and (workers is None or _steady(found) != _steady(workers)):
            workers = found
            if not is_allowed():
                return
            yield feed.frame(
                (position, workers), partial(_frame, "workers", position, Workers, workers)
            )
            beat_at = time.monotonic() + HEARTBEAT_S
        moved, newest = feed.moved, feed.newest
        if newest is not None and newest.revision > position.revision:
            after = position.revision
            try:
                listed = await feed.changes(after, wanted.kinds)
            except StoreError:
                await _wait(moved, _FAULT_S)
            else:
                position = listed.position
                told = tuple(c for c in listed.changes if not wanted.of or c.is_of(wanted.of))
                if told:
                    # After the wait for the list: nothing is sent once the token is revoked.
                    if not is_allowed():
                        return
                    changes = Changes(revision=position.revision, changes=told)
                    # With its end: a list that was read before the newest change is shorter.
                    yield feed.frame(
                        (after, position, wanted.kinds, wanted.of),
                        partial(_frame, "changes", position, Changes, changes),
                    )
                    beat_at = time.monotonic() + HEARTBEAT_S
        else:
            longest = min(beat_at - time.monotonic(), _CHECK_S)
            await _wait(moved, min(longest, WORKERS_S) if wanted.tells_workers else longest)
        if not is_allowed():
            return
        if time.monotonic() >= beat_at:
            # An id without data is no event; a client that comes again names it.
            yield f": heartbeat\nid: {position}\n\n".encode()
            beat_at = time.monotonic() + HEARTBEAT_S


def _frame(event: str, position: Position, kind: Any, data: object) -> bytes:
    """Writes an event; JSON has no line breaks of its own."""
    return b"event: %s\nid: %s\ndata: %s\n\n" % (
        event.encode(),
        str(position).encode(),
        to_json(kind, data),
    )


async def _workers(feed: ChangeFeed) -> Workers | None:
    try:
        return await feed.workers()
    except StoreError:
        return None


def _steady(workers: Workers) -> Workers:
    """Returns what the workers do without the time at which they were looked at."""
    return replace(
        workers,
        slots=tuple(replace(slot, updated_at=datetime.min) for slot in workers.slots),
    )


async def _wait(moved: asyncio.Event, seconds: float) -> None:
    try:
        async with asyncio.timeout(max(seconds, 0.0)):
            await moved.wait()
    except TimeoutError:
        pass
