"""The queue: leasing runs to owners and writing their ends."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any

from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.runs import lifecycle
from drivora_service.runs.attempt import AttemptEnd
from drivora_service.runs.lifecycle import RetryPolicy
from drivora_service.runs.report_encoding import choice_from_json
from drivora_service.runs.run_report import RunReport, RunSpec
from drivora_service.store.engine.chunks import batched
from drivora_service.store.engine.plain_statements import Row
from drivora_service.store.engine.stored_documents import store_documents
from drivora_service.store.queue.held_runs import HeldRuns
from drivora_service.store.queue.quarantine import QuarantineRepository, quarantine_key
from drivora_service.store.queue.queued_candidates import source_from_json
from drivora_service.store.queue.queued_runs import (
    QUEUED_RUN,
    QueuedRun,
    first_runs,
    leases_of_owner,
    leases_of_runs,
    one_run,
    read_queued_run,
    runs_to_cancel,
)
from drivora_service.store.queue.run_batches import RunBatch
from drivora_service.store.queue.shares import has_claimable, shares_of_batches
from drivora_service.store.runs.run_tables import RunRow


class QueueRepository:
    """Leases queued runs to owners and writes their ends.

    An owner can end only its own open lease, and only once; so a repeated report, or one of a
    process that was taken for dead, changes nothing.

    Transactions that write run one after another, in SQLite and by a lock in PostgreSQL (decision
    69), so that what a method has read is still true when it writes.
    """

    def __init__(self, session: Session) -> None:
        self._session = session

    def claim(
        self,
        owner_id: str,
        limit: int,
        *,
        trace_path: Callable[[str, int], str],
        reserved_to: str = "",
    ) -> tuple[RunSpec, ...]:
        """Leases up to ``limit`` queued runs.

        Lower priorities wait for higher ones; within a priority the batches take turns. Runs that
        were interrupted by several deaths of the server come after all others, once their wait is
        over, and one at a time.

        Args:
            owner_id: Process that owns the leases.
            limit: Greatest number of runs.
            trace_path: Returns where the trace of a run is written, by its id and the attempt.
            reserved_to: Process for which the runs are reserved; "": runs of any server.
        """
        changes = RunBatch(self._session)
        specs = self._claim(changes, owner_id, limit, trace_path, reserved_to)
        changes.write()
        return specs

    def finish(
        self, owner_id: str, ends: Sequence[AttemptEnd], policy: RetryPolicy
    ) -> tuple[RunReport, ...]:
        """Writes the ends of attempts; returns the reports of the runs that ended with them."""
        changes = RunBatch(self._session)
        final = self._finish(changes, owner_id, ends, policy)
        changes.write()
        return final

    def finish_and_claim(
        self,
        owner_id: str,
        ends: Sequence[AttemptEnd],
        policy: RetryPolicy,
        limit: int,
        *,
        trace_path: Callable[[str, int], str],
        reserved_to: str = "",
    ) -> tuple[RunSpec, ...]:
        """Writes ends as :meth:`finish` does, and leases as :meth:`claim` does.

        Both are written with one statement a table, unless a run goes back to the queue: the claim
        must find it there.
        """
        changes = RunBatch(self._session)
        # Ends first: a run that goes back to the queue may be claimed at once. What has ended for
        # good does not matter to the claim, which looks for queued runs only. A held run may have
        # to wait for the next claim, as the one before it still counts as running.
        self._finish(changes, owner_id, ends, policy)
        if changes.queues_again:
            changes.write()
            changes = RunBatch(self._session)
        specs = self._claim(changes, owner_id, limit, trace_path, reserved_to)
        changes.write()
        return specs

    def _claim(
        self,
        changes: RunBatch,
        owner_id: str,
        limit: int,
        trace_path: Callable[[str, int], str],
        reserved_to: str,
    ) -> tuple[RunSpec, ...]:
        if limit <= 0:
            return ()
        specs: list[RunSpec] = []
        # The queries below are not the ORM's, which would flush by itself.
        self._session.flush()
        now = datetime.now(UTC)
        connection = self._session.connection()
        for query, values in self._queries(limit, reserved_to, now):
            for row in connection.execute(query, values):
                run = read_queued_run(row)
                agent, seed, feedback, genes, body = row[len(QUEUED_RUN) :]
                # Numbers only grow, also over a reset of the run: the trace of an attempt has a
                # folder of its own, to which a worker that was taken for dead may still write.
                attempt = run.attempts + 1
                changes.start(run, lifecycle.start(run.state), owner_id=owner_id, now=now)
                specs.append(
                    RunSpec(
                        run_id=run.id,
                        document="" if genes else body,
                        trace_path=trace_path(run.id, attempt) if run.keeps_trace else "",
                        attempt=attempt,
                        agent=agent,
                        seed=seed,
                        feedback=_feedback(feedback) if feedback else None,
                        candidate=source_from_json(genes, body) if genes else None,
                    )
                )
        return tuple(specs)

    def _finish(
        self, changes: RunBatch, owner_id: str, ends: Sequence[AttemptEnd], policy: RetryPolicy
    ) -> tuple[RunReport, ...]:
        if not ends:
            return ()
        final: list[RunReport] = []
        leases = self._leases(owner_id, [end.report.run_id for end in ends])
        # Without ends of attempts that are no longer open: those of an owner that was taken for
        # dead, also if it has begun another attempt at the same run since. They are left out here
        # so that their scenarios are not stored either.
        ends = [end for end in ends if not _is_over(end, leases)]
        decoded = self._store_decoded(ends)
        for end in ends:
            # Taken out, so that a report that comes twice in one call counts once as well.
            lease = leases.pop(end.report.run_id, None)
            if lease is None:
                continue
            run, number = lease
            report = end.report
            changes.close(
                run,
                number,
                report.status,
                end.ended,
                failure=report.failure,
                worker=end.worker,
                started=end.started,
                signal=end.signal,
            )
            transition = lifecycle.end(run.state, report, policy)
            document_sha256 = decoded.get(run.id, run.document_sha256)
            changes.follow(
                run,
                transition,
                end.ended,
                document_sha256=document_sha256,
                candidate=end.candidate,
            )
            # By the scenario that was simulated: that of genes is known only now.
            if transition.quarantine:
                self._quarantine(run, end, document_sha256)
            if transition.report is not None:
                final.append(transition.report)
        return tuple(final)

    def _quarantine(self, run: QueuedRun, end: AttemptEnd, document_sha256: str) -> None:
        if end.report.failure is None:
            return
        row = self._session.execute(
            select(RunRow.agent_override, RunRow.seed_override).where(RunRow.seq == run.seq)
        ).one()
        QuarantineRepository(self._session).add(
            quarantine_key(document_sha256, row.agent_override, row.seed_override),
            scenario_sha256=document_sha256,
            run_id=run.id,
            signal=end.signal,
            failure=end.report.failure,
        )

    def _store_decoded(self, ends: Sequence[AttemptEnd]) -> dict[str, str]:
        """Stores the scenarios of candidates; returns their hashes by run id."""
        documents = {
            end.report.run_id: end.candidate.document
            for end in ends
            if end.candidate is not None and end.candidate.document
        }
        hashes = {
            run_id: hashlib.sha256(document.encode()).hexdigest()
            for run_id, document in documents.items()
        }
        store_documents(self._session, {hashes[run_id]: body for run_id, body in documents.items()})
        return hashes

    def release(self, owner_id: str, run_ids: Sequence[str]) -> None:
        """Puts runs back into the queue because their owner stops."""
        now = datetime.now(UTC)
        changes = RunBatch(self._session)
        for run, number in self._leases(owner_id, run_ids).values():
            changes.close(run, number, "released", now)
            changes.follow(run, lifecycle.release(run.state, run.id), now)
        changes.write()

    def reclaim(self, dead_owner_id: str, policy: RetryPolicy) -> int:
        """Puts the runs of a dead owner back into the queue; returns their number."""
        now = datetime.now(UTC)
        changes = RunBatch(self._session)
        leases = self._leases(dead_owner_id, None)
        for run, number in leases.values():
            changes.close(run, number, "interrupted", now)
            changes.follow(run, lifecycle.interrupt(run.state, run.id, policy), now)
        changes.write()
        return len(leases)

    def has_work(self, reserved_to: str = "") -> bool:
        """Returns whether a claim would find a run."""
        held = HeldRuns(self._session)
        numbers = held.numbers()
        if has_claimable(self._session, numbers, reserved_to):
            return True
        return bool(numbers) and held.due(datetime.now(UTC), reserved_to) is not None

    def to_cancel(self) -> tuple[str, ...]:
        """Returns the running runs that have a request to cancel."""
        return tuple(run_id for (run_id,) in self._session.connection().execute(runs_to_cancel()))

    def _queries(
        self, limit: int, reserved_to: str, now: datetime
    ) -> list[tuple[Select[Any], Row]]:
        """Returns queries for ``limit`` runs, with their values: one for each batch.

        A run that is held and due follows if the batches have fewer.
        """
        held = HeldRuns(self._session)
        numbers = held.numbers()
        shares = shares_of_batches(self._session, limit, numbers, reserved_to)
        # One query a batch, for as many runs as it gives: an index has them in their order.
        queries: list[tuple[Select[Any], Row]] = [
            (first_runs(), {"batch": seq, "share": share}) for seq, share in shares.items()
        ]
        # Held runs last: one that takes the server down must not keep others from being done.
        if numbers and sum(shares.values()) < limit:
            due = held.due(now, reserved_to)
            if due is not None:
                queries.append((one_run(), {"run": due}))
        return queries

    def _leases(
        self, owner_id: str, run_ids: Sequence[str] | None
    ) -> dict[str, tuple[QueuedRun, int]]:
        """Returns the runs that an owner has leased, with the numbers of their attempts.

        Args:
            owner_id: The owner.
            run_ids: Runs to look for; ``None``: all.
        """
        # An open attempt of this owner is the lease. The number of the attempt comes with it, as an
        # end may be that of an earlier one.
        self._session.flush()
        connection = self._session.connection()
        if run_ids is None:
            rows = connection.execute(leases_of_owner(), {"owner": owner_id}).all()
        else:
            rows = [
                row
                for chunk in batched(run_ids)
                for row in connection.execute(
                    leases_of_runs(), {"owner": owner_id, "run_ids": list(chunk)}
                )
            ]
        leases = [(read_queued_run(row), row[-1]) for row in rows]
        return {run.id: (run, number) for run, number in leases}


def _is_over(end: AttemptEnd, leases: Mapping[str, tuple[QueuedRun, int]]) -> bool:
    """Returns whether an attempt was closed before its end was known."""
    lease = leases.get(end.report.run_id)
    return lease is None or end.attempt not in (0, lease[1])


@lru_cache(maxsize=64)
def _feedback(text: str) -> FeedbackChoice:
    """Returns a choice of feedback, which is the same for the runs of a campaign."""
    return choice_from_json(text)
