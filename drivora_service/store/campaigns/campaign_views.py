"""Campaigns for lists: pages of evaluations and failures, and kinds of failures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from pydantic_core import from_json
from sqlalchemy import ColumnElement, and_, case, distinct, func, or_, select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.search.tester import EvaluationStatus
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_records import (
    EvaluationFilter,
    EvaluationSummary,
    Failure,
    FailureFilter,
    FailureKind,
    SeedFindings,
)
from drivora_service.store.campaigns.campaign_repository import campaign_row
from drivora_service.store.campaigns.campaign_tables import CampaignRow, EvaluationRow, FailureRow
from drivora_service.store.campaigns.evaluation_repository import evaluation_row, failure_of
from drivora_service.store.campaigns.evaluation_runs import EvaluationId, run_of_evaluation
from drivora_service.store.campaigns.kind_counters import failure_kinds
from drivora_service.store.campaigns.missing_results import MissingResult, missing_results
from drivora_service.store.engine.chunks import batched
from drivora_service.store.engine.merging import Branch, first_numbers
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.runs.run_records import Page, RunRecord

_PLACES = 1 << 16
"""More than the violations of one evaluation: number and violation together order a page."""


class CampaignViewRepository:
    """Reads campaigns for display."""

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
        """Returns the evaluations that pass a filter, in the order of their numbers.

        Raises:
            UnknownName: There is no such campaign.
            InvalidDocument: The token is not one of this query.
        """
        campaign = campaign_row(self._session, campaign_id)
        scope = f"evaluations {campaign_id} {newest_first} {wanted}"
        last = read_token(scope, page_token) if page_token else None
        branches = _branches(campaign.seq, wanted)
        numbers = first_numbers(
            self._session, branches, limit=limit + 1, after=last, descending=newest_first
        )
        shown = numbers[:limit]
        more = make_token(scope, shown[-1]) if len(numbers) > limit else ""
        summaries = self._of(campaign.seq, shown)
        ordered = sorted(summaries, key=lambda summary: summary.number, reverse=newest_first)
        return Page(items=tuple(ordered), next_page_token=more)

    def evaluation(self, campaign_id: str, number: int) -> EvaluationSummary:
        """Returns one evaluation.

        Raises:
            UnknownName: There is no such campaign, or it has no evaluation of this number.
        """
        campaign = campaign_row(self._session, campaign_id)
        row = evaluation_row(self._session, campaign, number)
        return self._summaries(campaign.seq, [row])[0]

    def run(self, wanted: EvaluationId) -> RunRecord:
        """Returns the run of an evaluation, also where the queue has none.

        Raises:
            UnknownName: There is no such campaign, or it has no such evaluation.
        """
        return run_of_evaluation(self._session, wanted)

    def ancestors(
        self, campaign_id: str, number: int, *, most: int
    ) -> tuple[EvaluationSummary, ...]:
        """Returns the ancestors of an evaluation, in the order of their numbers.

        Args:
            campaign_id: Id of the campaign.
            number: Number of the evaluation.
            most: Greatest number of ancestors; the nearest generations are kept.

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
    ) -> Page[Failure]:
        """Returns the failures that pass a filter, in the order of their evaluations.

        Raises:
            UnknownName: There is no such campaign.
            InvalidDocument: The token is not one of this query.
        """
        campaign = campaign_row(self._session, campaign_id)
        scope = f"failures {campaign_id} {wanted}"
        query = select(FailureRow.number, FailureRow.place).where(
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
        found = [(row[0], row[1]) for row in self._session.execute(query.limit(limit + 1))]
        shown = found[:limit]
        more = ""
        if len(found) > limit:
            number, place = shown[-1]
            more = make_token(scope, number * _PLACES + place)
        rows = {
            (row.number, row.place): row
            for chunk in batched(sorted({number for number, _ in shown}))
            for row in self._session.scalars(
                select(FailureRow).where(
                    FailureRow.campaign_seq == campaign.seq, FailureRow.number.in_(chunk)
                )
            )
        }
        return Page(items=tuple(failure_of(rows[key]) for key in shown), next_page_token=more)

    def kinds(self, campaign_id: str) -> tuple[FailureKind, ...]:
        """Returns the kinds of failures of a campaign, in the order of their first evaluations.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        return failure_kinds(self._session, campaign.seq)

    def missing_results(
        self, *, campaign_id: str = "", study_id: str = ""
    ) -> tuple[MissingResult, ...]:
        """Returns why runs of a campaign, or of a study, have no result; most frequent first."""
        chosen = CampaignRow.id == campaign_id if campaign_id else CampaignRow.study_id == study_id
        return missing_results(self._session, chosen)

    def seeds(self, campaign_id: str) -> tuple[SeedFindings, ...]:
        """Returns the findings by seed scenario, in their order; none if there is only one.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        seeds = json.loads(campaign.document).get("scenarios") or ()
        if not seeds:
            return ()
        counts = self._counts_by_seed(campaign.seq)
        kinds = self._kinds_by_seed(campaign.seq)
        nothing = (0, 0, 0, 0, 0, None, None)
        findings = []
        for number, seed in enumerate(seeds):
            evaluations, simulations, violating, at_fault, avoidable, first, target = counts.get(
                number, nothing
            )
            findings.append(
                SeedFindings(
                    name=seed["name"],
                    town=seed["scenario"]["map_region"]["town"],
                    evaluations=evaluations,
                    simulations=simulations,
                    violating=violating,
                    at_fault=at_fault,
                    avoidable=avoidable,
                    kinds=kinds.get(number, 0),
                    first_failure=first,
                    first_avoidable=target,
                )
            )
        return tuple(findings)

    def _counts_by_seed(
        self, campaign_seq: int
    ) -> dict[int, tuple[int, int, int, int, int, int | None, int | None]]:
        def number(condition: ColumnElement[bool]) -> ColumnElement[int]:
            return func.sum(case((condition, 1), else_=0))

        is_target = EvaluationRow.accountability == Accountability.AVOIDABLE
        query = (
            select(
                EvaluationRow.seed_number,
                func.count(),
                number(EvaluationRow.status != EvaluationStatus.INVALID),
                number(EvaluationRow.violations > 0),
                number(EvaluationRow.at_fault_violations > 0),
                number(is_target),
                func.min(case((EvaluationRow.violations > 0, EvaluationRow.number))),
                func.min(case((is_target, EvaluationRow.number))),
            )
            .where(EvaluationRow.campaign_seq == campaign_seq)
            .group_by(EvaluationRow.seed_number)
        )
        return {row[0]: row[1:] for row in map(tuple, self._session.execute(query))}

    def _kinds_by_seed(self, campaign_seq: int) -> dict[int, int]:
        query = (
            select(EvaluationRow.seed_number, func.count(distinct(FailureRow.kind)))
            .join(
                FailureRow,
                and_(
                    FailureRow.campaign_seq == EvaluationRow.campaign_seq,
                    FailureRow.number == EvaluationRow.number,
                ),
            )
            .where(EvaluationRow.campaign_seq == campaign_seq)
            .group_by(EvaluationRow.seed_number)
        )
        return {row[0]: row[1] for row in self._session.execute(query)}

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
        kinds: dict[int, list[str]] = {}
        for chunk in batched([row.number for row in rows if row.violations]):
            found = self._session.execute(
                select(FailureRow.number, FailureRow.kind)
                .where(FailureRow.campaign_seq == campaign_seq, FailureRow.number.in_(chunk))
                .order_by(FailureRow.number, FailureRow.place)
            )
            for number, kind in found:
                kinds.setdefault(number, []).append(kind)
        return tuple(_summary(row, tuple(kinds.get(row.number, ()))) for row in rows)


def _branches(campaign_seq: int, wanted: EvaluationFilter) -> list[Branch]:
    """Returns the ranges of an index in which the wanted evaluations lie."""
    number, of_campaign = EvaluationRow.number, EvaluationRow.campaign_seq == campaign_seq
    if wanted == EvaluationFilter():
        return [Branch(number=number, conditions=(of_campaign,))]
    conditions = [of_campaign]
    if wanted.generation is not None:
        conditions.append(EvaluationRow.generation == wanted.generation)
    return [
        Branch(
            number=number,
            conditions=(
                *conditions,
                EvaluationRow.status == status,
                EvaluationRow.violating.is_(violating),
            ),
        )
        for status in EvaluationStatus
        for violating in (False, True)
        if wanted.status in (None, status) and wanted.violating in (None, violating)
    ]


def _conditions(wanted: FailureFilter) -> list[ColumnElement[bool]]:
    conditions: list[ColumnElement[bool]] = []
    if wanted.kind:
        conditions.append(FailureRow.kind == wanted.kind)
    if wanted.oracle:
        conditions.append(FailureRow.oracle == wanted.oracle)
    if wanted.at_fault is not None:
        conditions.append(FailureRow.at_fault.is_(wanted.at_fault))
    if wanted.accountability is not None:
        conditions.append(FailureRow.accountability == wanted.accountability)
    if wanted.confirmation is not None:
        conditions.append(FailureRow.confirmation == wanted.confirmation)
    return conditions


def _summary(row: EvaluationRow, kinds: tuple[str, ...]) -> EvaluationSummary:
    # Parsing the whole reports would take a second for a page of evaluations.
    report: dict[str, Any] = from_json(row.report)
    measurement = report.get("measurement") or {}
    return combine(
        EvaluationSummary,
        row,
        parents=tuple(json.loads(row.parents)),
        status=EvaluationStatus(row.status),
        scenario_sha256=row.document_sha256 or "",
        accountability=None if row.accountability is None else Accountability(row.accountability),
        failure_kinds=kinds,
        objectives=measurement.get("objectives") or {},
        cause=(report.get("failure") or {}).get("cause", ""),
    )
