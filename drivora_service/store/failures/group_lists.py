"""Groups of the failures of all campaigns and batches, with what was decided about them.

Counts read an index of their own, name by name; groups that users have made of several names, or
of a part of the failures of one, are put together from these.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Row, Select, and_, case, distinct, false, func, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.failures.failure_queries import conditions_of, failures_of, find_recorded
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.failures.group_baselines import baseline_of
from drivora_service.store.failures.group_membership import (
    Membership,
    find_membership,
    find_row,
    owners_of_names,
)
from drivora_service.store.failures.group_records import (
    ChangedPart,
    FailureGroup,
    GroupChange,
    GroupDecision,
    GroupFilter,
    GroupStatus,
    SinceBaseline,
    group_id,
)
from drivora_service.store.failures.group_tables import FailureGroupChangeRow, FailureGroupRow
from drivora_service.store.runs.run_records import Page

_Conditions = Sequence[ColumnElement[bool]]
_Key = int | str
"""Of a group: its ``seq``, or the name of one about which nothing was decided."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Counted:
    """Counts of the failures of a group that pass a filter."""

    names: tuple[str, ...]
    parts: int
    failures: int
    avoidable: int
    preventable: int
    campaigns: int
    towns: int
    first_seen: datetime
    last_seen: datetime
    last: int
    last_avoidable: int | None

    @property
    def usual_example(self) -> int:
        return self.last if self.last_avoidable is None else self.last_avoidable


class GroupRepository:
    """Reads groups of failures."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def page(
        self,
        wanted: GroupFilter = GroupFilter(),  # noqa: B008 # frozen
        *,
        limit: int = 50,
        page_token: str = "",
    ) -> Page[FailureGroup]:
        """Returns groups of failures, the last seen first.

        A failure that passes both the filter of failures and that of the baseline is one of the
        baseline.

        Raises:
            InvalidDocument: The token is not one of this query.
        """
        scope = f"failure groups {wanted}"
        before = read_token(scope, page_token) if page_token else None
        conditions, baseline = self._conditions(wanted)
        now, then = self._count_by_group(conditions), self._count_by_group(baseline)
        decided = self._read_decisions({*now, *then})
        listed = [
            (key, counted)
            for key, counted in {**then, **now}.items()
            if _passes(wanted, decided[key], _since(key, now, then, wanted))
            and (before is None or counted.last < before)
        ]
        listed.sort(key=lambda item: item[1].last, reverse=True)
        shown = listed[:limit]
        more = make_token(scope, shown[-1][1].last) if len(listed) > limit else ""
        present = self._examples([one for one in shown if one[0] in now], conditions)
        gone = self._examples([one for one in shown if one[0] not in now], baseline)
        examples = failures_of(self._session, [*present.values(), *gone.values()])
        items = tuple(
            _group(
                decided[key],
                self._exact(key, counted, conditions) if key in now else _none(counted),
                failures=now[key].failures if key in now else 0,
                baseline=(then[key].failures if key in then else 0) if wanted.baseline else None,
                since=_since(key, now, then, wanted),
                example=examples[(present if key in now else gone)[key]],
            )
            for key, counted in shown
        )
        return Page(items=items, next_page_token=more)

    def get(self, wanted: str) -> FailureGroup:
        """Returns a group with all its failures, whether they count or not.

        Raises:
            UnknownName: There is none of this id, or none of its failures is left.
        """
        page = self.page(GroupFilter(failures=FoundFilter(group=wanted, all_kept=True)), limit=1)
        if not page.items:
            raise UnknownName("group of failures", wanted, ())
        return page.items[0]

    def baseline(self, wanted: FoundFilter, text: str) -> FoundFilter:
        """Returns the filter of a baseline's failures: see :func:`baseline_of`.

        Raises:
            InvalidDocument: It is no baseline.
        """
        return baseline_of(self._session, wanted, text)

    def changes(self, wanted: str) -> tuple[GroupChange, ...]:
        """Returns what was decided about a group and those merged into it, the last first.

        Raises:
            UnknownName: There is no such group.
        """
        row = find_row(self._session, wanted)
        if row is None:
            if find_membership(self._session, wanted) is None:
                raise UnknownName("group of failures", wanted, ())
            return ()
        merged = [row.seq, *self._find_merged(row.seq)]
        rows = self._session.scalars(
            select(FailureGroupChangeRow)
            .where(FailureGroupChangeRow.group_seq.in_(merged))
            .order_by(FailureGroupChangeRow.seq.desc())
        )
        return tuple(
            combine(
                GroupChange,
                one,
                at=one.changed_at,
                by=one.changed_by,
                what=ChangedPart(one.what),
            )
            for one in rows
        )

    def _find_merged(self, seq: int) -> list[int]:
        query = select(FailureGroupRow.seq).where(FailureGroupRow.into_seq == seq)
        own = list(self._session.scalars(query))
        return own + [further for one in own for further in self._find_merged(one)]

    def _conditions(self, wanted: GroupFilter) -> tuple[_Conditions | None, _Conditions | None]:
        """Returns the conditions of the failures and of the baseline; ``None``: none passes."""
        conditions = conditions_of(self._session, wanted.failures)
        if wanted.baseline is None:
            return conditions, None
        baseline = conditions_of(self._session, wanted.baseline)
        if conditions is not None and baseline is not None:
            # What has no campaign is in no campaign: a comparison with it would tell neither.
            is_in_baseline = func.coalesce(and_(*baseline), false())
            conditions = [*conditions, ~is_in_baseline]
        return conditions, baseline

    def _count_by_group(self, conditions: _Conditions | None) -> dict[_Key, _Counted]:
        """Counts the failures that fulfil conditions by group."""
        if conditions is None:
            return {}
        owners = owners_of_names(self._session)
        found: dict[_Key, _Counted] = {}
        for row in self._session.execute(_count_query().where(*conditions)):
            key: _Key = row.group_seq or owners.get(row.group) or row.group
            part = _part(row)
            found[key] = _together(found[key], part) if key in found else part
        return found

    def _exact(self, key: _Key, counted: _Counted, conditions: _Conditions | None) -> _Counted:
        """Returns counts with the numbers of campaigns and networks of all parts together."""
        if counted.parts == 1 or conditions is None:
            return counted
        campaigns, towns = self._session.execute(
            select(
                func.count(distinct(FoundRow.campaign_seq)), func.count(distinct(FoundRow.town))
            ).where(*conditions, self._membership(key).condition())
        ).one()
        return replace(counted, campaigns=campaigns, towns=towns)

    def _membership(self, key: _Key) -> Membership:
        if isinstance(key, str):
            return Membership(seq=None, names=(key,))
        owners = owners_of_names(self._session)
        return Membership(seq=key, names=tuple(name for name, seq in owners.items() if seq == key))

    def _read_decisions(self, keys: Iterable[_Key]) -> dict[_Key, GroupDecision]:
        """Returns what was decided about groups."""
        wanted = list(keys)
        seqs = [key for key in wanted if isinstance(key, int)]
        rows = self._session.scalars(select(FailureGroupRow).where(FailureGroupRow.seq.in_(seqs)))
        found: dict[_Key, GroupDecision] = {row.seq: decision_of(row) for row in rows}
        for key in wanted:
            if isinstance(key, str):
                found[key] = GroupDecision(id=group_id(key))
        return found

    def _examples(
        self, groups: Sequence[tuple[_Key, _Counted]], conditions: _Conditions | None
    ) -> dict[_Key, int]:
        """Returns the ``seq`` of the example of each group."""
        found = {key: counted.usual_example for key, counted in groups}
        recorded = find_recorded(self._session, found.values())
        for key, seq in found.items():
            if seq in recorded or conditions is None:
                continue
            # A second look at this group only: most have a recording.
            query = _kept_query().where(*conditions, self._membership(key).condition())
            others = list(self._session.execute(query).one())
            kept = find_recorded(self._session, others)
            found[key] = next((other for other in others if other in kept), seq)
        return found


def decision_of(row: FailureGroupRow) -> GroupDecision:
    """Returns what was decided about a group."""
    status = GroupStatus(row.status)
    return combine(
        GroupDecision,
        row,
        status=status,
        status_at=None if status is GroupStatus.NEW else row.status_at,
    )


def _count_query() -> Select[*tuple[Any, ...]]:
    is_avoidable = FoundRow.accountability == Accountability.AVOIDABLE
    is_preventable = FoundRow.accountability == Accountability.PREVENTABLE
    return select(
        FoundRow.group,
        FoundRow.group_seq,
        func.count().label("failures"),
        func.sum(case((is_avoidable, 1), else_=0)).label("avoidable"),
        func.sum(case((is_preventable, 1), else_=0)).label("preventable"),
        func.count(distinct(FoundRow.campaign_seq)).label("campaigns"),
        func.count(distinct(FoundRow.town)).label("towns"),
        func.min(FoundRow.found_at).label("first_seen"),
        func.max(FoundRow.found_at).label("last_seen"),
        func.max(FoundRow.seq).label("last"),
        func.max(case((is_avoidable, FoundRow.seq))).label("last_avoidable"),
    ).group_by(FoundRow.group, FoundRow.group_seq)


def _kept_query() -> Select[*tuple[Any, ...]]:
    """Returns a query of the failures that are most likely recorded, the best first.

    The index does not know recordings, but in campaigns only failures that were run again have one.
    Retention leaves those of the first failures of a campaign and of the last runs.
    """
    is_avoidable = FoundRow.accountability == Accountability.AVOIDABLE
    return select(
        func.max(case((is_avoidable, FoundRow.seq))),
        func.max(FoundRow.seq),
        func.min(FoundRow.seq),
    ).where(FoundRow.confirmation != Confirmation.OPEN)


def _part(row: Row[*tuple[Any, ...]]) -> _Counted:
    return combine(_Counted, row, names=(row.group,), parts=1)


def _together(one: _Counted, other: _Counted) -> _Counted:
    avoidable = [seq for seq in (one.last_avoidable, other.last_avoidable) if seq is not None]
    return _Counted(
        names=tuple(sorted({*one.names, *other.names})),
        parts=one.parts + other.parts,
        failures=one.failures + other.failures,
        avoidable=one.avoidable + other.avoidable,
        preventable=one.preventable + other.preventable,
        # At least; exact numbers are counted for groups that are shown.
        campaigns=max(one.campaigns, other.campaigns),
        towns=max(one.towns, other.towns),
        first_seen=min(one.first_seen, other.first_seen),
        last_seen=max(one.last_seen, other.last_seen),
        last=max(one.last, other.last),
        last_avoidable=max(avoidable, default=None),
    )


def _none(counted: _Counted) -> _Counted:
    """Returns the counts of a group that is gone: when it was seen, and nothing else."""
    return replace(counted, failures=0, avoidable=0, preventable=0, campaigns=0, towns=0)


def _since(
    key: _Key, now: Mapping[_Key, object], then: Mapping[_Key, object], wanted: GroupFilter
) -> SinceBaseline | None:
    if wanted.baseline is None:
        return None
    if key not in now:
        return SinceBaseline.GONE
    return SinceBaseline.SAME if key in then else SinceBaseline.NEW


def _passes(wanted: GroupFilter, decision: GroupDecision, since: SinceBaseline | None) -> bool:
    return (
        (not wanted.statuses or decision.status in wanted.statuses)
        and (not wanted.assignee or decision.assignee == wanted.assignee)
        and (wanted.since_baseline is None or since is wanted.since_baseline)
    )


def _group(
    decision: GroupDecision,
    counted: _Counted,
    *,
    failures: int,
    baseline: int | None,
    since: SinceBaseline | None,
    example: Any,
) -> FailureGroup:
    is_back = (
        decision.status is GroupStatus.FIXED
        and failures > 0
        and decision.status_at is not None
        and counted.last_seen > decision.status_at
    )
    return combine(
        FailureGroup,
        decision,
        counted,
        others=counted.failures - counted.avoidable,
        is_back=is_back,
        baseline_failures=baseline,
        since_baseline=since,
        example=example,
        sentence=example.sentence,
    )
