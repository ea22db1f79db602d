"""The first rows of several ordered queries together, reading no more of each than needed.

A database queried for rows of several kinds in the order of their numbers either sorts all of them
or scans all others. Each kind alone is a range of an index.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TypeVar

from sqlalchemy import ColumnElement, CompoundSelect, Select, literal, select, union_all
from sqlalchemy.orm import InstrumentedAttribute, Session

_B = TypeVar("_B", bound=Hashable)

_BRANCHES = 60
"""Number of ranges that one statement reads; SQLite allows 500."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """Adjacent rows of an index, in the order of ``number``."""

    number: InstrumentedAttribute[int]
    conditions: tuple[ColumnElement[bool], ...]


def first_numbers(
    session: Session,
    branches: Sequence[Branch],
    *,
    limit: int,
    after: int | None = None,
    descending: bool = False,
) -> list[int]:
    """Returns the first numbers of all branches together, each once, in their order.

    Args:
        session: Session of the transaction.
        branches: At most a few hundred; each sixty more cost a statement.
        limit: Greatest count of numbers.
        after: Only those behind this number, in the order; ``None``: from the beginning.
        descending: Whether the greatest come first.
    """

    def fetch(take: int) -> Iterable[tuple[int, int]]:
        for start in range(0, len(branches), _BRANCHES):
            parts = [
                _part(start + index, branch, take, after, descending=descending)
                for index, branch in enumerate(branches[start : start + _BRANCHES])
            ]
            union: CompoundSelect[int, int] = union_all(*parts)
            yield from ((index, number) for index, number in session.execute(union))

    return merge_branches(fetch, branches=len(branches), limit=limit, descending=descending)


def merge_branches(
    fetch: Callable[[int], Iterable[tuple[_B, int]]],
    *,
    branches: int,
    limit: int,
    descending: bool = False,
) -> list[int]:
    """Returns the first numbers of all branches together, each once, in their order.

    Args:
        fetch: Returns the given count of first numbers of every branch, each with its branch, in
            any order.
        branches: Number of branches.
        limit: Greatest count of numbers.
        descending: Whether the greatest come first.
    """
    take = limit if branches <= 2 else max(16, 2 * limit // branches)
    while True:
        numbers: dict[_B, list[int]] = {}
        for branch, number in fetch(take):
            numbers.setdefault(branch, []).append(number)
        known = sorted(set(chain.from_iterable(numbers.values())), reverse=descending)
        # After the end of a truncated branch, numbers may be missing.
        last = min if descending else max
        ends = [last(rows) for rows in numbers.values() if len(rows) == take]
        if ends:
            end = max(ends) if descending else min(ends)
            known = [n for n in known if (n >= end if descending else n <= end)]
        if not ends or len(known) >= limit:
            return known[:limit]
        take *= 4


def _part(
    index: int, branch: Branch, take: int, after: int | None, *, descending: bool
) -> Select[int, int]:
    number = branch.number
    query = select(number.label("number")).where(*branch.conditions)
    if after is not None:
        query = query.where(number < after if descending else number > after)
    rows = query.order_by(number.desc() if descending else number).limit(take).subquery()
    return select(literal(index), rows.c.number)
