"""The journal of a campaign in the database."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping

from drivora_service.store.campaign_records import (
    CampaignRequest,
    Confirmation,
    EvaluationRecord,
    Failure,
)
from drivora_service.store.database import Database

_PAGE = 200


class StoreJournal:
    """Writes every evaluation in a transaction of its own, and measures the campaign's work time.

    A kill loses at most the running simulations.
    """

    def __init__(self, database: Database, campaign_id: str) -> None:
        self._database, self._campaign_id = database, campaign_id
        self._counted_until = time.monotonic()

    def evaluations(self) -> Iterator[EvaluationRecord]:
        """Yields the evaluations in order, read a page at a time."""
        after = -1
        while True:
            with self._database.read() as transaction:
                page = transaction.evaluations.page(self._campaign_id, after=after, limit=_PAGE)
            yield from page
            if len(page) < _PAGE:
                return
            after = page[-1].number

    def append(self, record: EvaluationRecord, document: str) -> None:
        """Writes the next evaluation, durably when the call returns."""
        with self._database.write() as transaction:
            transaction.evaluations.append(
                self._campaign_id, record, document=document, active_s=self.active_s()
            )

    def document(self, number: int) -> str:
        """Returns the canonical JSON text of an evaluation's scenario."""
        with self._database.read() as transaction:
            return transaction.evaluations.document(self._campaign_id, number)

    def failures(self) -> tuple[Failure, ...]:
        """Returns every violation of every evaluation, in order."""
        with self._database.read() as transaction:
            return transaction.evaluations.failures(self._campaign_id)

    def confirm(self, number: int, confirmation: Confirmation, trace: str) -> None:
        """Writes whether an identical run repeated the failures of an evaluation."""
        with self._database.write() as transaction:
            transaction.evaluations.confirm(self._campaign_id, number, confirmation, trace=trace)

    def group(self, groups: Mapping[tuple[int, int], int]) -> None:
        """Writes the groups of failures."""
        with self._database.write() as transaction:
            transaction.evaluations.group(self._campaign_id, groups)

    def requested(self) -> CampaignRequest:
        """Returns the pending request to the campaign."""
        with self._database.read() as transaction:
            return transaction.campaigns.request_of(self._campaign_id)

    def active_s(self) -> float:
        """Returns the seconds of work since the last call."""
        now = time.monotonic()
        elapsed, self._counted_until = now - self._counted_until, now
        return elapsed
