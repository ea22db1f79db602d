"""Dividing the runs that are claimed among the batches."""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from sqlalchemy import Select, bindparam, literal_column, select
from sqlalchemy.orm import Session

from drivora_service.store.queue.held_runs import HeldRuns
from drivora_service.store.queue.run_statements import BATCHES
from drivora_service.store.runs.run_records import BatchState


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
    # The first ``limit`` batches are enough: a batch behind them is taken from only after each of
    # them has given a run, when nothing is left to divide.
    candidates = _claimable(session, limit, numbers, reserved_to, locks=True)
    # In the order of the query, and therefore a heap already. A run that is taken counts as served,
    # so that a batch moves behind its equals: with equal priority they take turns, however many
    # runs each has.
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
        # An empty batch leaves its turns to the others.
        if left > 1:
            heapq.heapreplace(heap, (priority, served + 1, seq, left - 1))
        else:
            heapq.heappop(heap)
    return {seq: share for seq, share in taken.items() if share}


def has_claimable(session: Session, numbers: Mapping[int, int], reserved_to: str) -> bool:
    """Returns whether a batch has queued runs that may be claimed, held ones left out."""
    return bool(_claimable(session, 1, numbers, reserved_to, locks=False))


def _claimable(
    session: Session, most: int, numbers: Mapping[int, int], reserved_to: str, *, locks: bool
) -> Sequence[Any]:
    """Returns the first ``most`` batches with runs that are not held.

    Each is its ``seq``, priority, number of served runs and number of queued runs.
    """
    query = _open_batches(locks=locks)
    if numbers:
        # Few batches have held runs, if any: this query need not be kept.
        query = query.where(HeldRuns(session).others(numbers))
    return session.connection().execute(query, {"owner": reserved_to, "most": most}).all()


@cache
def _open_batches(*, locks: bool) -> Select[Any]:
    """Returns the query for the first ``most`` batches with queued runs, reserved to ``owner``."""
    # Constants in the text, as in the condition of the index that holds just these batches, in the
    # order below: with parameters, SQLite would plan the query anew at each execution.
    query = (
        select(BATCHES.c.seq, BATCHES.c.priority, BATCHES.c.served, BATCHES.c.queued)
        .where(
            BATCHES.c.queued > literal_column("0"),
            BATCHES.c.state == literal_column(f"'{BatchState.OPEN}'"),
            BATCHES.c.owner_id == bindparam("owner"),
        )
        .order_by(BATCHES.c.priority, BATCHES.c.served, BATCHES.c.seq)
        .limit(bindparam("most"))
    )
    return query.with_for_update() if locks else query
