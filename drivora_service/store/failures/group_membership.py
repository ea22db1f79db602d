"""Which failures are in which group, as conditions of queries."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session

from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.failures.group_records import group_id
from drivora_service.store.failures.group_tables import FailureGroupNameRow, FailureGroupRow


@dataclass(frozen=True, slots=True, kw_only=True)
class Membership:
    """What makes a failure one of a group.

    Attributes:
        seq: Of the group, if something was decided about it.
        names: Names whose failures are in it, unless they were put into another.
    """

    seq: int | None
    names: tuple[str, ...]

    def condition(self) -> ColumnElement[bool]:
        """Returns the condition that failures of the group fulfil."""
        # One name is compared, not looked up in a list: a range of the index.
        named = (
            FoundRow.group == self.names[0]
            if len(self.names) == 1
            else FoundRow.group.in_(self.names)
        ) & FoundRow.group_seq.is_(None)
        if self.seq is None:
            return named
        put = FoundRow.group_seq == self.seq
        return put | named if self.names else put


def find_membership(session: Session, wanted: str) -> Membership | None:
    """Returns what makes a failure one of the group of an id; ``None``: there is no such group."""
    row = find_row(session, wanted)
    if row is not None:
        return Membership(seq=row.seq, names=names_in(session, row.seq))
    name = next((name for name in all_names(session) if group_id(name) == wanted), None)
    if name is None:
        return None
    owner = session.get(FailureGroupNameRow, name)
    if owner is None:
        return Membership(seq=None, names=(name,))
    return Membership(seq=owner.group_seq, names=names_in(session, owner.group_seq))


def find_row(session: Session, wanted: str) -> FailureGroupRow | None:
    """Returns the row of a group, or of that which it was merged into; ``None``: there is none."""
    row = session.scalar(select(FailureGroupRow).where(FailureGroupRow.id == wanted))
    while row is not None and row.into_seq is not None:
        row = session.get_one(FailureGroupRow, row.into_seq)
    return row


def names_in(session: Session, seq: int) -> tuple[str, ...]:
    """Returns the names whose failures are in a group, in alphabetical order."""
    query = select(FailureGroupNameRow.name).where(FailureGroupNameRow.group_seq == seq)
    return tuple(sorted(session.scalars(query)))


def owners_of_names(session: Session) -> Mapping[str, int]:
    """Returns the ``seq`` of the groups that names are in; others have groups of their own."""
    rows = session.execute(select(FailureGroupNameRow.name, FailureGroupNameRow.group_seq))
    return {row.name: row.group_seq for row in rows}


def all_names(session: Session) -> tuple[str, ...]:
    """Returns the names of all failures in alphabetical order.

    It steps through the index from one name to the next: there are few, of many failures.
    """
    first = select(func.min(FoundRow.group).label("name")).cte("names", recursive=True)
    following = (
        select(func.min(FoundRow.group)).where(FoundRow.group > first.c.name).scalar_subquery()
    )
    names = first.union_all(select(following).where(first.c.name.is_not(None)))
    found = session.scalars(select(names.c.name))
    return tuple(name for name in found if name is not None)
