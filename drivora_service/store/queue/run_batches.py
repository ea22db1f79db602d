"""Changes of many runs in one transaction: collected, then written with one statement a table.

Statements for many rows cost a tenth of objects that the ORM follows. The counters of facets, which
the ORM's flush changes otherwise, are changed here.
"""

from __future__ import annotations

from collections import Counter
from datetime import datetime, timedelta

from sqlalchemy import Connection
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.failure_definition import definition_from_json
from drivora_service.runs.candidate import Candidate
from drivora_service.runs.lifecycle import RunState, Transition
from drivora_service.runs.run_report import RunFailure, RunReport, RunStatus
from drivora_service.store.changes.revisions import next_revisions, revise_batches
from drivora_service.store.engine.plain_statements import Row, execute_many
from drivora_service.store.failures.failure_writing import (
    make_found_rows_of_run,
    write_found_in_runs,
)
from drivora_service.store.queue.endings import end_values, report_values, verdict_values
from drivora_service.store.queue.queued_runs import QueuedRun
from drivora_service.store.queue.run_statements import (
    close_attempt,
    count_queued,
    end_run,
    insert_report,
    insert_verdict,
    open_attempt,
    queue_run_again,
    start_run,
)
from drivora_service.store.runs.facets import Facet, FacetChanges, add_counts, make_facet_with_key
from drivora_service.store.runs.notable_verdicts import notable_verdicts


class RunBatch:
    """Changes of runs in the queue. Nothing is written before :meth:`write`.

    A run is either started, or ended, or goes back to the queue: its changes are computed from the
    row as it was read, so that a second change of the same run would count from a stale state.
    """

    def __init__(self, session: Session) -> None:
        """Creates a collection without changes, which ``session`` will write."""
        self._session = session
        self._started: list[Row] = []
        self._opened: list[Row] = []
        self._closed: list[Row] = []
        self._again: list[Row] = []
        self._ended: list[Row] = []
        self._reports: list[Row] = []
        self._verdicts: list[Row] = []
        self._found: list[Row] = []
        # Numbers of runs that move from one facet to another, by batch, old and new facet: a batch
        # of many runs has few different moves, and each changes two counters.
        self._moves: Counter[tuple[int, int, int]] = Counter()
        self._facets: dict[int, Facet] = {}
        self._queued: Counter[int] = Counter()
        self._served: Counter[int] = Counter()

    @property
    def queues_again(self) -> bool:
        """Whether a run goes back to the queue."""
        return bool(self._again)

    def start(self, run: QueuedRun, state: RunState, *, owner_id: str, now: datetime) -> None:
        """Opens an attempt at a queued run, whose new state is ``state``."""
        self._started.append(
            {
                "run": run.seq,
                "status": state.status,
                "now": now,
                "facet": self._count(run, state.status),
            }
        )
        self._queued[run.batch_seq] -= 1
        self._served[run.batch_seq] += 1
        self._opened.append(
            {
                "run_seq": run.seq,
                "number": run.attempts + 1,
                "owner_id": owner_id,
                "claimed_at": now,
                "worker": "",
                "outcome": "",
                "cause": "",
                "signal": "",
                "log": "",
            }
        )

    def close(
        self,
        run: QueuedRun,
        number: int,
        outcome: str,
        ended: datetime,
        *,
        failure: RunFailure | None = None,
        worker: str = "",
        started: datetime | None = None,
        signal: str = "",
    ) -> None:
        """Closes an open attempt at a run, of this number."""
        self._closed.append(
            {
                "run": run.seq,
                "attempt": number,
                "outcome": outcome,
                "ended_at": ended,
                "cause": "" if failure is None else failure.cause,
                "log": "" if failure is None else failure.log,
                "worker": worker,
                "started_at": started,
                "signal": signal,
            }
        )

    def follow(
        self,
        run: QueuedRun,
        transition: Transition,
        when: datetime,
        *,
        document_sha256: str = "",
        candidate: Candidate | None = None,
    ) -> None:
        """Writes the transition of a running run: its end, or its return to the queue.

        Args:
            run: The run.
            transition: What follows for it.
            when: Time of its end.
            document_sha256: Hash of its scenario once it has ended; "": that of before.
            candidate: What its genes decode to, if it has any.
        """
        state = transition.state
        values: Row = {
            "run": run.seq,
            "status": state.status,
            "infrastructure_failures": state.infrastructure_failures,
            "crashes": state.crashes,
            "interruptions": state.interruptions,
        }
        if transition.report is not None:
            values["document_sha256"] = document_sha256 or run.document_sha256
            self._reports.append(report_values(run.seq, transition.report, candidate))
            self._end(run, transition.report, values, when)
            return
        # A run that was held once stays held, also if it comes back for another reason: it may be
        # the one that ends servers.
        wait = timedelta(seconds=transition.wait_s)
        values["not_before"] = when + wait if wait else run.not_before
        values["facet"] = self._count(run, state.status)
        self._again.append(values)
        self._queued[run.batch_seq] += 1

    def _end(self, run: QueuedRun, report: RunReport, values: Row, ended: datetime) -> None:
        definition = definition_from_json(run.definition)
        notable = notable_verdicts(report, definition)
        values |= end_values(
            report, definition, keeps_trace=run.keeps_trace, ended=ended, notable=notable
        )
        violations, strongest = values["violations"], values["accountability"]
        values["facet"] = facet = self._count(
            run, report.status, violations, strongest, values["failures"]
        )
        self._ended.append(values)
        if not notable:
            return
        self._verdicts += verdict_values(run.seq, run.batch_seq, facet, notable)
        self._found += make_found_rows_of_run(
            notable,
            run_seq=run.seq,
            batch_seq=run.batch_seq,
            agent=run.agent,
            configuration=run.configuration,
            configuration_id=run.configuration_id,
            town=run.town,
            found_at=ended,
        )

    def _count(
        self,
        run: QueuedRun,
        status: RunStatus,
        violations: int | None = None,
        accountability: str | None = None,
        failures: int | None = None,
    ) -> int:
        """Counts the change of a run's facet; returns the number of the new one."""
        configuration = run.configuration, run.configuration_id
        before, old = make_facet_with_key(
            run.agent, run.town, run.state.status, None, None, *configuration
        )
        after, new = make_facet_with_key(
            run.agent, run.town, status, violations, accountability, *configuration, failures
        )
        move = run.batch_seq, old, new
        if move not in self._moves:
            self._facets[old], self._facets[new] = before, after
        self._moves[move] += 1
        return new

    def _changes_of_facets(self) -> FacetChanges:
        changes: FacetChanges = Counter()
        for (batch_seq, old, new), number in self._moves.items():
            changes[batch_seq, self._facets[old]] -= number
            changes[batch_seq, self._facets[new]] += number
        return changes

    def write(self) -> None:
        """Writes the changes."""
        # The rows that the ORM holds are written first, so that none overwrites these changes.
        self._session.flush()
        connection = self._session.connection()
        changed = [*self._started, *self._again, *self._ended]
        if not changed:
            return
        # All revisions are drawn at once, in this transaction: writers take turns, so that
        # revisions are in the order of the commits (decision 69).
        batches = {batch_seq for batch_seq, _, _ in self._moves}
        first = next_revisions(self._session, len(changed) + len(batches))
        for revision, row in enumerate(changed, first):
            row["revision"] = revision
        # The order is free: the runs that are referred to exist already, and none is in two of the
        # lists of started, returned and ended ones.
        for statement, rows in (
            (start_run(), self._started),
            (open_attempt(), self._opened),
            (close_attempt(), self._closed),
            (queue_run_again(), self._again),
            (end_run(), self._ended),
            (insert_report(), self._reports),
            (insert_verdict(), self._verdicts),
        ):
            execute_many(connection, statement, rows)
        write_found_in_runs(self._session, self._found)
        add_counts(self._session, self._changes_of_facets())
        self._write_batches(connection, batches, first + len(changed))

    def _write_batches(self, connection: Connection, batches: set[int], first: int) -> None:
        """Writes the batches of the runs; ``first`` is the revision of the first one."""
        # No batch has both a start and a return, which would cancel out: finish_and_claim() writes
        # returns before it claims.
        queued = {seq for seq, number in self._queued.items() if number}
        rows = [
            {
                "batch": seq,
                "to": revision,
                "more": self._queued[seq],
                "served_more": self._served[seq],
            }
            for revision, seq in enumerate(sorted(queued), first)
        ]
        execute_many(connection, count_queued(), rows)
        revise_batches(self._session, batches - queued, first + len(rows))
