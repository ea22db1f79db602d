"""The journal of a campaign in the database."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    CampaignRequest,
    CampaignState,
    Confirmation,
    EvaluationRecord,
    Failure,
)
from drivora_service.store.campaigns.seed_run_records import SeedRun
from drivora_service.store.database import Database, Transaction

_PAGE = 200

_WRITE_SHARE, _SHORTEST_WRITE_S, _LONGEST_WRITE_S = 0.1, 0.2, 2.0
"""The seconds for which an evaluation waits for others, to be written with them in one transaction:
a share of the campaign's time so far, within bounds. A new campaign is watched; one that runs for
hours has the more evaluations to write."""

_LOOK_S = 0.5
"""Seconds between two looks for a request."""


class StoreJournal:
    """Writes the evaluations, several in a transaction, and measures the campaign's work time.

    A kill loses the running simulations and the evaluations of the last two seconds at most, which
    a resumed campaign does again.
    """

    def __init__(
        self,
        database: Database,
        campaign_id: str,
        *,
        claim: str = "",
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Creates the journal of a stored campaign; nothing is read yet.

        Args:
            database: Holds the campaign.
            campaign_id: Id of the campaign.
            claim: What the campaign was begun with; a process that only reads needs none.
            clock: Returns seconds that never go backwards.
        """
        self._database, self._campaign_id, self._clock = database, campaign_id, clock
        self._claim = claim
        self._begun = self._counted_until = clock()
        self._unwritten: list[tuple[EvaluationRecord, str]] = []
        # Held while evaluations are taken or written, which a second thread does, too.
        self._writing = threading.RLock()
        self._write_at = self._look_at = clock()
        self._changes: int | None = None
        self._seen = CampaignRequest.NONE

    def evaluations(self, *, violating: bool = False) -> Iterator[EvaluationRecord]:
        """Yields the evaluations in order, read a page at a time."""
        self.flush()
        after = -1
        while True:
            with self._database.read() as transaction:
                page = transaction.evaluations.page(
                    self._campaign_id, after=after, limit=_PAGE, violating=violating
                )
            yield from page
            if len(page) < _PAGE:
                return
            after = page[-1].number

    def append(self, record: EvaluationRecord, document: str) -> None:
        """Takes the next evaluation, which is written soon."""
        with self._writing:
            if not self._unwritten:
                now = self._clock()
                wait = _WRITE_SHARE * (now - self._begun)
                self._write_at = now + min(max(wait, _SHORTEST_WRITE_S), _LONGEST_WRITE_S)
            self._unwritten.append((record, document))
            self.write_due()

    def write_due(self) -> None:
        """Writes the evaluations that wait, if the first of them has waited long enough."""
        if self._unwritten and self._clock() >= self._write_at:
            self.flush()

    def flush(self) -> None:
        """Writes the evaluations that wait, durably when the call returns."""
        with self._writing:
            if not self._unwritten:
                return
            # What cannot be written is not tried again: a resumed campaign makes it anew.
            entries, self._unwritten = self._unwritten, []
            with self._write() as transaction:
                transaction.evaluations.append(self._campaign_id, entries, active_s=self.active_s())

    @contextmanager
    def written_meanwhile(self) -> Iterator[None]:
        """Has a second thread write what is due, as a call of a tester may take very long.

        A process that is killed in such a call then loses nothing that was found before it.
        """
        done = threading.Event()
        thread = threading.Thread(
            target=self._write_until, args=(done,), name="journal", daemon=True
        )
        thread.start()
        try:
            yield
        finally:
            done.set()
            thread.join()

    def _write_until(self, done: threading.Event) -> None:
        while not done.wait(_LONGEST_WRITE_S):
            with self._writing:
                entries = self._unwritten
                try:
                    self.write_due()
                except Exception:
                    # The thread of the campaign tries again, and has to handle the fault.
                    self._unwritten = entries

    def document(self, number: int) -> str:
        """Returns the canonical JSON text of an evaluation's scenario."""
        self.flush()
        with self._database.read() as transaction:
            return transaction.evaluations.document(self._campaign_id, number)

    def failures(self) -> tuple[Failure, ...]:
        """Returns every violation of every evaluation, in order."""
        self.flush()
        with self._database.read() as transaction:
            return transaction.evaluations.failures(self._campaign_id)

    def open_numbers(self) -> frozenset[int]:
        """Returns the numbers of the evaluations whose failures were not run again yet."""
        self.flush()
        with self._database.read() as transaction:
            return transaction.evaluations.open_numbers(self._campaign_id)

    def confirm(self, number: int, confirmation: Confirmation, trace: str) -> None:
        """Writes whether an identical run repeated the failures of an evaluation."""
        with self._write() as transaction:
            transaction.evaluations.confirm(self._campaign_id, number, confirmation, trace=trace)

    def group(self, groups: Mapping[tuple[int, int], int]) -> None:
        """Writes the groups of failures."""
        with self._write() as transaction:
            transaction.evaluations.group(self._campaign_id, groups)

    def seed_runs(self) -> tuple[SeedRun, ...]:
        """Returns the runs of seed scenarios that were kept."""
        with self._database.read() as transaction:
            return transaction.campaigns.get(self._campaign_id).seed_runs

    def keep_seed_runs(self, runs: tuple[SeedRun, ...]) -> None:
        """Writes the runs of seed scenarios, in place of those before."""
        with self._write() as transaction:
            transaction.campaigns.keep_seed_runs(self._campaign_id, runs)

    def read_request(self) -> CampaignRequest:
        """Returns the pending request to the campaign, as it was a moment ago.

        Takes locks of this process again that were lost with a connection: in a command, nothing
        else does so while a campaign or a study runs.
        """
        now = self._clock()
        if now < self._look_at:
            return self._seen
        self._look_at = now + _LOOK_S
        self._database.locks.keep()
        changes = self._database.changes.value()
        if changes is None or changes != self._changes:
            self._changes = changes
            with self._database.read() as transaction:
                self._seen = transaction.campaigns.request_of(self._campaign_id)
        return self._seen

    def end(self, state: CampaignState, message: str = "") -> CampaignRecord:
        """Writes that the campaign has ended or paused.

        Raises:
            Conflict: Another process has taken it over.
        """
        with self._write() as transaction:
            return transaction.campaigns.end(
                self._campaign_id, state, message=message, active_s=self.active_s()
            )

    @contextmanager
    def _write(self) -> Iterator[Transaction]:
        with self._database.write() as transaction:
            transaction.campaigns.require_claim(self._campaign_id, self._claim)
            yield transaction

    def active_s(self) -> float:
        """Returns the seconds of work since the last call."""
        now = self._clock()
        elapsed, self._counted_until = now - self._counted_until, now
        return elapsed
