"""Changes of many runs in one transaction: collected, then written with one statement a table.

Statements for many rows cost a tenth of objects that the ORM follows. The counters of facets, which
the ORM's flush changes otherwise, are changed here.
"""

from __future__ import annotations

from collections import Counter
from datetime import datetime, timedelta
from functools import cache
from typing import Any, cast

from sqlalchemy import Connection, Table, Update, bindparam, func, insert, update
from sqlalchemy.orm import Session

from drivora_service.runs.candidate import Candidate
from drivora_service.runs.lifecycle import RunState, Transition
from drivora_service.runs.report import RunFailure, RunReport
from drivora_service.store.endings import end_values, report_values, verdict_values
from drivora_service.store.facets import Facet, FacetChanges, add_counts, facet_key
from drivora_service.store.found_writing import found_in_run, write_found_in_runs
from drivora_service.store.queued_runs import ATTEMPTS, RUNS, QueuedRun, facet_after
from drivora_service.store.revisions import next_revisions, revise_batches
from drivora_service.store.tables import BatchRow, ReportRow, VerdictRow

BATCHES = cast("Table", BatchRow.__table__)
_REPORTS = cast("Table", ReportRow.__table__)
_VERDICTS = cast("Table", VerdictRow.__table__)

Row = dict[str, Any]
"""Values of a statement by the names of its parameters."""


class RunBatch:
    """Changes of runs in the queue. Nothing is written before :meth:`write`."""

    def __init__(self, session: Session) -> None:
        """Begins without changes; ``session`` writes."""
        self._session = session
        self._started: list[Row] = []
        self._opened: list[Row] = []
        self._closed: list[Row] = []
        self._again: list[Row] = []
        self._ended: list[Row] = []
        self._reports: list[Row] = []
        self._verdicts: list[Row] = []
        self._found: list[Row] = []
        self._counts: FacetChanges = Counter()
        self._queued: Counter[int] = Counter()
        self._served: Counter[int] = Counter()
        self._batches: set[int] = set()

    def start(self, run: QueuedRun, state: RunState, *, owner_id: str, now: datetime) -> None:
        """Opens an attempt at a queued run, whose new state is ``state``."""
        self._started.append(
            {
                "run": run.seq,
                "status": state.status,
                "now": now,
                "facet": self._count(run, facet_after(run, state.status)),
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
        wait = timedelta(seconds=transition.wait_s)
        values["not_before"] = when + wait if wait else run.not_before
        values["facet"] = self._count(run, facet_after(run, state.status))
        self._again.append(values)
        self._queued[run.batch_seq] += 1

    def _end(self, run: QueuedRun, report: RunReport, values: Row, ended: datetime) -> None:
        values |= end_values(report, keeps_trace=run.keeps_trace, ended=ended)
        violations, strongest = values["violations"], values["accountability"]
        after = facet_after(run, report.status, violations=violations, accountability=strongest)
        values["facet"] = facet = self._count(run, after)
        self._ended.append(values)
        self._verdicts += verdict_values(run.seq, run.batch_seq, facet, report)
        self._found += found_in_run(
            report,
            run_seq=run.seq,
            batch_seq=run.batch_seq,
            agent=run.agent,
            town=run.town,
            found_at=ended,
        )

    def _count(self, run: QueuedRun, after: Facet) -> int:
        """Counts the change of a run's facet; returns the number of the new one."""
        self._batches.add(run.batch_seq)
        self._counts[run.batch_seq, run.facet] -= 1
        self._counts[run.batch_seq, after] += 1
        return facet_key(after)

    def write(self) -> None:
        """Writes the changes."""
        # The rows that the ORM holds are written first, so that none overwrites these changes.
        self._session.flush()
        connection = self._session.connection()
        changed = [*self._started, *self._again, *self._ended]
        if not changed:
            return
        first = next_revisions(self._session, len(changed) + len(self._batches))
        for revision, row in enumerate(changed, first):
            row["revision"] = revision
        for statement, rows in (
            (_start(), self._started),
            (insert(ATTEMPTS), self._opened),
            (_close(), self._closed),
            (_queue_again(), self._again),
            (_end(), self._ended),
            (insert(_REPORTS), self._reports),
            (insert(_VERDICTS), self._verdicts),
        ):
            if rows:
                connection.execute(statement, rows)
        write_found_in_runs(self._session, self._found)
        add_counts(self._session, self._counts)
        self._write_batches(connection, first + len(changed))

    def _write_batches(self, connection: Connection, first: int) -> None:
        """Writes the batches of the runs; ``first`` is the revision of the first one."""
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
        if rows:
            connection.execute(_queue(), rows)
        revise_batches(self._session, self._batches - queued, first + len(rows))


def _update_run(*names: str, **changes: Any) -> Update:
    """Returns the change of a run: of the columns named like their parameters, and others."""
    values = {name: bindparam(name) for name in names} | changes
    return update(RUNS).where(RUNS.c.seq == bindparam("run")).values(values)


@cache
def _start() -> Update:
    now = bindparam("now", type_=RUNS.c.started_at.type)
    return _update_run(
        "revision",
        "status",
        "facet",
        attempts=RUNS.c.attempts + 1,
        started_at=func.coalesce(RUNS.c.started_at, now),
    )


@cache
def _queue_again() -> Update:
    return _update_run(
        "revision",
        "status",
        "facet",
        "infrastructure_failures",
        "crashes",
        "interruptions",
        "not_before",
    )


@cache
def _end() -> Update:
    return _update_run(
        "revision",
        "status",
        "facet",
        "infrastructure_failures",
        "crashes",
        "interruptions",
        "document_sha256",
        "ended_at",
        "cause",
        "trace_sha256",
        "violations",
        "at_fault_violations",
        "observations",
        "accountability",
        "steps",
        "sim_time_s",
        "wall_time_s",
        not_before=None,
    )


@cache
def _close() -> Update:
    names = ("outcome", "ended_at", "cause", "log", "worker", "started_at", "signal")
    return (
        update(ATTEMPTS)
        .where(ATTEMPTS.c.run_seq == bindparam("run"), ATTEMPTS.c.number == bindparam("attempt"))
        .values({name: bindparam(name) for name in names})
    )


@cache
def _queue() -> Update:
    return (
        update(BATCHES)
        .where(BATCHES.c.seq == bindparam("batch"))
        .values(
            queued=BATCHES.c.queued + bindparam("more"),
            served=BATCHES.c.served + bindparam("served_more"),
            revision=bindparam("to"),
        )
    )
