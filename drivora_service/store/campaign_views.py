"""Campaigns as lists show them: evaluations and failures in pages, and kinds of failures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from datetime import datetime
from typing import Any

from pydantic_core import from_json
from sqlalchemy import ColumnElement, Select, and_, case, func, or_, select
from sqlalchemy.orm import Session

from drivora_service.oracles.accountability import Accountability
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaign_records import (
    Confirmation,
    EvaluationFilter,
    EvaluationSummary,
    FailureFilter,
    FailureKind,
    FailureRecord,
)
from drivora_service.store.campaign_tables import EvaluationRow, FailureRow
from drivora_service.store.campaigns import campaign_row
from drivora_service.store.chunks import batched
from drivora_service.store.evaluations import evaluation_row, failure_record
from drivora_service.store.paging import make_token, read_token
from drivora_service.store.records import Page

_PLACES = 1 << 16
"""More violations than an evaluation can have: a page ends at one number of both together."""


class CampaignViewRepository:
    """Reads campaigns for people and pages."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def evaluations(
        self,
        campaign_id: str,
        wanted: EvaluationFilter = EvaluationFilter(),  # noqa: B008 # frozen
        *,
        newest_first: bool = False,
        limit: int = 50,
        page_token: str = "",
    ) -> Page[EvaluationSummary]:
        """Gives the evaluations that a filter lets through, in the order of their numbers.

        Raises:
            UnknownName: There is no such campaign.
            InvalidDocument: The token is not one of this query.
        """
        campaign = campaign_row(self._session, campaign_id)
        scope = f"evaluations {campaign_id} {newest_first} {wanted}"
        number = EvaluationRow.number
        query = _filtered(
            select(EvaluationRow).where(EvaluationRow.campaign_seq == campaign.seq), wanted
        )
        if page_token:
            last = read_token(scope, page_token)
            query = query.where(number < last if newest_first else number > last)
        query = query.order_by(number.desc() if newest_first else number)
        rows = self._session.scalars(query.limit(limit + 1)).all()
        shown = rows[:limit]
        more = make_token(scope, shown[-1].number) if len(rows) > limit else ""
        return Page(items=self._summaries(campaign.seq, shown), next_token=more)

    def evaluation(self, campaign_id: str, number: int) -> EvaluationSummary:
        """Gives one evaluation.

        Raises:
            UnknownName: There is no such campaign, or it has no evaluation of this number.
        """
        campaign = campaign_row(self._session, campaign_id)
        row = evaluation_row(self._session, campaign, number)
        return self._summaries(campaign.seq, [row])[0]

    def ancestors(
        self, campaign_id: str, number: int, *, most: int
    ) -> tuple[EvaluationSummary, ...]:
        """Gives what an evaluation descends from, in the order of their numbers.

        Args:
            campaign_id: Which campaign.
            number: Of the evaluation.
            most: How many at most; the nearest generations are kept.

        Raises:
            UnknownName: There is no such campaign, or it has no evaluation of this number.
        """
        campaign = campaign_row(self._session, campaign_id)
        known: dict[int, EvaluationSummary] = {}
        ahead = set(self.evaluation(campaign_id, number).parents)
        while ahead and len(known) < most:
            nearest = sorted(ahead, reverse=True)[: most - len(known)]
            found = self._of(campaign.seq, nearest)
            known.update((summary.number, summary) for summary in found)
            ahead = {parent for summary in found for parent in summary.parents} - set(known)
        return tuple(known[key] for key in sorted(known))

    def failures(
        self,
        campaign_id: str,
        wanted: FailureFilter = FailureFilter(),  # noqa: B008 # frozen
        *,
        limit: int = 50,
        page_token: str = "",
    ) -> Page[FailureRecord]:
        """Gives the failures that a filter lets through, in the order of their evaluations.

        Raises:
            UnknownName: There is no such campaign.
            InvalidDocument: The token is not one of this query.
        """
        campaign = campaign_row(self._session, campaign_id)
        scope = f"failures {campaign_id} {wanted}"
        query = select(FailureRow).where(
            FailureRow.campaign_seq == campaign.seq, *_conditions(wanted)
        )
        if page_token:
            number, place = divmod(read_token(scope, page_token), _PLACES)
            query = query.where(
                or_(
                    FailureRow.number > number,
                    and_(FailureRow.number == number, FailureRow.place > place),
                )
            )
        query = query.order_by(FailureRow.number, FailureRow.place)
        rows = self._session.scalars(query.limit(limit + 1)).all()
        shown = rows[:limit]
        more = ""
        if len(rows) > limit:
            more = make_token(scope, shown[-1].number * _PLACES + shown[-1].place)
        return Page(items=tuple(failure_record(row) for row in shown), next_token=more)

    def kinds(self, campaign_id: str) -> tuple[FailureKind, ...]:
        """Gives the kinds of failures of a campaign, in the order of their first evaluations.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        first = func.min(FailureRow.number)
        rows = self._session.execute(
            select(
                FailureRow.key,
                func.count(FailureRow.number.distinct()),
                func.count(),
                _runs_if(FailureRow.at_fault.is_(True)),
                _runs_if(FailureRow.accountability == Accountability.AVOIDABLE),
                _runs_if(FailureRow.confirmation == Confirmation.CONFIRMED),
                _runs_if(FailureRow.confirmation == Confirmation.FLAKY),
                first,
                func.count(FailureRow.cluster.distinct()),
            )
            .where(FailureRow.campaign_seq == campaign.seq)
            .group_by(FailureRow.key)
            .order_by(first, FailureRow.key)
        )
        return tuple(
            FailureKind(
                key=key,
                failures=failures,
                violations=violations,
                at_fault=at_fault,
                avoidable=avoidable,
                confirmed=confirmed,
                flaky=flaky,
                first=number,
                clusters=clusters or None,
            )
            for (
                key,
                failures,
                violations,
                at_fault,
                avoidable,
                confirmed,
                flaky,
                number,
                clusters,
            ) in rows
        )

    def _of(self, campaign_seq: int, numbers: Sequence[int]) -> tuple[EvaluationSummary, ...]:
        rows: list[EvaluationRow] = []
        for chunk in batched(numbers):
            rows += self._session.scalars(
                select(EvaluationRow).where(
                    EvaluationRow.campaign_seq == campaign_seq, EvaluationRow.number.in_(chunk)
                )
            )
        return self._summaries(campaign_seq, rows)

    def _summaries(
        self, campaign_seq: int, rows: Sequence[EvaluationRow]
    ) -> tuple[EvaluationSummary, ...]:
        keys: dict[int, list[str]] = {}
        for chunk in batched([row.number for row in rows if row.violations]):
            found = self._session.execute(
                select(FailureRow.number, FailureRow.key)
                .where(FailureRow.campaign_seq == campaign_seq, FailureRow.number.in_(chunk))
                .order_by(FailureRow.number, FailureRow.place)
            )
            for number, key in found:
                keys.setdefault(number, []).append(key)
        return tuple(_summary(row, tuple(keys.get(row.number, ()))) for row in rows)


def _filtered(query: Select[EvaluationRow], wanted: EvaluationFilter) -> Select[EvaluationRow]:
    if wanted.status is not None:
        query = query.where(EvaluationRow.status == wanted.status)
    if wanted.violating is not None:
        broken = EvaluationRow.violations
        query = query.where(broken > 0 if wanted.violating else broken == 0)
    if wanted.generation is not None:
        query = query.where(EvaluationRow.generation == wanted.generation)
    return query


def _conditions(wanted: FailureFilter) -> list[ColumnElement[bool]]:
    conditions: list[ColumnElement[bool]] = []
    if wanted.key:
        conditions.append(FailureRow.key == wanted.key)
    if wanted.oracle:
        conditions.append(FailureRow.oracle == wanted.oracle)
    if wanted.at_fault is not None:
        conditions.append(FailureRow.at_fault.is_(wanted.at_fault))
    if wanted.accountability is not None:
        conditions.append(FailureRow.accountability == wanted.accountability)
    if wanted.confirmation is not None:
        conditions.append(FailureRow.confirmation == wanted.confirmation)
    return conditions


def _runs_if(condition: ColumnElement[bool]) -> ColumnElement[int]:
    return func.count(case((condition, FailureRow.number)).distinct())


def _summary(row: EvaluationRow, keys: tuple[str, ...]) -> EvaluationSummary:
    # Reading the whole report into its classes would cost a page of evaluations a second.
    report: dict[str, Any] = from_json(row.report)
    measurement = report.get("measurement") or {}
    told: datetime = row.told_at
    return EvaluationSummary(
        number=row.number,
        generation=row.generation,
        origin=row.origin,
        parents=tuple(json.loads(row.parents)),
        status=EvaluationStatus(row.status),
        scenario_sha256=row.document_sha256 or "",
        violations=row.violations,
        at_fault_violations=row.at_fault_violations,
        accountability=None if row.accountability is None else Accountability(row.accountability),
        failure_keys=keys,
        objectives=measurement.get("objectives") or {},
        cause=(report.get("failure") or {}).get("cause", ""),
        sim_time_s=row.sim_time_s,
        wall_time_s=row.wall_time_s,
        told_at=told,
    )
