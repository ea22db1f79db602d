"""What changes, read once for all streams of events."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Hashable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, TypeVar

import structlog

from drivora_service.api.answers.worker_view import workers_now
from drivora_service.api.problem_details import ApiError
from drivora_service.api.schemas.workers import Workers
from drivora_service.errors import StoreDamaged, StoreError
from drivora_service.fault_log import FaultLog
from drivora_service.store.campaigns.study_records import state_of
from drivora_service.store.changes.change_lists import ChangedKind, ChangeList
from drivora_service.store.changes.revisions import Position

if TYPE_CHECKING:
    from fastapi import FastAPI

    from drivora_service.api.context import ApiContext
    from drivora_service.store.database import Database, Transaction

MOST_STREAMS = 256
"""Streams at once. A page has one for all its tabs."""
_LOOK_S = 0.1
"""Seconds between two looks at the database's counter, which take some microseconds."""
_BLIND_S = 0.5
"""The same where there is no counter: each look is a query."""
MOST_KEPT = 256
"""Lists and frames that are kept for streams that are in step, each."""
WORKERS_S = 1.0
"""Seconds between two looks at the workers, while a stream tells of them."""
_RETRY_AFTER_S = "5"

T = TypeVar("T")

_log = structlog.get_logger(__name__)


def feed_of(api: FastAPI) -> ChangeFeed:
    """Returns the feed of an application, which is made when it is first asked for."""
    feed: ChangeFeed | None = getattr(api.state, "changes", None)
    if feed is None:
        context: ApiContext = api.state.context
        feed = api.state.changes = ChangeFeed(
            lambda: context.database,
            context.revision,
            partial(_study_state, context),
            partial(workers_now, context),
        )
    return feed


class ChangeFeed:
    """Follows the count of changes, and reads the changes for streams that are in step together.

    It reads in a thread of its own, and only while there are streams. Use it in one event loop.

    Attributes:
        newest: Position of the newest change that has been seen; ``None`` before the first look.
        moved: Set, and replaced, when ``newest`` changes or the feed is closed.
        is_closed: Whether streams are to end.
    """

    def __init__(
        self,
        opened: Callable[[], Database],
        version: Callable[[], int | None],
        study_state: Callable[[Transaction, str], str],
        workers: Callable[[Transaction], Workers],
        *,
        most: int = MOST_STREAMS,
    ) -> None:
        """Creates the feed; nothing is read before the first stream.

        Args:
            opened: Returns the database.
            version: Returns another number after each change of the database, without waiting;
                ``None`` where it cannot be told.
            study_state: Returns the state of a study.
            workers: Returns what the workers do.
            most: Streams at once.
        """
        self._opened, self._version = opened, version
        self._study_state, self._look_at_workers = study_state, workers
        self._workers: asyncio.Future[Workers] | None = None
        self._workers_at = 0.0
        self._most, self._streams = most, 0
        self._reader = ThreadPoolExecutor(max_workers=1, thread_name_prefix="events")
        self._task: asyncio.Task[None] | None = None
        self._lists: dict[Hashable, asyncio.Future[ChangeList]] = {}
        self._frames: dict[Hashable, bytes] = {}
        self._faults = FaultLog(_log)
        self.newest: Position | None = None
        self.moved = asyncio.Event()
        self.is_closed = False

    def join(self) -> None:
        """Counts a stream in; it must :meth:`leave`.

        Raises:
            ApiError: There are too many, or the service is being stopped (503).
        """
        if self.is_closed:
            raise _refusal("the service is being stopped")
        if self._streams >= self._most:
            raise _refusal(
                f"{self._most} streams of events are open, and no more are served: close some"
            )
        self._streams += 1
        if self._task is None:
            self._task = asyncio.create_task(self._follow())

    def leave(self) -> None:
        """Counts a stream out."""
        self._streams -= 1
        if not self._streams and self._task is not None:
            self._task.cancel()
            self._task, self.newest = None, None
            self._lists.clear()
            self._frames.clear()

    def close(self) -> None:
        """Ends all streams; called in the event loop."""
        self.is_closed = True
        if self._task is not None:
            self._task.cancel()
        self._reader.shutdown(wait=False)
        self._wake()

    async def read(self, act: Callable[[Transaction], T]) -> T:
        """Reads in the feed's thread.

        Raises:
            ApiError: The service is being stopped (503).
            StoreError: The database cannot be used.
        """
        if self.is_closed:
            raise _refusal("the service is being stopped")
        return await asyncio.get_running_loop().run_in_executor(
            self._reader, partial(self._in_transaction, act)
        )

    async def changes(self, after: int, kinds: frozenset[ChangedKind]) -> ChangeList:
        """Returns what has changed after a revision, up to the newest change that has been seen.

        Raises:
            StoreError: The database cannot be used.
        """
        key = after, kinds
        found = self._lists.get(key)
        if found is None:
            _make_room(self._lists)
            act = partial(self._changes, after=after, kinds=kinds, until=self.newest)
            found = self._lists[key] = asyncio.ensure_future(self.read(act))
        try:
            # Others may wait for the same list.
            return await asyncio.shield(found)
        except StoreError:
            if self._lists.get(key) is found:
                del self._lists[key]
            raise

    async def workers(self) -> Workers:
        """Returns what the workers do, as of less than a second ago.

        Raises:
            StoreError: The database cannot be used.
        """
        now = time.monotonic()
        if self._workers is None or now - self._workers_at >= WORKERS_S:
            self._workers_at = now
            self._workers = asyncio.ensure_future(self.read(self._look_at_workers))
        return await asyncio.shield(self._workers)

    def frame(self, key: Hashable, write: Callable[[], bytes]) -> bytes:
        """Returns what ``write`` makes, which is made once for equal keys until more changes."""
        if key not in self._frames:
            _make_room(self._frames)
            self._frames[key] = write()
        return self._frames[key]

    def _changes(
        self,
        transaction: Transaction,
        *,
        after: int,
        kinds: frozenset[ChangedKind],
        until: Position | None,
    ) -> ChangeList:
        listed = transaction.changes.after(after, kinds, until=until)
        changes = tuple(
            replace(change, status=self._study_state(transaction, change.id))
            if change.kind is ChangedKind.STUDY
            else change
            for change in listed.changes
        )
        return replace(listed, changes=changes)

    def _in_transaction(self, act: Callable[[Transaction], T]) -> T:
        with self._opened().read() as transaction:
            return act(transaction)

    async def _follow(self) -> None:
        """Looks whether something has changed, until it is cancelled."""
        seen: int | None = None
        while True:
            version = self._version()
            if version is None or version != seen:
                try:
                    # The counter was read before, so that no change is overlooked.
                    self._advance(await self.read(lambda transaction: transaction.changes.latest()))
                    seen = version
                except StoreDamaged:
                    # Known and reported; streams stay open without changes.
                    seen = version
                except Exception as error:
                    # Whatever it is: streams would stay open and never tell a change again.
                    self._faults.error("changes_cannot_be_read", error=str(error))
            await asyncio.sleep(_BLIND_S if version is None else _LOOK_S)

    def _advance(self, newest: Position) -> None:
        if newest != self.newest:
            self.newest = newest
            self._wake()

    def _wake(self) -> None:
        self._lists.clear()
        self._frames.clear()
        moved, self.moved = self.moved, asyncio.Event()
        moved.set()


def _refusal(detail: str) -> ApiError:
    return ApiError(
        HTTPStatus.SERVICE_UNAVAILABLE,
        f"{detail}; try again in {_RETRY_AFTER_S} s",
        headers={"Retry-After": _RETRY_AFTER_S},
    )


def _make_room(kept: dict[Hashable, Any]) -> None:
    """Removes the oldest where there are many: clients come with positions of their own."""
    while len(kept) >= MOST_KEPT:
        del kept[next(iter(kept))]


def _study_state(context: ApiContext, transaction: Transaction, study_id: str) -> str:
    # Asked before the campaigns are read: a process lets go of a study after its last campaign.
    has_process = context.studies.has_process(study_id)
    return state_of(transaction.studies.get(study_id), has_process=has_process).value
