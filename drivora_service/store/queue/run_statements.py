"""The statements that change runs, attempts and batches of the queue, each made once."""

from __future__ import annotations

from functools import cache
from typing import Any, cast

from sqlalchemy import Insert, Table, Update, bindparam, func, insert, literal_column, null, update

from drivora_service.store.queue.queued_runs import ATTEMPTS, RUNS
from drivora_service.store.runs.run_tables import BatchRow, ReportRow, VerdictRow

BATCHES = cast("Table", BatchRow.__table__)
_REPORTS = cast("Table", ReportRow.__table__)
_VERDICTS = cast("Table", VerdictRow.__table__)


def _update_run(*names: str, **changes: Any) -> Update:
    """Returns the change of a run: of the columns named like their parameters, and others."""
    values = {name: bindparam(name) for name in names} | changes
    return update(RUNS).where(RUNS.c.seq == bindparam("run")).values(values)


@cache
def start_run() -> Update:
    """Returns the start of a run, from ``now`` on unless it was started before."""
    now = bindparam("now", type_=RUNS.c.started_at.type)
    return _update_run(
        "revision",
        "status",
        "facet",
        # The number of the attempt that is opened with it.
        attempts=RUNS.c.attempts + literal_column("1"),
        started_at=func.coalesce(RUNS.c.started_at, now),
    )


@cache
def queue_run_again() -> Update:
    """Returns the return of a run to the queue."""
    # Without cancel_requested, here and at its end: only requests set it.
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
def end_run() -> Update:
    """Returns the end of a run."""
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
        "failures",
        "accountability",
        "steps",
        "sim_time_s",
        "wall_time_s",
        # An ended run leaves the index of held runs, which is small.
        not_before=null(),
    )


@cache
def open_attempt() -> Insert:
    """Returns the insertion of an attempt."""
    return insert(ATTEMPTS)


@cache
def insert_report() -> Insert:
    """Returns the insertion of a report."""
    return insert(_REPORTS)


@cache
def insert_verdict() -> Insert:
    """Returns the insertion of a verdict."""
    return insert(_VERDICTS)


@cache
def close_attempt() -> Update:
    """Returns the end of ``attempt`` at ``run``."""
    names = ("outcome", "ended_at", "cause", "log", "worker", "started_at", "signal")
    # By its number, which its owner has read from the open attempt in the same transaction.
    return (
        update(ATTEMPTS)
        .where(ATTEMPTS.c.run_seq == bindparam("run"), ATTEMPTS.c.number == bindparam("attempt"))
        .values({name: bindparam(name) for name in names})
    )


@cache
def count_queued() -> Update:
    """Returns the change of a batch whose runs were queued or claimed."""
    return (
        update(BATCHES)
        .where(BATCHES.c.seq == bindparam("batch"))
        # Differences, not values: the columns of a batch are not read where its runs are changed.
        .values(
            queued=BATCHES.c.queued + bindparam("more"),
            served=BATCHES.c.served + bindparam("served_more"),
            revision=bindparam("to"),
        )
    )
