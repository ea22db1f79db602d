"""Lists of what has changed since a position."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from typing import Any

from sqlalchemy import Select, bindparam, case, func, literal, select
from sqlalchemy.orm import Session

from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_tables import CampaignRow, StudyRow, is_campaign_of
from drivora_service.store.changes.revisions import Position, is_known, latest_position
from drivora_service.store.failures.group_tables import FailureGroupRow
from drivora_service.store.minimizations.minimization_tables import MinimizationRow
from drivora_service.store.runs.batch_repository import SINGLE_JOBS
from drivora_service.store.runs.run_tables import BatchRow, RunRow
from drivora_service.store.suites.suite_tables import SuiteRunRow

MOST_CHANGES = 500
"""Of one list."""


_ROWS = (RunRow, BatchRow, CampaignRow, StudyRow, MinimizationRow, FailureGroupRow, SuiteRunRow)


class ChangedKind(StrEnum):
    """The kinds of objects whose changes are counted."""

    RUN = "run"
    BATCH = "batch"
    CAMPAIGN = "campaign"
    STUDY = "study"
    MINIMIZATION = "minimization"
    GROUP = "group"
    """A group of failures with a decision of a user."""
    SUITE = "suite"
    """A run of a suite."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change(Shape):
    """An object that has changed, as it is now.

    Attributes:
        id: Id of the object.
        status: Status of a run or a group of failures, `failed` or `passed` of a run of a suite,
            state of another; empty for a study of which only the store knows.
        revision: Count of all changes at its newest one.
        batch_id: Batch of a run, a campaign or a minimisation, or itself; empty without one.
        campaign_id: Campaign that it is or belongs to; empty without one.
        study_id: Study that it is or belongs to; empty without one.
    """

    kind: ChangedKind
    id: str
    status: str
    revision: int
    batch_id: str = ""
    campaign_id: str = ""
    study_id: str = ""

    def is_of(self, owner_id: str) -> bool:
        """Returns whether it is, or belongs to, the batch, campaign or study of an id."""
        return owner_id in (self.id, self.batch_id, self.campaign_id, self.study_id)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeList:
    """Changes between two positions, oldest first.

    Attributes:
        changes: Each changed object once.
        position: All changes up to here are in the list.
        is_whole: Whether these are all changes there were; else more follow.
    """

    changes: tuple[Change, ...]
    position: Position
    is_whole: bool


class ChangeRepository:
    """Reads what has changed."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def latest(self) -> Position:
        """Returns the position of the newest change."""
        return latest_position(self._session)

    def is_known(self, position: Position) -> bool:
        """Returns whether what has changed after a position can be told."""
        return is_known(self._session, position)

    def has(self, object_id: str) -> bool:
        """Returns whether there is a run, batch, campaign, study or other object of an id."""
        if object_id.startswith(SINGLE_JOBS):
            return False
        return any(
            self._session.scalar(select(row.id).where(row.id == object_id)) is not None
            for row in _ROWS
        )

    def after(
        self,
        revision: int,
        kinds: Collection[ChangedKind] = tuple(ChangedKind),
        *,
        until: Position | None = None,
        limit: int = MOST_CHANGES,
    ) -> ChangeList:
        """Returns the objects that changed after a revision, oldest change first, as they are now.

        Args:
            revision: Only changes that were counted after it.
            kinds: Only objects of these kinds.
            until: Only changes up to this position; ``None``: up to the newest one.
            limit: Greatest number of changes.
        """
        # Read before the rows: a row that is changed meanwhile comes with the next list.
        newest = until or latest_position(self._session)
        values = {"after": revision, "newest": newest.revision, "limit": limit + 1}
        connection = self._session.connection()
        found = [
            Change(**{**row._mapping, "kind": kind})
            for kind in ChangedKind
            if kind in kinds
            for row in connection.execute(_query(kind), values)
        ]
        found.sort(key=lambda change: change.revision)
        if len(found) <= limit:
            return ChangeList(changes=tuple(found), position=newest, is_whole=True)
        return ChangeList(
            changes=tuple(found[:limit]),
            position=Position(epoch=newest.epoch, revision=found[limit - 1].revision),
            is_whole=False,
        )


@cache
def _query(kind: ChangedKind) -> Select[*tuple[Any, ...]]:
    """Returns the query of the changes of objects of a kind."""
    match kind:
        case ChangedKind.RUN:
            row: Any = RunRow
            is_single = BatchRow.id.startswith(SINGLE_JOBS)
            query = _columns(
                kind,
                RunRow,
                RunRow.status,
                batch_id=case((is_single, ""), else_=BatchRow.id),
                campaign_id=CampaignRow.id,
                study_id=CampaignRow.study_id,
            ).join(BatchRow, BatchRow.seq == RunRow.batch_seq)
            query = query.outerjoin(CampaignRow, is_campaign_of(BatchRow.id))
        case ChangedKind.BATCH:
            row = BatchRow
            query = (
                _columns(
                    kind,
                    BatchRow,
                    BatchRow.state,
                    batch_id=BatchRow.id,
                    campaign_id=CampaignRow.id,
                    study_id=CampaignRow.study_id,
                )
                .outerjoin(CampaignRow, is_campaign_of(BatchRow.id))
                .where(~BatchRow.id.startswith(SINGLE_JOBS))
            )
        case ChangedKind.CAMPAIGN:
            row = CampaignRow
            query = _columns(
                kind,
                CampaignRow,
                CampaignRow.state,
                batch_id=CampaignRow.batch_id,
                campaign_id=CampaignRow.id,
                study_id=CampaignRow.study_id,
            )
        case ChangedKind.STUDY:
            row = StudyRow
            query = _columns(kind, StudyRow, literal(""), study_id=StudyRow.id)
        case ChangedKind.MINIMIZATION:
            row = MinimizationRow
            query = _columns(
                kind, MinimizationRow, MinimizationRow.state, batch_id=MinimizationRow.batch_id
            )
        case ChangedKind.GROUP:
            row = FailureGroupRow
            query = _columns(kind, FailureGroupRow, FailureGroupRow.status)
        case ChangedKind.SUITE:
            row = SuiteRunRow
            query = _columns(kind, SuiteRunRow, case((SuiteRunRow.fails, "failed"), else_="passed"))
    return (
        query.where(row.revision > bindparam("after"), row.revision <= bindparam("newest"))
        .order_by(row.revision)
        .limit(bindparam("limit"))
    )


def _columns(kind: ChangedKind, row: Any, status: Any, **owners: Any) -> Select[*tuple[Any, ...]]:
    return select(
        literal(kind.value).label("kind"),
        row.id.label("id"),
        status.label("status"),
        row.revision.label("revision"),
        *(func.coalesce(column, "").label(name) for name, column in owners.items()),
    ).select_from(row)
