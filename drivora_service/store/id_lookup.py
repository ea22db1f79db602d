"""Finding the id of a stored thing by its name, by a prefix of its id, or as the newest."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC
from difflib import get_close_matches
from typing import Any

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from drivora_service.errors import AmbiguousName, UnknownName
from drivora_service.store.campaigns.campaign_tables import CampaignRow, StudyRow
from drivora_service.store.campaigns.evaluation_runs import EvaluationId
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.failures.group_lists import GroupRepository
from drivora_service.store.failures.group_records import GroupFilter
from drivora_service.store.id_records import LATEST, FoundId, IdKind
from drivora_service.store.minimizations.minimization_tables import MinimizationRow
from drivora_service.store.runs.batch_repository import SINGLE_JOBS
from drivora_service.store.runs.run_tables import BatchRow, RunRow
from drivora_service.store.suites.suite_tables import SuiteRunRow

_MOST_NAMED = 10
"""Number of candidates that an error lists."""
_MOST_SEARCHED, _MOST_NEAR = 200, 3
"""Number of the newest names in which similar ones are sought, and of those that are shown."""
_GROUPS_OF_A_PAGE = 500

_PREFIX = re.compile(r"[0-9a-f]{1,24}")
_EVALUATION = re.compile(r"(?P<campaign>.+)-(?P<number>\d{1,9})")

_RUN_SOMETHING = "run scenarios with `drivora run SCENARIO`"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Kind:
    """How a kind is called, and what creates and lists things of it."""

    words: str
    plural: str
    start: str
    listing: str = ""


_KINDS: Mapping[IdKind, _Kind] = {
    IdKind.RUN: _Kind(
        words="run", plural="runs", start=_RUN_SOMETHING, listing="drivora runs list"
    ),
    IdKind.BATCH: _Kind(
        words="batch", plural="batches", start=_RUN_SOMETHING, listing="drivora batches list"
    ),
    IdKind.CAMPAIGN: _Kind(
        words="campaign",
        plural="campaigns",
        start="start one with `drivora campaign run FILE`",
        listing="drivora campaign list",
    ),
    IdKind.STUDY: _Kind(
        words="study",
        plural="studies",
        start="start one with `drivora study run FILE`",
        listing="drivora study list",
    ),
    IdKind.SUITE_RUN: _Kind(
        words="run of a suite",
        plural="runs of suites",
        start="run one with `drivora suite run SUITE`",
        listing="drivora suite history",
    ),
    IdKind.MINIMIZATION: _Kind(
        words="minimisation",
        plural="minimisations",
        start="start one with `drivora minimize RUN`",
    ),
    IdKind.FAILURE_GROUP: _Kind(
        words="group of failures",
        plural="groups of failures",
        start=f"{_RUN_SOMETHING}, or search with `drivora campaign run FILE`",
        listing="drivora failures groups",
    ),
    IdKind.CONFIGURATION: _Kind(
        words="configuration", plural="configurations", start=_RUN_SOMETHING
    ),
}


def find_id(
    session: Session, kinds: Sequence[IdKind], wanted: str, *, newest_of_name: bool = False
) -> FoundId:
    """Returns the one stored thing of some kinds that a text means.

    The text is an id; ``latest``, the newest; a name that one of them has; the beginning of the id
    of one; or, for runs, ``CAMPAIGN-EVALUATION``, where the campaign may be named in these ways.
    The first of these that fits counts.

    Args:
        session: Session of the transaction.
        kinds: Kinds that are meant, at least one.
        wanted: The text.
        newest_of_name: Whether a name that several have means the newest of them.

    Raises:
        UnknownName: None fits.
        AmbiguousName: Several have this name, or ids that begin so.
    """
    lookups = [_lookup(session, kind) for kind in kinds]
    found = _first(one for lookup in lookups for one in lookup.of_id(wanted))
    if found is None and wanted == LATEST:
        newest = [one for lookup in lookups for one in lookup.newest(1)]
        found = max(newest, key=lambda one: one.created_at, default=None)
    if found is None and wanted and wanted != LATEST:
        found = (
            _named(kinds, wanted, lookups, newest=newest_of_name)
            or _evaluation(session, kinds, wanted)
            or _only(
                kinds, wanted, "the beginning of the ids of", list(_of_prefix(lookups, wanted))
            )
        )
    if found is None:
        raise _unknown(kinds, wanted, lookups)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _Lookup:
    """Queries of one kind; of many results, the newest come first."""

    session: Session
    kind: IdKind

    def of_id(self, wanted: str) -> Sequence[FoundId]:
        raise NotImplementedError

    def of_name(self, wanted: str) -> Sequence[FoundId]:
        raise NotImplementedError

    def of_prefix(self, wanted: str) -> Sequence[FoundId]:
        raise NotImplementedError

    def newest(self, limit: int) -> Sequence[FoundId]:
        raise NotImplementedError


@dataclass(frozen=True, slots=True, kw_only=True)
class _Rows(_Lookup):
    """Of a kind with a table of its own."""

    row: Any
    name: InstrumentedAttribute[str] | None
    conditions: tuple[ColumnElement[bool], ...] = ()

    def of_id(self, wanted: str) -> Sequence[FoundId]:
        return self._select(1, self.row.id == wanted)

    def of_name(self, wanted: str) -> Sequence[FoundId]:
        return () if self.name is None else self._select(_MOST_NAMED + 1, self.name == wanted)

    def of_prefix(self, wanted: str) -> Sequence[FoundId]:
        # A range, which every index answers; "g" comes after all hexadecimal digits.
        between = (self.row.id >= wanted, self.row.id < f"{wanted}g")
        return self._select(_MOST_NAMED + 1, *between)

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
class _Listed(_Lookup):
    """Of a kind that has few, without a table of their own: all of them, the newest first.

    Attributes:
        things: All of them.
        names: The names of each, the one that is shown first.
    """

    things: Sequence[FoundId]
    names: Sequence[Sequence[str]]

    def of_id(self, wanted: str) -> Sequence[FoundId]:
        return [one for one in self.things if one.id == wanted]

    def of_name(self, wanted: str) -> Sequence[FoundId]:
        pairs = zip(self.things, self.names, strict=True)
        return [one for one, names in pairs if wanted in names]

    def of_prefix(self, wanted: str) -> Sequence[FoundId]:
        return [one for one in self.things if one.id.startswith(wanted)]

    def newest(self, limit: int) -> Sequence[FoundId]:
        return self.things[:limit]


def _lookup(session: Session, kind: IdKind) -> _Lookup:
    match kind:
        case IdKind.RUN:
            return _Rows(session=session, kind=kind, row=RunRow, name=RunRow.label)
        case IdKind.BATCH:
            shown = ~BatchRow.id.startswith(SINGLE_JOBS)
            return _Rows(
                session=session, kind=kind, row=BatchRow, name=BatchRow.name, conditions=(shown,)
            )
        case IdKind.CAMPAIGN:
            return _Rows(session=session, kind=kind, row=CampaignRow, name=CampaignRow.name)
        case IdKind.STUDY:
            return _Rows(session=session, kind=kind, row=StudyRow, name=StudyRow.name)
        case IdKind.SUITE_RUN:
            return _Rows(session=session, kind=kind, row=SuiteRunRow, name=SuiteRunRow.suite)
        case IdKind.MINIMIZATION:
            return _Rows(session=session, kind=kind, row=MinimizationRow, name=None)
        case IdKind.FAILURE_GROUP:
            return _groups(session)
        case IdKind.CONFIGURATION:
            return _configurations(session)


def _groups(session: Session) -> _Listed:
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
            return _Listed(session=session, kind=IdKind.FAILURE_GROUP, things=things, names=names)


def _configurations(session: Session) -> _Listed:
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
    return _Listed(
        session=session,
        kind=IdKind.CONFIGURATION,
        things=things,
        names=[(one.name,) for one in things],
    )


def _named(
    kinds: Sequence[IdKind], wanted: str, lookups: Sequence[_Lookup], *, newest: bool
) -> FoundId | None:
    found = [one for lookup in lookups for one in lookup.of_name(wanted)]
    if newest:
        return max(found, key=lambda one: one.created_at, default=None)
    return _only(kinds, wanted, "the name of", found)


def _of_prefix(lookups: Sequence[_Lookup], wanted: str) -> Iterator[FoundId]:
    if _PREFIX.fullmatch(wanted):
        for lookup in lookups:
            yield from lookup.of_prefix(wanted)


def _evaluation(session: Session, kinds: Sequence[IdKind], wanted: str) -> FoundId | None:
    """Returns the run of an evaluation whose campaign is named; ``None``: no campaign is."""
    named = _EVALUATION.fullmatch(wanted)
    if IdKind.RUN not in kinds or named is None:
        return None
    try:
        campaign = find_id(session, [IdKind.CAMPAIGN], named["campaign"])
    except UnknownName:
        return None
    number = int(named["number"])
    return replace(
        campaign,
        kind=IdKind.RUN,
        id=EvaluationId(campaign.id, number).run_id,
        name=f"{campaign.name} #{number}",
    )


def _first(found: Iterator[FoundId]) -> FoundId | None:
    return next(found, None)


def _only(
    kinds: Sequence[IdKind], wanted: str, what: str, found: Sequence[FoundId]
) -> FoundId | None:
    """Returns the only candidate; ``None``: there is none.

    Raises:
        AmbiguousName: There are several.
    """
    if len(found) <= 1:
        return found[0] if found else None
    shown = sorted(found, key=lambda one: one.created_at, reverse=True)[:_MOST_NAMED]
    several = len(kinds) > 1
    lines = [_line(one, with_kind=several) for one in shown]
    number = str(len(found)) if len(found) <= _MOST_NAMED else f"more than {_MOST_NAMED}"
    if len(found) > _MOST_NAMED:
        lines.append("…")
    things = "" if several else f" {_KINDS[kinds[0]].plural}"
    raise AmbiguousName(
        f"{wanted!r} is {what} {number}{things}. Give the id of one, or its first digits:",
        tuple(lines),
    )


def _unknown(kinds: Sequence[IdKind], wanted: str, lookups: Sequence[_Lookup]) -> UnknownName:
    """Returns the error for a text that means nothing, with what might be meant."""
    words = " or ".join(_KINDS[kind].words for kind in kinds)
    known = [one for lookup in lookups for one in lookup.newest(_MOST_SEARCHED)]
    if not known:
        return UnknownName(words, wanted, (), hint=f"There is no {words} yet: {_start(kinds)}")
    names = dict.fromkeys(one.name for one in known if one.name)
    near = _similar(wanted, names)
    if near:
        hint = f"Did you mean {' or '.join(map(repr, near))}?"
    else:
        newest = max(known, key=lambda one: one.created_at)
        hint = f"The newest is {newest.id}" + (f" ({newest.name})" if newest.name else "")
    listings = [f"`{_KINDS[kind].listing}`" for kind in kinds if _KINDS[kind].listing]
    if listings:
        hint += f"{'' if near else ';'} {' or '.join(listings)} shows all"
    return UnknownName(words, wanted, (), hint=hint)


def _similar(wanted: str, names: Iterable[str]) -> list[str]:
    """Returns a few names that have a text in them, or else are written much like it."""
    lower = {name.lower(): name for name in names}
    within = [name for key, name in lower.items() if wanted.lower() in key]
    return (within or [lower[key] for key in get_close_matches(wanted.lower(), lower)])[:_MOST_NEAR]


def _start(kinds: Sequence[IdKind]) -> str:
    return ", or ".join(dict.fromkeys(_KINDS[kind].start for kind in kinds))


def _line(one: FoundId, *, with_kind: bool) -> str:
    created = f"{one.created_at.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"
    kind = f"{_KINDS[one.kind].words}  " if with_kind else ""
    return f"  {one.id}  {created}  {kind}{one.name}".rstrip()
