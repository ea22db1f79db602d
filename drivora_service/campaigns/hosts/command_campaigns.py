"""The campaigns of a command, each in a thread of the command's own process."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import AbstractContextManager

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.hosts.tester_interruption import TesterInterruption
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import run_stored
from drivora_service.campaigns.search.conducting import Watcher
from drivora_service.campaigns.search.tester_calls import CallMemory
from drivora_service.errors import (
    Conflict,
    StoreError,
    StoreUnavailable,
    UnknownName,
    WorkersCannotStart,
)
from drivora_service.store.campaigns.campaign_records import CampaignRequest, CampaignState
from drivora_service.store.database import Database, Transaction

_LOOK_S = 0.1
"""Seconds between two looks whether a campaign has ended, or is left to itself."""


class CommandCampaigns:
    """Runs campaigns until they end; pauses them when the command ends.

    Attributes:
        fault: Why no run can be started, "" while they can.
    """

    def __init__(
        self,
        database: Callable[[], Database],
        folder: Callable[[str], CampaignFolder],
        catalogues: Catalogues,
        evaluator: Callable[[int | None], AbstractContextManager[Evaluator]],
        *,
        on_error: Callable[[BaseException], None],
        memory: CallMemory,
    ) -> None:
        """Creates the host, without campaigns.

        Args:
            database: Returns the database with the campaigns.
            folder: Returns the folder of a campaign.
            catalogues: Catalogues for the names in campaigns.
            evaluator: Returns the evaluator, for the number of workers of a campaign.
            on_error: Called from the thread of a campaign with the error that stopped it, which is
                stored, too, unless the database cannot be used.
            memory: Limit of memory during calls of testers.
        """
        self._database, self._folder, self._catalogues = database, folder, catalogues
        self._evaluator, self._on_error, self._memory = evaluator, on_error, memory
        self._taken: list[str] = []
        self._threads: list[tuple[threading.Thread, TesterInterruption]] = []
        self._closing = threading.Event()
        self.fault = ""

    def open(self, _transaction: Transaction, campaign_id: str) -> None:
        """Accepts a new campaign."""
        self._taken.append(campaign_id)

    def resume(self, campaign_id: str) -> None:
        """Resumes a campaign that is not running.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: It is over, or a process works on it.
            StoreUnavailable: The database cannot be used now.
        """
        self._begin(campaign_id)

    def wake(self) -> None:
        """Starts the accepted campaigns.

        Raises:
            StoreUnavailable: The database cannot be used now.
        """
        while self._taken:
            self._begin(self._taken.pop())

    def close(self) -> None:
        """Pauses the running campaigns, and waits for them, but not for ever for a tester."""
        self._closing.set()
        for thread, interruption in self._threads:
            while not interruption.lets_go(thread):
                thread.join(_LOOK_S)

    def _begin(self, campaign_id: str) -> None:
        """Starts the thread of a campaign; returns once it runs, or is stored as failed."""
        begun: Future[None] = Future()
        interruption = TesterInterruption(
            self._database, campaign_id, self._current_request, self._memory
        )
        thread = threading.Thread(
            target=self._run,
            args=(campaign_id, begun, interruption),
            name=f"campaign {campaign_id}",
            daemon=True,
        )
        self._threads.append((thread, interruption))
        thread.start()
        begun.result()

    def _run(self, campaign_id: str, begun: Future[None], interruption: TesterInterruption) -> None:
        watcher = Watcher(
            requested=self._current_request,
            on_begun=lambda: begun.set_result(None),
            on_call=interruption.on_call,
        )
        try:
            with interruption.watching():
                run_stored(
                    self._database(),
                    campaign_id,
                    self._folder(campaign_id),
                    catalogues=self._catalogues,
                    evaluator=self._evaluator,
                    watcher=watcher,
                )
        except KeyboardInterrupt:
            # Its tester was interrupted, as requested, and the end is stored.
            pass
        except BaseException as error:
            # Whatever it is: without an end of the thread's work, the command would wait for ever.
            if begun.done():
                if isinstance(error, WorkersCannotStart):
                    self.fault = str(error)
                self._on_error(error)
                return
            try:
                self._store_failure(campaign_id, error)
            except BaseException as kept:
                begun.set_exception(kept)
            else:
                begun.set_result(None)
                self._on_error(error)

    def _store_failure(self, campaign_id: str, error: BaseException) -> None:
        """Stores why a campaign has not begun: no other process would begin it, or tell why.

        Raises:
            BaseException: The error, if it is not one of this campaign, or cannot be stored.
        """
        if isinstance(error, Conflict | UnknownName):
            raise error
        message = str(error) or type(error).__name__
        try:
            with self._database().write() as transaction:
                is_over = transaction.campaigns.get(campaign_id).state.is_over
                if not is_over:
                    transaction.campaigns.end(campaign_id, CampaignState.FAILED, message=message)
        except StoreError as unstored:
            raise StoreUnavailable(
                f"campaign {campaign_id} is stored, but has not begun, and can be resumed: {error}"
            ) from unstored
        if is_over:
            raise error

    def _current_request(self) -> CampaignRequest:
        return CampaignRequest.PAUSE if self._closing.is_set() else CampaignRequest.NONE
