"""The studies of a command: campaigns in threads of its process that share one pool of workers."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass

from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.evaluation.shared_pool import SharedPool
from drivora_service.campaigns.hosts.tester_interruption import TesterInterruption
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.campaigns.records.stored_campaigns import run_stored
from drivora_service.campaigns.search.conducting import Watcher
from drivora_service.campaigns.search.tester_calls import CallMemory
from drivora_service.errors import Conflict, StoreError, WorkersCannotStart
from drivora_service.store.campaigns.campaign_records import CampaignRequest
from drivora_service.store.database import Database, Transaction
from drivora_service.store.locks.work_locks import LongWork
from drivora_service.studies.study_storing import NOT_OVER, refuse_if_over

_LOOK_S = 0.05
"""Seconds between two looks whether another campaign is needed to keep the workers busy."""
_REQUEST_S = 0.5
"""Seconds between two looks for a request to the study."""

PAUSE, NONE = CampaignRequest.PAUSE, CampaignRequest.NONE


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandSetup:
    """What the studies of a command are run with.

    Attributes:
        database: Returns the database with the studies.
        campaign_folder: Returns the folder of a campaign.
        catalogues: Catalogues for the names in campaigns.
        pool: Returns the workers, for the number that a study wants.
        on_error: Called from a thread with the error that stopped a campaign, or the study.
        memory: Limit of memory during calls of testers.
    """

    database: Callable[[], Database]
    campaign_folder: Callable[[str], CampaignFolder]
    catalogues: Catalogues
    pool: Callable[[int | None], AbstractContextManager[SharedPool]]
    on_error: Callable[[BaseException], None]
    memory: CallMemory


class CommandStudies:
    """Runs studies until they end; pauses their campaigns when the command ends.

    Attributes:
        fault: Why no run can be started, "" while they can.
    """

    def __init__(self, setup: CommandSetup) -> None:
        """Creates the host, without studies."""
        self._setup = setup
        self._taken: list[str] = []
        self._threads: list[threading.Thread] = []
        self._closing = threading.Event()
        self.fault = ""

    def open(self, _transaction: Transaction, study_id: str, _campaigns: Sequence[str]) -> None:
        """Accepts a new study."""
        self._taken.append(study_id)

    def resume(self, study_id: str) -> None:
        """Resumes a study that is not running.

        Raises:
            UnknownName: There is no such study.
            Conflict: All its campaigns are over, or a process works on it.
            StoreError: The database cannot be used.
        """
        self._begin(study_id)

    def has_process(self, study_id: str) -> bool:
        """Returns whether the process of a command runs a study."""
        return self._setup.database().locks.is_held(LongWork.study(study_id))

    def wake(self) -> None:
        """Starts the accepted studies.

        Raises:
            StoreError: The database cannot be used.
        """
        while self._taken:
            self._begin(self._taken.pop())

    def close(self) -> None:
        """Pauses the running campaigns, and waits for them."""
        self._closing.set()
        for thread in self._threads:
            thread.join()

    def _begin(self, study_id: str) -> None:
        begun: Future[None] = Future()
        thread = threading.Thread(
            target=self._run, args=(study_id, begun), name=f"study {study_id}"
        )
        self._threads.append(thread)
        thread.start()
        begun.result()

    def _run(self, study_id: str, begun: Future[None]) -> None:
        setup = self._setup
        try:
            database = setup.database()
            lock = database.locks.hold(LongWork.study(study_id))
            try:
                with database.write() as transaction:
                    refuse_if_over(transaction, study_id)
                    transaction.studies.ask_for(study_id, NONE)
                    record = transaction.studies.get(study_id)
                begun.set_result(None)
                with setup.pool(record.document.get("workers")) as pool:
                    _Work(setup, database, study_id, pool, self._closing).run()
                    self.fault = pool.fault
            finally:
                lock.release()
        except BaseException as error:
            # Whatever it is: without an end of the thread's work, the command would wait for ever.
            if begun.done():
                setup.on_error(error)
            else:
                begun.set_exception(error)


class _Work:
    """The work on one study.

    As many campaigns run at once as keep the workers busy: another one begins when no run waits
    for a worker. So one campaign after the other is completed, and none holds up the workers while
    its tester thinks or waits for its last results.
    """

    def __init__(
        self,
        setup: CommandSetup,
        database: Database,
        study_id: str,
        pool: SharedPool,
        closing_down: threading.Event,
    ) -> None:
        self._setup, self._database, self._study_id = setup, database, study_id
        self._pool, self._closing = pool, closing_down
        self._stopped = threading.Event()
        self._request = PAUSE
        self._ended = threading.Event()
        with database.read() as transaction:
            ids = transaction.studies.campaign_ids(study_id, NOT_OVER)
        self._coming = deque(ids)
        self._threads: list[tuple[threading.Thread, TesterInterruption]] = []

    def run(self) -> None:
        """Runs until all campaigns have ended, or a stop is requested."""
        looked = 0.0
        try:
            while True:
                self._threads = [(one, watch) for one, watch in self._threads if one.is_alive()]
                if looked >= _REQUEST_S:
                    looked = 0.0
                    self._look_for_request()
                is_stopped = self._is_stopped()
                if self._is_left() and (is_stopped or not self._coming):
                    return
                # One more than workers: its tester thinks while the others' runs are performed.
                has_room = len(self._threads) <= self._pool.workers
                if self._coming and not is_stopped and has_room and self._pool.is_hungry():
                    self._start(self._coming.popleft())
                self._ended.wait(_LOOK_S)
                self._ended.clear()
                looked += _LOOK_S
        finally:
            self._stopped.set()
            while not self._is_left():
                self._ended.wait(_LOOK_S)

    def _is_left(self) -> bool:
        """Returns whether no campaign runs, but for those whose testers never return."""
        return all(watch.lets_go(thread) for thread, watch in self._threads)

    def _is_stopped(self) -> bool:
        return self._stopped.is_set() or self._closing.is_set() or bool(self._pool.fault)

    def _look_for_request(self) -> None:
        with self._database.read() as transaction:
            request = transaction.studies.request_of(self._study_id)
        if request is not NONE:
            self._request = request
            self._stopped.set()

    def _start(self, campaign_id: str) -> None:
        watch = TesterInterruption(
            self._setup.database, campaign_id, self._requested, self._setup.memory
        )
        thread = threading.Thread(
            target=self._conduct,
            args=(campaign_id, watch),
            name=f"campaign {campaign_id}",
            daemon=True,
        )
        self._threads.append((thread, watch))
        thread.start()

    def _requested(self) -> CampaignRequest:
        return self._request if self._is_stopped() else NONE

    def _conduct(self, campaign_id: str, watch: TesterInterruption) -> None:
        evaluator = self._pool.evaluator()
        try:
            with watch.watching():
                run_stored(
                    self._database,
                    campaign_id,
                    self._setup.campaign_folder(campaign_id),
                    catalogues=self._setup.catalogues,
                    evaluator=lambda _workers: closing(evaluator),
                    watcher=Watcher(requested=self._requested, on_call=watch.on_call),
                )
        except (Conflict, KeyboardInterrupt):
            # Another process runs it by itself, it was cancelled meanwhile, or its tester did not
            # follow a request and was interrupted.
            pass
        except BaseException as error:
            if isinstance(error, WorkersCannotStart | StoreError):
                self._stopped.set()
            self._setup.on_error(error)
        finally:
            evaluator.close()
            self._ended.set()
