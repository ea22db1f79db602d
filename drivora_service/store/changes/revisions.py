"""The count of changes, which orders everything that happens to what a service keeps.

That is runs, batches, campaigns, studies, minimisations, groups of failures and
runs of suites.

Every transaction that changes what is shown of such an object gives it the next number of the count
as its ``revision``. The count only grows, also when the newest object is deleted. Rows that the ORM
writes get their revision with the flush; statements that change many rows at once, which no flush
sees, call :func:`next_revisions` themselves.

The count belongs to an epoch, which begins with every process that takes runs. A position is an
epoch and a number of its count: a position of another database, or of changes that were lost when a
backup was restored, is thereby known to be foreign.
"""

from __future__ import annotations

import re
import secrets
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import cast

from sqlalchemy import Select, Table, Update, bindparam, delete, func, select, update
from sqlalchemy.orm import Session
from sqlalchemy.orm.attributes import flag_modified

from drivora_service.store.campaigns.campaign_tables import (
    CampaignRow,
    FailureKindRow,
    FailureRow,
    StudyRow,
)
from drivora_service.store.engine.base_tables import EpochRow
from drivora_service.store.engine.plain_statements import execute_many
from drivora_service.store.failures.group_tables import FailureGroupRow
from drivora_service.store.minimizations.minimization_tables import MinimizationRow
from drivora_service.store.runs.run_tables import BatchRow, RunRow
from drivora_service.store.suites.suite_tables import SuiteRunRow

_EPOCHS = cast("Table", EpochRow.__table__)
_BATCHES = cast("Table", BatchRow.__table__)
_KEPT = 1000
"""Epochs in which a position is known."""

_POSITION = re.compile(r"([0-9a-f]{12})\.([0-9]{1,15})|([0-9]{1,15})")

Revised = (
    RunRow | BatchRow | CampaignRow | StudyRow | MinimizationRow | FailureGroupRow | SuiteRunRow
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Position:
    """A place in the order of all changes.

    Attributes:
        epoch: Id of the epoch; "": not told, so that only the number is compared.
        revision: Number of the count.
    """

    epoch: str
    revision: int

    def __str__(self) -> str:
        """Returns the position as text, which :func:`read_position` reads."""
        return f"{self.epoch}.{self.revision}" if self.epoch else str(self.revision)


def read_position(text: str) -> Position | None:
    """Reads a position, or a number alone; ``None``: it is neither."""
    found = _POSITION.fullmatch(text)
    if found is None:
        return None
    epoch, counted, alone = found.groups()
    return Position(epoch=epoch or "", revision=int(alone if epoch is None else counted))


def next_revisions(session: Session, number: int) -> int:
    """Counts ``number`` changes and returns the revision of the first of them."""
    last: int = session.connection().execute(_count(), {"number": number}).scalar_one()
    return last - number + 1


def latest_position(session: Session) -> Position:
    """Returns the position of the newest change."""
    row = session.connection().execute(_latest()).one()
    return Position(epoch=row.id, revision=row.last)


def latest_revision(session: Session) -> int:
    """Returns the revision of the newest change, 0 if there was none."""
    return latest_position(session).revision


def is_known(session: Session, position: Position) -> bool:
    """Returns whether all changes after a position are those of this database's own history."""
    if not position.epoch:
        return position.revision <= latest_revision(session)
    last = session.scalar(select(EpochRow.last).where(EpochRow.id == position.epoch))
    return last is not None and position.revision <= last


def begin_epoch(session: Session) -> None:
    """Inserts the epoch of a process that starts, at the present count, and deletes old ones."""
    newest = latest_position(session)
    row = EpochRow(id=new_epoch(), last=newest.revision)
    session.add(row)
    session.flush()
    session.execute(delete(EpochRow).where(EpochRow.seq <= row.seq - _KEPT))


def new_epoch() -> str:
    """Returns the id of a new epoch."""
    return secrets.token_hex(6)


def revise_batches(session: Session, batch_seqs: Iterable[int], first: int) -> None:
    """Sets the revisions of batches, for statements that no flush sees.

    Args:
        session: Session of the transaction.
        batch_seqs: The ``seq`` of each.
        first: Revision of the first one; the others follow.
    """
    rows = [
        {"batch": seq, "to": revision} for revision, seq in enumerate(sorted(batch_seqs), first)
    ]
    execute_many(session.connection(), _revise_batch(), rows)


def revise_campaign(session: Session, campaign_seq: int) -> None:
    """Sets the revision of a campaign with the next flush, for statements that no flush sees."""
    flag_modified(session.get_one(CampaignRow, campaign_seq), "revision")


def revise(session: Session, *_: object) -> None:
    """Sets the revisions of the rows of a flush; a listener of ``before_flush``."""
    changed: dict[Revised, None] = {}
    for row in (*session.new, *session.dirty):
        if isinstance(row, Revised | FailureRow | FailureKindRow) and session.is_modified(row):
            for shown in _find_affected(session, row):
                changed[shown] = None
    if changed:
        for revision, shown in enumerate(changed, next_revisions(session, len(changed))):
            shown.revision = revision


def _find_affected(
    session: Session, row: Revised | FailureRow | FailureKindRow
) -> tuple[Revised, ...]:
    """Returns what is shown differently because a row changes."""
    match row:
        case RunRow():
            return row, session.get_one(BatchRow, row.batch_seq)
        case FailureRow() | FailureKindRow():
            return _find_affected(session, session.get_one(CampaignRow, row.campaign_seq))
        case CampaignRow(study_id=study_id) if study_id:
            study = session.scalar(select(StudyRow).where(StudyRow.id == study_id))
            return (row,) if study is None else (row, study)
        case _:
            return (row,)


@cache
def _count() -> Update:
    newest = select(func.max(_EPOCHS.c.seq)).scalar_subquery()
    return (
        update(_EPOCHS)
        .where(_EPOCHS.c.seq == newest)
        .values(last=_EPOCHS.c.last + bindparam("number"))
        .returning(_EPOCHS.c.last)
    )


@cache
def _latest() -> Select[str, int]:
    return select(EpochRow.id, EpochRow.last).order_by(EpochRow.seq.desc()).limit(1)


@cache
def _revise_batch() -> Update:
    return (
        update(_BATCHES)
        .where(_BATCHES.c.seq == bindparam("batch"))
        .values(revision=bindparam("to"))
    )
