"""The queue: leasing runs to owners and writing their ends."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import UTC, datetime, timedelta

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from drivora_service.runs import lifecycle
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.encoding import choice_from_json
from drivora_service.runs.lifecycle import RetryPolicy, Transition
from drivora_service.runs.report import RunFailure, RunReport, RunSpec, RunStatus
from drivora_service.store.endings import run_state, set_run_state, write_report
from drivora_service.store.held_runs import HeldRuns
from drivora_service.store.quarantine import QuarantineRepository, quarantine_key
from drivora_service.store.records import BatchState
from drivora_service.store.revisions import latest_revision
from drivora_service.store.tables import AttemptRow, BatchRow, DocumentRow, RunRow


class QueueRepository:
    """Leases queued runs to owners and writes their ends.

    An owner can end only its own open lease, and only once; so a repeated report, or one of a
    process that was taken for dead, changes nothing.
    """

    def __init__(self, session: Session) -> None:
        self._session = session

    def claim(
        self,
        owner_id: str,
        limit: int,
        *,
        trace_path: Callable[[str], str],
        reserved_to: str = "",
    ) -> tuple[RunSpec, ...]:
        """Leases up to ``limit`` queued runs.

        Lower priorities wait for higher ones; within a priority the batches take turns. Runs that
        were interrupted by several deaths of the server come after all others, once their wait is
        over, and one at a time.

        Args:
            owner_id: Process that owns the leases.
            limit: Greatest number of runs.
            trace_path: Returns the trace file of a run id.
            reserved_to: Process for which the runs are reserved; "": runs of any server.
        """
        specs: list[RunSpec] = []
        now = datetime.now(UTC)
        changes = self._changes()
        held = HeldRuns(self._session)
        found = self._shares(limit, held.numbers(), reserved_to)
        shares = [(batch, share, held.none_of) for batch, share in found]
        missing = limit - sum(share for _, share, _ in shares)
        if missing > 0 and (due := held.due(now, reserved_to)) is not None:
            run_seq, batch = due
            shares.append((batch, 1, lambda: RunRow.seq == run_seq))
        for batch, share, among in shares:
            rows = self._session.execute(
                select(RunRow, DocumentRow.body)
                .join(DocumentRow, DocumentRow.sha256 == RunRow.document_sha256)
                .where(RunRow.batch_seq == batch.seq, RunRow.status == RunStatus.QUEUED, among())
                .order_by(RunRow.seq)
                .limit(share)
                .with_for_update(skip_locked=True, of=RunRow)
            ).all()
            for row, document in rows:
                set_run_state(row, lifecycle.start(run_state(row)), revision=next(changes))
                row.attempts += 1
                row.started_at = row.started_at or now
                self._session.add(
                    AttemptRow(
                        run_seq=row.seq, number=row.attempts, owner_id=owner_id, claimed_at=now
                    )
                )
                specs.append(
                    RunSpec(
                        run_id=row.id,
                        document=document,
                        trace_path=trace_path(row.id) if row.keeps_trace else "",
                        agent=row.agent_override,
                        seed=row.seed_override,
                        feedback=choice_from_json(row.feedback) if row.feedback else None,
                    )
                )
            batch.queued -= len(rows)
            batch.served += len(rows)
        return tuple(specs)

    def finish(
        self, owner_id: str, ends: Sequence[AttemptEnd], policy: RetryPolicy
    ) -> tuple[RunReport, ...]:
        """Writes the ends of attempts; returns the reports of the runs that ended with them."""
        final: list[RunReport] = []
        changes = self._changes()
        leases = self._leases(owner_id, [end.report.run_id for end in ends])
        for end in ends:
            lease = leases.pop(end.report.run_id, None)
            if lease is None:
                continue
            row, attempt = lease
            report = end.report
            attempt.worker, attempt.signal = end.worker, end.signal
            attempt.started_at = end.started
            _close(attempt, report.status, report.failure, end.ended)
            transition = lifecycle.end(run_state(row), report, policy)
            self._follow(row, transition, end.ended, revision=next(changes))
            if transition.quarantine and report.failure is not None:
                QuarantineRepository(self._session).add(
                    quarantine_key(row.document_sha256, row.agent_override, row.seed_override),
                    scenario_sha256=row.document_sha256,
                    run_id=row.id,
                    signal=end.signal,
                    failure=report.failure,
                )
            if transition.report is not None:
                final.append(transition.report)
        return tuple(final)

    def release(self, owner_id: str, run_ids: Sequence[str]) -> None:
        """Puts runs back into the queue because their owner stops."""
        now = datetime.now(UTC)
        changes = self._changes()
        for row, attempt in self._leases(owner_id, run_ids).values():
            _close(attempt, "released", None, now)
            transition = lifecycle.release(run_state(row), row.id)
            self._follow(row, transition, now, revision=next(changes))

    def reclaim(self, dead_owner_id: str, policy: RetryPolicy) -> int:
        """Puts the runs of a dead owner back into the queue; returns their number."""
        now = datetime.now(UTC)
        changes = self._changes()
        leases = self._leases(dead_owner_id, None)
        for row, attempt in leases.values():
            _close(attempt, "interrupted", None, now)
            transition = lifecycle.interrupt(run_state(row), row.id, policy)
            self._follow(row, transition, now, revision=next(changes))
        return len(leases)

    def has_work(self, reserved_to: str = "") -> bool:
        """Returns whether a claim would find a run."""
        held = HeldRuns(self._session)
        numbers = held.numbers()
        query = select(BatchRow.seq).where(
            BatchRow.queued > 0,
            BatchRow.state == BatchState.OPEN,
            BatchRow.owner_id == reserved_to,
            held.others(numbers),
        )
        if self._session.scalar(query.limit(1)) is not None:
            return True
        return bool(numbers) and held.due(datetime.now(UTC), reserved_to) is not None

    def to_cancel(self) -> tuple[str, ...]:
        """Returns the running runs that have a request to cancel."""
        query = select(RunRow.id).where(RunRow.status == RunStatus.RUNNING, RunRow.cancel_requested)
        return tuple(self._session.scalars(query))

    def _shares(
        self, limit: int, held: Mapping[int, int], reserved_to: str
    ) -> list[tuple[BatchRow, int]]:
        """Divides ``limit`` runs among the batches: one each in turn, least served first.

        Args:
            limit: Greatest number of runs.
            held: Numbers of held queued runs, by the ``seq`` of their batch.
            reserved_to: See :meth:`claim`.
        """
        if limit <= 0:
            return []
        candidates = self._session.scalars(
            select(BatchRow)
            .where(
                BatchRow.queued > 0,
                BatchRow.state == BatchState.OPEN,
                BatchRow.owner_id == reserved_to,
                HeldRuns(self._session).others(held),
            )
            .order_by(BatchRow.priority, BatchRow.served, BatchRow.seq)
            .limit(limit)
            .with_for_update()
        ).all()
        heap = [(batch.priority, batch.served, batch.seq, batch) for batch in candidates]
        taken = dict.fromkeys(candidates, 0)
        for _ in range(limit):
            if not heap:
                break
            priority, served, seq, batch = heap[0]
            taken[batch] += 1
            if taken[batch] < batch.queued - held.get(batch.seq, 0):
                heapq.heapreplace(heap, (priority, served + 1, seq, batch))
            else:
                heapq.heappop(heap)
        return [(batch, share) for batch, share in taken.items() if share]

    def _leases(
        self, owner_id: str, run_ids: Sequence[str] | None
    ) -> dict[str, tuple[RunRow, AttemptRow]]:
        query = (
            select(RunRow, AttemptRow)
            .join(AttemptRow, AttemptRow.run_seq == RunRow.seq)
            .where(
                AttemptRow.owner_id == owner_id,
                AttemptRow.ended_at.is_(None),
                RunRow.status == RunStatus.RUNNING,
            )
        )
        if run_ids is not None:
            query = query.where(RunRow.id.in_(run_ids))
        return {row.id: (row, attempt) for row, attempt in self._session.execute(query)}

    def _changes(self) -> Iterator[int]:
        """Yields revisions for the changes of this transaction."""
        return itertools.count(latest_revision(self._session) + 1)

    def _follow(
        self, row: RunRow, transition: Transition, when: datetime, *, revision: int
    ) -> None:
        set_run_state(row, transition.state, revision=revision)
        if transition.wait_s:
            row.not_before = when + timedelta(seconds=transition.wait_s)
        if transition.report is not None:
            row.not_before = None
            write_report(self._session, row, transition.report, ended=when)
        elif transition.state.status is RunStatus.QUEUED:
            self._session.execute(
                update(BatchRow)
                .where(BatchRow.seq == row.batch_seq)
                .values(queued=BatchRow.queued + 1)
            )


def _close(attempt: AttemptRow, outcome: str, failure: RunFailure | None, when: datetime) -> None:
    attempt.ended_at = when
    attempt.outcome = outcome
    if failure is not None:
        attempt.cause, attempt.log = failure.cause, failure.log
