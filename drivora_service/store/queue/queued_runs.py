"""Runs in the queue: the columns on which their changes depend, and the queries for them."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from functools import cache, lru_cache
from typing import Any, NamedTuple, cast

from sqlalchemy import ColumnElement, Select, Table, bindparam, literal_column, select

from drivora_service.runs.lifecycle import RunState
from drivora_service.runs.run_report import RunStatus
from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.runs.run_tables import AttemptRow, RunRow

RUNS = cast("Table", RunRow.__table__)
ATTEMPTS = cast("Table", AttemptRow.__table__)
_DOCUMENTS = cast("Table", DocumentRow.__table__)

QUEUED: ColumnElement[str] = literal_column(f"'{RunStatus.QUEUED}'")
RUNNING: ColumnElement[str] = literal_column(f"'{RunStatus.RUNNING}'")
"""Statuses as constants in the text of statements, as in the conditions of indexes: for a value,
SQLite would plan the statement anew at each execution."""


class QueuedRun(NamedTuple):
    """The columns of a run without a result on which its changes depend.

    A tuple, as every run in the queue is read as one twice, at its start and at its end.
    """

    seq: int
    id: str
    batch_seq: int
    document_sha256: str
    agent: str
    configuration: str
    configuration_id: str
    town: str
    keeps_trace: bool
    definition: str
    attempts: int
    not_before: datetime | None
    state: RunState


QUEUED_RUN = (
    RUNS.c.seq,
    RUNS.c.id,
    RUNS.c.batch_seq,
    RUNS.c.document_sha256,
    RUNS.c.agent,
    RUNS.c.configuration,
    RUNS.c.configuration_id,
    RUNS.c.town,
    RUNS.c.keeps_trace,
    RUNS.c.definition,
    RUNS.c.attempts,
    RUNS.c.not_before,
    RUNS.c.status,
    RUNS.c.infrastructure_failures,
    RUNS.c.crashes,
    RUNS.c.interruptions,
    RUNS.c.cancel_requested,
)
"""The columns that :func:`read_queued_run` reads."""


def read_queued_run(values: Sequence[Any]) -> QueuedRun:
    """Returns a run read from the first columns of a row, which are :data:`QUEUED_RUN`."""
    # The first twelve are the run's own; the last five are its state in the life cycle.
    return QueuedRun._make((*values[:12], _state(*values[12:17])))


@lru_cache(maxsize=512)
def _state(status: str, failures: int, crashes: int, interruptions: int, cancel: bool) -> RunState:
    """Returns a state in the life cycle, of which most runs have one of few."""
    return RunState(
        status=RunStatus(status),
        infrastructure_failures=failures,
        crashes=crashes,
        interruptions=interruptions,
        cancel_requested=cancel,
    )


@cache
def _select_queued() -> Select[Any]:
    return (
        select(
            *QUEUED_RUN,
            RUNS.c.agent_override,
            RUNS.c.seed_override,
            RUNS.c.feedback,
            RUNS.c.candidate,
            _DOCUMENTS.c.body,
        )
        .join(_DOCUMENTS, _DOCUMENTS.c.sha256 == RUNS.c.document_sha256)
        .where(RUNS.c.status == QUEUED)
        # Left out in SQLite. In PostgreSQL there is nothing to skip, as writers take turns
        # (decision 69).
        .with_for_update(skip_locked=True, of=RUNS)
    )


@cache
def first_runs() -> Select[Any]:
    """Returns the query for ``share`` queued runs of ``batch``, held runs left out."""
    return (
        _select_queued()
        # Held runs have a not_before, also once their wait is over: they are started one at a time.
        .where(RUNS.c.batch_seq == bindparam("batch"), RUNS.c.not_before.is_(None))
        .order_by(RUNS.c.seq)
        .limit(bindparam("share"))
    )


@cache
def one_run() -> Select[Any]:
    """Returns the query for a queued run by its ``seq``, ``run``."""
    return _select_queued().where(RUNS.c.seq == bindparam("run"))


@cache
def leases_of_owner() -> Select[Any]:
    """Returns the query for the runs that ``owner`` has leased, with the attempts' numbers."""
    return (
        select(*QUEUED_RUN, ATTEMPTS.c.number)
        .join(ATTEMPTS, ATTEMPTS.c.run_seq == RUNS.c.seq)
        # The open attempt is the lease; at most one attempt of a run is open, as a claim opens one
        # of a queued run only, and every way back to the queue closes it.
        .where(
            ATTEMPTS.c.owner_id == bindparam("owner"),
            ATTEMPTS.c.ended_at.is_(None),
            RUNS.c.status == RUNNING,
        )
    )


@cache
def leases_of_runs() -> Select[Any]:
    """Returns the query for those of ``run_ids`` that ``owner`` has leased."""
    return leases_of_owner().where(RUNS.c.id.in_(bindparam("run_ids", expanding=True)))


@cache
def runs_to_cancel() -> Select[str]:
    """Returns the query for the ids of the running runs that have a request to cancel."""
    return select(RUNS.c.id).where(RUNS.c.status == RUNNING, RUNS.c.cancel_requested)
