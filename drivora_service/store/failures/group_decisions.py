"""What people decide about groups of failures: writing it."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from drivora_service.errors import Conflict, UnknownName
from drivora_service.store.engine.ids import new_id
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.failures.group_membership import Membership, find_membership, find_row
from drivora_service.store.failures.group_records import (
    ChangedPart,
    GroupStatus,
    NewDecision,
    group_id,
)
from drivora_service.store.failures.group_tables import (
    FailureGroupChangeRow,
    FailureGroupNameRow,
    FailureGroupRow,
)

_DECIDED = (ChangedPart.STATUS, ChangedPart.LABEL, ChangedPart.ASSIGNEE, ChangedPart.NOTE)


class DecisionRepository:
    """Writes what people decide about groups of failures."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def decide(
        self, wanted: str, new: NewDecision, *, by: str = "", revision: int | None = None
    ) -> str:
        """Stores a decision about a group; returns the group's id.

        Args:
            wanted: Id of the group.
            new: The decision.
            by: Name of the user that decides.
            revision: That of the group as it was seen; ``None``: whatever it is.

        Raises:
            UnknownName: There is no such group.
            Conflict: The group was changed after it was seen.
        """
        known = find_row(self._session, wanted)
        now_at = known.revision if known else 0
        if revision is not None and now_at != revision:
            who = (known and known.changed_by) or "someone"
            raise Conflict(
                f"{who} changed the group meanwhile: its revision is {now_at}, not {revision}; "
                "read it again, and decide anew"
            )
        row, now = known or self._row_of(wanted), datetime.now(UTC)
        for part in _DECIDED:
            before, after = getattr(row, part.value), getattr(new, part.value)
            if after is None or after == before:
                continue
            setattr(row, part.value, after)
            if part is ChangedPart.STATUS:
                row.status_at = now
            self._note(row, part, before, after, by=by, at=now)
        self._session.flush()
        return row.id

    def merge(self, into: str, others: Sequence[str], *, by: str = "") -> str:
        """Puts the failures of other groups into one, also those found later; returns its id.

        Raises:
            UnknownName: There is no such group.
            Conflict: It would be merged into itself.
        """
        target, now = self._row_of(into), datetime.now(UTC)
        for wanted in others:
            other = self._row_of(wanted)
            if other.seq == target.seq:
                raise Conflict(f"group {wanted} is group {into}: name another one to merge into it")
            said = other.label or ", ".join(self._membership(other).names) or other.id
            for name in self._names(other):
                name.group_seq = target.seq
            self._session.execute(
                update(FoundRow)
                .where(FoundRow.group_seq == other.seq)
                .values(group_seq=target.seq)
                .execution_options(synchronize_session=False)
            )
            other.into_seq = target.seq
            self._note(target, ChangedPart.MERGED, "", said, by=by, at=now)
        self._session.flush()
        return target.id

    def split(
        self,
        wanted: str,
        *,
        failures: Sequence[int] = (),
        names: Sequence[str] = (),
        label: str = "",
        by: str = "",
    ) -> str:
        """Creates a group of a part of another one; returns the new group's id.

        Args:
            wanted: Id of the group.
            failures: Ids of failures in it; those found later are not among them.
            names: Names of the group whose failures are split off, also those found later.
            label: Name of the new group.
            by: Name of the user that decides.

        Raises:
            UnknownName: There is no such group, failure or name.
            Conflict: Nothing would be split off, or nothing left.
        """
        row, now = self._row_of(wanted), datetime.now(UTC)
        membership = self._membership(row)
        for name in names:
            if name not in membership.names:
                raise UnknownName("name of the group", name, membership.names)
        own = set(
            self._session.scalars(
                select(FoundRow.seq).where(membership.condition(), FoundRow.seq.in_(failures))
            )
        )
        for failure in failures:
            if failure not in own:
                raise UnknownName("failure of the group", str(failure), ())
        if not own and not names:
            raise Conflict("nothing to split off: tell which failures or names")
        new = FailureGroupRow(
            id=new_id(), label=label, status=row.status, status_at=row.status_at,
            assignee=row.assignee, note="", changed_at=now, changed_by=by,
        )  # fmt: skip
        self._session.add(new)
        self._session.flush()
        for entry in self._names(row):
            if entry.name in names:
                entry.group_seq = new.seq
        self._session.execute(
            update(FoundRow)
            .where(FoundRow.seq.in_(own))
            .values(group_seq=new.seq)
            .execution_options(synchronize_session=False)
        )
        self._session.flush()
        left = self._membership(row).condition()
        if self._session.scalar(select(FoundRow.seq).where(left).limit(1)) is None:
            raise Conflict("nothing would be left of the group: give it another label instead")
        said = ", ".join(names) or f"{len(own)} failures"
        old = row.label or ", ".join(membership.names) or row.id
        self._note(row, ChangedPart.SPLIT, said, "", by=by, at=now)
        self._note(new, ChangedPart.SPLIT, old, label or said, by=by, at=now)
        self._session.flush()
        return new.id

    def _row_of(self, wanted: str) -> FailureGroupRow:
        """Returns the row of a group, a new one if nothing was decided about it before."""
        row = find_row(self._session, wanted)
        if row is not None:
            return row
        membership = find_membership(self._session, wanted)
        if membership is None:
            raise UnknownName("group of failures", wanted, ())
        if membership.seq is not None:
            return self._session.get_one(FailureGroupRow, membership.seq)
        (name,) = membership.names
        now = datetime.now(UTC)
        row = FailureGroupRow(
            id=group_id(name), label="", status=GroupStatus.NEW, status_at=now, assignee="",
            note="", changed_at=now, changed_by="",
        )  # fmt: skip
        self._session.add(row)
        self._session.flush()
        self._session.add(FailureGroupNameRow(name=name, group_seq=row.seq))
        self._session.flush()
        return row

    def _membership(self, row: FailureGroupRow) -> Membership:
        return Membership(
            seq=row.seq, names=tuple(sorted(entry.name for entry in self._names(row)))
        )

    def _names(self, row: FailureGroupRow) -> Sequence[FailureGroupNameRow]:
        query = select(FailureGroupNameRow).where(FailureGroupNameRow.group_seq == row.seq)
        return self._session.scalars(query).all()

    def _note(
        self,
        row: FailureGroupRow,
        what: ChangedPart,
        before: str,
        after: str,
        *,
        by: str,
        at: datetime,
    ) -> None:
        row.changed_at, row.changed_by = at, by
        self._session.add(
            FailureGroupChangeRow(
                group_seq=row.seq,
                changed_at=at,
                changed_by=by,
                what=what,
                before=before,
                after=after,
            )
        )
