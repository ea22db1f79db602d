"""The campaigns of a command: each in a thread of the command's own process."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import AbstractContextManager

from drivora_service.campaigns.catalogues import Catalogues
from drivora_service.campaigns.conducting import Watcher
from drivora_service.campaigns.evaluator import Evaluator
from drivora_service.campaigns.folder import CampaignFolder
from drivora_service.campaigns.stored import run_stored
from drivora_service.errors import DrivoraError, WorkersCannotStart
from drivora_service.store.campaign_records import CampaignRequest
from drivora_service.store.database import Database, Transaction


class CommandCampaigns:
    """Runs campaigns until they end, or the command does: then they pause.

    Attributes:
        fault: Why no run can be begun, "" while they can.
    """

    def __init__(
        self,
        database: Database,
        folder: Callable[[str], CampaignFolder],
        catalogues: Catalogues,
        evaluator: Callable[[int | None], AbstractContextManager[Evaluator]],
        *,
        on_error: Callable[[DrivoraError], None],
    ) -> None:
        """Begins with none.

        Args:
            database: Holds the campaigns.
            folder: Returns the folder of a campaign.
            catalogues: Where the names in campaigns are looked up.
            evaluator: Returns what evaluates, for the number of workers that a campaign wants.
            on_error: Told, from the thread of a campaign, why it cannot go on; the store says so
                as well.
        """
        self._database, self._folder, self._catalogues = database, folder, catalogues
        self._evaluator, self._on_error = evaluator, on_error
        self._taken: list[str] = []
        self._threads: list[threading.Thread] = []
        self._closing = threading.Event()
        self.fault = ""

    def open(self, _transaction: Transaction, campaign_id: str) -> None:
        """Takes a campaign that was just made."""
        self._taken.append(campaign_id)

    def resume(self, campaign_id: str) -> None:
        """Goes on with a campaign that rests.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: It is over, or a process works on it.
        """
        self._begin(campaign_id)

    def wake(self) -> None:
        """Begins with the campaigns that were taken."""
        while self._taken:
            self._begin(self._taken.pop())

    def close(self) -> None:
        """Pauses what runs, and waits for it."""
        self._closing.set()
        for thread in self._threads:
            thread.join()

    def _begin(self, campaign_id: str) -> None:
        """Starts the thread of a campaign, and returns once the campaign runs or cannot."""
        begun: Future[None] = Future()
        thread = threading.Thread(
            target=self._run, args=(campaign_id, begun), name=f"campaign {campaign_id}"
        )
        self._threads.append(thread)
        thread.start()
        begun.result()

    def _run(self, campaign_id: str, begun: Future[None]) -> None:
        watcher = Watcher(requested=self._requested, on_begun=lambda: begun.set_result(None))
        try:
            run_stored(
                self._database,
                campaign_id,
                self._folder(campaign_id),
                catalogues=self._catalogues,
                evaluator=self._evaluator,
                watcher=watcher,
            )
        except DrivoraError as error:
            if not begun.done():
                begun.set_exception(error)
                return
            if isinstance(error, WorkersCannotStart):
                self.fault = str(error)
            self._on_error(error)

    def _requested(self) -> CampaignRequest:
        return CampaignRequest.PAUSE if self._closing.is_set() else CampaignRequest.NONE
