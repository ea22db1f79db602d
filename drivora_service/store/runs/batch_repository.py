"""Batches: runs that were submitted together."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable
from datetime import UTC, datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.errors import Conflict, UnknownName
from drivora_service.oracles.verdicts.failure_definition import StatedDefinition
from drivora_service.runs.run_report import UNFINISHED, RunStatus
from drivora_service.shapes import combine
from drivora_service.store.engine.ids import new_id
from drivora_service.store.engine.merging import Branch, first_numbers
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.queue.cancelling import cancel_runs
from drivora_service.store.runs.batch_definitions import definition_of_batch
from drivora_service.store.runs.facet_tables import BatchFacetRow, FacetRow
from drivora_service.store.runs.run_records import Batch, BatchState, Page, Priority
from drivora_service.store.runs.run_tables import BatchRow, RunRow

SINGLE_JOBS = "jobs"
"""Beginning of the ids of the batches of jobs that were posted singly; they are never shown."""


def single_jobs(owner_id: str) -> str:
    """Returns the id of the batch of jobs that were posted singly.

    Args:
        owner_id: Process for which they are reserved; "": any server.
    """
    return f"{SINGLE_JOBS}-{owner_id}" if owner_id else SINGLE_JOBS


class BatchRepository:
    """Reads and writes batches."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def create(self, *, name: str, priority: Priority, owner_id: str = "") -> Batch:
        """Creates an empty batch; runs are added with :meth:`JobRepository.submit`.

        Args:
            name: Display name.
            priority: Priority of its runs.
            owner_id: Process for which its runs are reserved; "": any server.
        """
        row = BatchRow(
            id=new_id(),
            name=name,
            priority=priority.rank,
            state=BatchState.OPEN,
            created_at=datetime.now(UTC),
            size=0,
            queued=0,
            served=self._fair_start(priority),
            owner_id=owner_id,
        )
        self._session.add(row)
        self._session.flush()
        return self._records([row])[0]

    def get(self, batch_id: str) -> Batch:
        """Returns a batch.

        Raises:
            UnknownName: There is none of this id.
        """
        return self._records([self._row(batch_id)])[0]

    def page(
        self, *, priorities: Collection[Priority] = (), limit: int = 50, page_token: str = ""
    ) -> Page[Batch]:
        """Returns batches, newest first.

        Args:
            priorities: Only those of one of these priorities; none: all.
            limit: Greatest number of batches.
            page_token: Token of the page.

        Raises:
            InvalidDocument: The token is not one of this list.
        """
        ranks = sorted({priority.rank for priority in priorities})
        scope = f"batches {ranks}"
        number, is_shown = BatchRow.seq, ~BatchRow.id.startswith(SINGLE_JOBS)
        branches = [
            Branch(number=number, conditions=(is_shown, BatchRow.priority == rank))
            for rank in ranks
        ]
        numbers = first_numbers(
            self._session,
            branches or [Branch(number=number, conditions=(is_shown,))],
            limit=limit + 1,
            after=read_token(scope, page_token) if page_token else None,
            descending=True,
        )
        more = make_token(scope, numbers[limit - 1]) if len(numbers) > limit else ""
        rows = self._session.scalars(
            select(BatchRow).where(number.in_(numbers[:limit])).order_by(number.desc())
        ).all()
        return Page(items=tuple(self._records(rows)), next_page_token=more)

    def definition(self, batch_id: str) -> StatedDefinition:
        """Returns what counts as a failure of the runs of a batch; it reads all of them."""
        return definition_of_batch(self._session, batch_id)

    def pause(self, batch_id: str) -> Batch:
        """Holds back the queued runs of a batch; running ones are not affected.

        Raises:
            UnknownName: There is none of this id.
            Conflict: The batch was cancelled.
        """
        return self._set_state(batch_id, BatchState.PAUSED)

    def resume(self, batch_id: str) -> Batch:
        """Releases the queued runs of a paused batch.

        Raises:
            UnknownName: There is none of this id.
            Conflict: The batch was cancelled.
        """
        row = self._row(batch_id)
        if row.state == BatchState.PAUSED:
            row.served = max(row.served, self._fair_start(Priority.of_rank(row.priority)))
        return self._set_state(batch_id, BatchState.OPEN)

    def cancel(self, batch_id: str) -> Batch:
        """Cancels all runs of a batch that have not ended; cancelling again changes nothing.

        Raises:
            UnknownName: There is none of this id.
        """
        row = self._row(batch_id)
        self._cancel(row)
        return self._records([row])[0]

    def cancel_reserved(self, owner_id: str) -> None:
        """Cancels the runs that have not ended of the batches reserved for a process."""
        query = select(BatchRow).where(
            BatchRow.owner_id == owner_id, BatchRow.state != BatchState.CANCELLED
        )
        rows = self._session.scalars(query).all()
        for row, batch in zip(rows, self._records(rows), strict=True):
            if not batch.done:
                self._cancel(row)

    def _cancel(self, row: BatchRow) -> None:
        row.state = BatchState.CANCELLED
        self._session.flush()
        unfinished = (
            select(BatchFacetRow.facet)
            .join(FacetRow, FacetRow.key == BatchFacetRow.facet)
            .where(
                BatchFacetRow.batch_seq == row.seq,
                FacetRow.status.in_(UNFINISHED),
            )
        )
        rows = self._session.scalars(
            select(RunRow).where(RunRow.batch_seq == row.seq, RunRow.facet.in_(unfinished))
        ).all()
        cancel_runs(self._session, rows)

    def _set_state(self, batch_id: str, state: BatchState) -> Batch:
        row = self._row(batch_id)
        if row.state == BatchState.CANCELLED:
            raise Conflict(f"batch {batch_id} was cancelled; post its scenarios again")
        row.state = state
        self._session.flush()
        return self.get(batch_id)

    def _row(self, batch_id: str) -> BatchRow:
        row = self._by_id(batch_id)
        if row is None:
            raise UnknownName("batch", batch_id, ())
        return row

    def _by_id(self, batch_id: str) -> BatchRow | None:
        return self._session.scalar(
            select(BatchRow).where(BatchRow.id == batch_id, ~BatchRow.id.startswith(SINGLE_JOBS))
        )

    def _fair_start(self, priority: Priority) -> int:
        """Returns the share with which a new batch starts, level with the least served one."""
        least = self._session.scalar(
            select(func.min(BatchRow.served)).where(
                BatchRow.priority == priority.rank,
                BatchRow.queued > 0,
                BatchRow.state == BatchState.OPEN,
            )
        )
        return least or 0

    def _records(self, rows: Iterable[BatchRow]) -> list[Batch]:
        rows = list(rows)
        keys = [row.seq for row in rows]
        counts: dict[int, Counter[RunStatus]] = defaultdict(Counter)
        violated: Counter[int] = Counter()
        failing: Counter[int] = Counter()
        for seq, status, broken, fails, number in self._session.execute(
            select(
                BatchFacetRow.batch_seq,
                FacetRow.status,
                FacetRow.violated,
                FacetRow.failing,
                BatchFacetRow.runs,
            )
            .join(FacetRow, FacetRow.key == BatchFacetRow.facet)
            .where(BatchFacetRow.batch_seq.in_(keys), BatchFacetRow.runs > 0)
        ):
            counts[seq][RunStatus(status)] += number
            violated[seq] += number if broken else 0
            failing[seq] += number if fails else 0
        return [
            combine(
                Batch,
                row,
                priority=Priority.of_rank(row.priority),
                state=BatchState(row.state),
                counts=counts[row.seq],
                violated_runs=violated[row.seq],
                failing_runs=failing[row.seq],
            )
            for row in rows
        ]
