"""The first rows of several ordered queries together, without reading more of any than needed.

A database that is asked for rows of any of several kinds in the order of their numbers either sorts
all of them or walks through all others. Each kind alone is a range of an index.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import ColumnElement, CompoundSelect, Select, literal, select, union_all
from sqlalchemy.orm import InstrumentedAttribute, Session

from drivora_service.store.chunks import batched

_BRANCHES = 60
"""Ranges that one statement reads; SQLite takes 500."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """Rows that lie side by side in an index, in the order of ``number``."""

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
        session: Where to look.
        branches: At most a few hundred; further ones cost a statement each sixty.
        limit: How many at most.
        after: Only those behind this number, in the order; ``None``: from the beginning.
        descending: Whether the greatest come first.
    """
    open_branches = list(branches)
    found: set[int] = set()
    take = limit if len(branches) <= 2 else max(16, 2 * limit // len(branches))
    while True:
        ends: list[int] = []
        for chunk in batched(open_branches, _BRANCHES):
            parts = [
                _part(index, branch, take, after, descending=descending)
                for index, branch in enumerate(chunk)
            ]
            numbers: dict[int, list[int]] = {}
            union: CompoundSelect[int, int] = union_all(*parts)
            for index, number in session.execute(union):
                numbers.setdefault(index, []).append(number)
            for rows in numbers.values():
                found.update(rows)
                if len(rows) == take:
                    ends.append(rows[-1])
        # Behind the end of a branch that was cut off something may be missing.
        known = sorted(found, reverse=descending)
        if ends:
            limit_of_knowledge = max(ends) if descending else min(ends)
            known = [
                number
                for number in known
                if (number >= limit_of_knowledge if descending else number <= limit_of_knowledge)
            ]
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
