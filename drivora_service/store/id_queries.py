"""Queries for the ids of stored things, by kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from drivora_service.store.campaigns.campaign_tables import CampaignRow, StudyRow
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.failures.group_lists import GroupRepository
from drivora_service.store.failures.group_records import GroupFilter
from drivora_service.store.id_records import FoundId, IdKind
from drivora_service.store.minimizations.minimization_tables import MinimizationRow
from drivora_service.store.runs.batch_repository import SINGLE_JOBS
from drivora_service.store.runs.run_tables import BatchRow, RunRow
from drivora_service.store.suites.suite_tables import SuiteRunRow

_GROUPS_OF_A_PAGE = 500


class IdQueries(Protocol):
    """Queries of one kind; of many results, the newest come first."""

    def of_id(self, wanted: str) -> Sequence[FoundId]:
        """Returns the thing of an id."""
        ...

    def of_name(self, wanted: str, limit: int) -> Sequence[FoundId]:
        """Returns things of a name, at most so many."""
        ...

    def of_prefix(self, wanted: str, limit: int) -> Sequence[FoundId]:
        """Returns things whose ids begin with digits, at most so many."""
        ...

    def newest(self, limit: int) -> Sequence[FoundId]:
        """Returns so many of the newest things."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class _TableQueries:
    """Of a kind with a table of its own."""

    session: Session
    kind: IdKind
    row: Any
    name: InstrumentedAttribute[str] | None
    conditions: tuple[ColumnElement[bool], ...] = ()

    def of_id(self, wanted: str) -> Sequence[FoundId]:
        return self._select(1, self.row.id == wanted)

    def of_name(self, wanted: str, limit: int) -> Sequence[FoundId]:
        return () if self.name is None else self._select(limit, self.name == wanted)

    def of_prefix(self, wanted: str, limit: int) -> Sequence[FoundId]:
        # A range, which every index answers; "g" comes after all hexadecimal digits.
        between = (self.row.id >= wanted, self.row.id < f"{wanted}g")
        return self._select(limit, *between)

    def newest(self, limit: int) -> Sequence[FoundId]:
        return self._select(limit)

    def _select(self, limit: int, *conditions: ColumnElement[bool]) -> Sequence[FoundId]:
        columns = [self.row.id, self.row.created_at] + ([self.name] if self.name else [])
        rows = self.session.execute(
            select(*columns)
            .where(*self.conditions, *conditions)
            .order_by(self.row.seq.desc())
            .limit(limit)
        )
        return [
            FoundId(kind=self.kind, id=id_, name="".join(name), created_at=created)
            for id_, created, *name in rows
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class _ListQueries:
    """Of a kind that has few, without a table of their own: all of them, the newest first.

    Attributes:
        things: All of them.
        names: The names of each, the one that is shown first.
    """

    things: Sequence[FoundId]
    names: Sequence[Sequence[str]]

    def of_id(self, wanted: str) -> Sequence[FoundId]:
        return [one for one in self.things if one.id == wanted]

    def of_name(self, wanted: str, limit: int) -> Sequence[FoundId]:
        pairs = zip(self.things, self.names, strict=True)
        return [one for one, names in pairs if wanted in names][:limit]

    def of_prefix(self, wanted: str, limit: int) -> Sequence[FoundId]:
        return [one for one in self.things if one.id.startswith(wanted)][:limit]

    def newest(self, limit: int) -> Sequence[FoundId]:
        return self.things[:limit]


def queries_of(session: Session, kind: IdKind) -> IdQueries:
    """Returns the queries for things of a kind."""
    match kind:
        case IdKind.RUN:
            return _TableQueries(session=session, kind=kind, row=RunRow, name=RunRow.label)
        case IdKind.BATCH:
            shown = ~BatchRow.id.startswith(SINGLE_JOBS)
            return _TableQueries(
                session=session, kind=kind, row=BatchRow, name=BatchRow.name, conditions=(shown,)
            )
        case IdKind.CAMPAIGN:
            return _TableQueries(session=session, kind=kind, row=CampaignRow, name=CampaignRow.name)
        case IdKind.STUDY:
            return _TableQueries(session=session, kind=kind, row=StudyRow, name=StudyRow.name)
        case IdKind.SUITE_RUN:
            return _TableQueries(
                session=session, kind=kind, row=SuiteRunRow, name=SuiteRunRow.suite
            )
        case IdKind.MINIMIZATION:
            return _TableQueries(session=session, kind=kind, row=MinimizationRow, name=None)
        case IdKind.FAILURE_GROUP:
            return _groups(session)
        case IdKind.CONFIGURATION:
            return _configurations(session)


def _groups(session: Session) -> _ListQueries:
    """Returns all groups of failures, the last seen first, by their labels and names."""
    every = GroupFilter(failures=FoundFilter(all_kept=True))
    things, names, token = [], [], ""
    while True:
        page = GroupRepository(session).page(every, limit=_GROUPS_OF_A_PAGE, page_token=token)
        for one in page.items:
            shown = one.label or "; ".join(one.names)
            things.append(
                FoundId(kind=IdKind.FAILURE_GROUP, id=one.id, name=shown, created_at=one.last_seen)
            )
            names.append((shown, *one.names))
        token = page.next_page_token
        if not token:
            return _ListQueries(things=things, names=names)


def _configurations(session: Session) -> _ListQueries:
    """Returns the configurations that have driven runs or campaigns, the last used first."""
    last: dict[str, FoundId] = {}
    for row in (RunRow, CampaignRow):
        query = (
            select(row.configuration_id, row.configuration, func.max(row.created_at))
            .where(row.configuration_id != "")
            .group_by(row.configuration_id, row.configuration)
        )
        for id_, words, used in session.execute(query):
            known = last.get(id_)
            if known is None or used > known.created_at:
                last[id_] = FoundId(kind=IdKind.CONFIGURATION, id=id_, name=words, created_at=used)
    things = sorted(last.values(), key=lambda one: one.created_at, reverse=True)
    return _ListQueries(
        things=things,
        names=[(one.name,) for one in things],
    )
