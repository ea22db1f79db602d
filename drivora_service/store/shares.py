"""Dividing the runs that are claimed among the batches."""

from __future__ import annotations

import heapq
from collections.abc import Mapping
from functools import cache
from typing import Any

from sqlalchemy import Select, bindparam, literal_column, select
from sqlalchemy.orm import Session

from drivora_service.store.held_runs import HeldRuns
from drivora_service.store.plain_statements import Row
from drivora_service.store.records import BatchState
from drivora_service.store.run_statements import BATCHES


def shares_of_batches(
    session: Session, limit: int, numbers: Mapping[int, int], reserved_to: str
) -> dict[int, int]:
    """Divides ``limit`` runs among the batches: one each in turn, least served first.

    Args:
        session: Session of the transaction.
        limit: Number of runs.
        numbers: Numbers of held runs by the ``seq`` of their batch; they are left out.
        reserved_to: Process for which the runs are reserved; "": runs of any server.

    Returns:
        Numbers of runs by the ``seq`` of their batch.
    """
    query, values = _claimable(session, numbers, reserved_to)
    candidates = session.connection().execute(
        query.limit(bindparam("most")).with_for_update() if numbers else _first_claimable(),
        values | {"most": limit},
    )
    heap = [
        (priority, served, seq, queued - numbers.get(seq, 0))
        for seq, priority, served, queued in candidates
    ]
    taken = {seq: 0 for _, _, seq, _ in heap}
    for _ in range(limit):
        if not heap:
            break
        priority, served, seq, left = heap[0]
        taken[seq] += 1
        if left > 1:
            heapq.heapreplace(heap, (priority, served + 1, seq, left - 1))
        else:
            heapq.heappop(heap)
    return {seq: share for seq, share in taken.items() if share}


def has_claimable(session: Session, numbers: Mapping[int, int], reserved_to: str) -> bool:
    """Returns whether a batch has queued runs that may be claimed, held ones left out."""
    query, values = _claimable(session, numbers, reserved_to)
    first = query.limit(bindparam("most")) if numbers else _first_claimable()
    return session.connection().execute(first, values | {"most": 1}).first() is not None


def _claimable(
    session: Session, numbers: Mapping[int, int], reserved_to: str
) -> tuple[Select[Any], Row]:
    """Returns the query for the batches with runs that are not held, and its values."""
    values: Row = {"owner": reserved_to}
    query = _open_batches()
    if numbers:
        # Seldom, so that this query need not be kept.
        query = query.where(HeldRuns(session).others(numbers))
    return query, values


@cache
def _first_claimable() -> Select[Any]:
    return _open_batches().limit(bindparam("most")).with_for_update()


@cache
def _open_batches() -> Select[Any]:
    # Constants in the text, as in the index of these batches.
    return (
        select(BATCHES.c.seq, BATCHES.c.priority, BATCHES.c.served, BATCHES.c.queued)
        .where(
            BATCHES.c.queued > literal_column("0"),
            BATCHES.c.state == literal_column(f"'{BatchState.OPEN}'"),
            BATCHES.c.owner_id == bindparam("owner"),
        )
        .order_by(BATCHES.c.priority, BATCHES.c.served, BATCHES.c.seq)
    )
