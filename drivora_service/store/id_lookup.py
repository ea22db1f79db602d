"""Finding the id of a stored thing by its name, by a prefix of its id, or as the newest."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC
from difflib import get_close_matches

from sqlalchemy.orm import Session

from drivora_service.errors import AmbiguousName, UnknownName
from drivora_service.store.campaigns.evaluation_runs import EvaluationId
from drivora_service.store.id_queries import IdQueries, queries_of
from drivora_service.store.id_records import LATEST, FoundId, IdKind

_MOST_NAMED = 10
"""Number of candidates that an error lists."""
_MOST_SEARCHED, _MOST_NEAR = 200, 3
"""Number of the newest names in which similar ones are sought, and of those that are shown."""

LEAST_DIGITS = 4
"""Digits of an id that stand for it: a mistyped number must not name a run or a campaign."""

_PREFIX = re.compile(rf"[0-9a-f]{{{LEAST_DIGITS},24}}")
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
    lookups = [queries_of(session, kind) for kind in kinds]
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


def _named(
    kinds: Sequence[IdKind], wanted: str, lookups: Sequence[IdQueries], *, newest: bool
) -> FoundId | None:
    found = [one for lookup in lookups for one in lookup.of_name(wanted, _MOST_NAMED + 1)]
    if newest:
        return max(found, key=lambda one: one.created_at, default=None)
    return _only(kinds, wanted, "the name of", found)


def _of_prefix(lookups: Sequence[IdQueries], wanted: str) -> Iterator[FoundId]:
    if _PREFIX.fullmatch(wanted):
        for lookup in lookups:
            yield from lookup.of_prefix(wanted, _MOST_NAMED + 1)


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


def _unknown(kinds: Sequence[IdKind], wanted: str, lookups: Sequence[IdQueries]) -> UnknownName:
    """Returns the error for a text that means nothing, with what might be meant."""
    words = _or(_KINDS[kind].words for kind in kinds)
    known = [one for lookup in lookups for one in lookup.newest(_MOST_SEARCHED)]
    if not known:
        return UnknownName(words, wanted, (), hint=f"There is no {words} yet: {_start(kinds)}")
    names = dict.fromkeys(one.name for one in known if one.name)
    near = _similar(wanted, names)
    if near:
        hint = f"Did you mean {_or(map(repr, near))}?"
    else:
        newest = max(known, key=lambda one: one.created_at)
        hint = f"The newest is {newest.id}" + (f" ({newest.name})" if newest.name else "")
    listings = [f"`{_KINDS[kind].listing}`" for kind in kinds if _KINDS[kind].listing]
    if listings:
        hint += f"{'' if near else ';'} {_or(listings)} shows all"
    return UnknownName(words, wanted, (), hint=hint)


def _similar(wanted: str, names: Iterable[str]) -> list[str]:
    """Returns a few names that have a text in them, or else are written much like it."""
    lower = {name.lower(): name for name in names}
    within = [name for key, name in lower.items() if wanted.lower() in key]
    return (within or [lower[key] for key in get_close_matches(wanted.lower(), lower)])[:_MOST_NEAR]


def _start(kinds: Sequence[IdKind]) -> str:
    return _or(dict.fromkeys(_KINDS[kind].start for kind in kinds))


def _or(texts: Iterable[str]) -> str:
    """Returns texts as a choice: ``a, b or c``."""
    *others, last = texts
    return f"{', '.join(others)} or {last}" if others else last


def _line(one: FoundId, *, with_kind: bool) -> str:
    created = f"{one.created_at.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"
    kind = f"{_KINDS[one.kind].words}  " if with_kind else ""
    return f"  {one.id}  {created}  {kind}{one.name}".rstrip()
