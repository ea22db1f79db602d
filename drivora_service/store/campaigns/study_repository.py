"""Studies: storing and reading them, and requests to them."""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Row, case, func, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_records import (
    CampaignCounts,
    CampaignRequest,
    CampaignState,
    StudyCell,
)
from drivora_service.store.campaigns.campaign_tables import CampaignRow, StudyRow
from drivora_service.store.campaigns.seed_run_records import seed_runs_from_json
from drivora_service.store.campaigns.study_records import StudyRecord, StudyScene, StudySummary
from drivora_service.store.engine.ids import new_id
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.runs.run_records import Page

_MOST_NAMED = 5
"""Number of studies that an error names, newest first."""
_COUNTED = (
    "evaluations",
    "judged",
    "invalid",
    "failed",
    "violating",
    "at_fault",
    "avoidable",
    "unavoidable",
    "undetermined",
    "preventable",
    "agent_failed",
    "not_at_fault",
)


class StudyRepository:
    """Reads and writes studies; ``CampaignRepository`` has their campaigns."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def create(self, *, name: str, document: str) -> str:
        """Stores a study without campaigns; returns its id."""
        row = StudyRow(id=new_id(), name=name, document=document, created_at=datetime.now(UTC))
        self._session.add(row)
        self._session.flush()
        return row.id

    def get(self, study_id: str) -> StudyRecord:
        """Returns a study.

        Raises:
            UnknownName: There is none of this id.
        """
        row = self._row(study_id)
        (summary,) = self._summaries([row])
        return combine(StudyRecord, summary, document=json.loads(row.document))

    def page(self, *, limit: int = 50, page_token: str = "") -> Page[StudySummary]:
        """Returns studies, newest first.

        Raises:
            InvalidDocument: The token is not one of this list.
        """
        query = select(StudyRow).order_by(StudyRow.seq.desc()).limit(limit + 1)
        if page_token:
            query = query.where(StudyRow.seq < read_token("studies", page_token))
        rows = self._session.scalars(query).all()
        more = make_token("studies", rows[limit - 1].seq) if len(rows) > limit else ""
        return Page(items=self._summaries(rows[:limit]), next_page_token=more)

    def campaign_ids(
        self, study_id: str, states: Collection[CampaignState] = ()
    ) -> tuple[str, ...]:
        """Returns the ids of the campaigns of a study in some states, or all, in their order."""
        query = select(CampaignRow.id).where(CampaignRow.study_id == study_id)
        if states:
            query = query.where(CampaignRow.state.in_(states))
        return tuple(self._session.scalars(query.order_by(CampaignRow.seq)))

    def scenes(self, study_id: str) -> tuple[StudyScene, ...]:
        """Returns what the campaigns of a study have found, by seed scenario and ADS, in order."""
        columns = CampaignRow.__table__.c
        finished = case((CampaignRow.state == CampaignState.FINISHED, 1), else_=0)
        rows = self._session.execute(
            select(
                CampaignRow.study_scenario,
                CampaignRow.study_agent,
                func.count().label("number"),
                func.sum(finished).label("finished"),
                # One campaign of a scene has them, and "[]" is less than any list.
                func.max(CampaignRow.seed_runs).label("seed_runs"),
                *(func.sum(columns[name]).label(name) for name in _COUNTED),
            )
            .where(CampaignRow.study_id == study_id)
            .group_by(CampaignRow.study_scenario, CampaignRow.study_agent)
            .order_by(func.min(CampaignRow.seq))
        )
        return tuple(
            StudyScene(
                scenario=row.study_scenario,
                agent=row.study_agent,
                counts=_sum_counts([row]),
                seed_runs=seed_runs_from_json(row.seed_runs),
                is_finished=row.finished == row.number,
            )
            for row in rows
        )

    def cells(self, study_id: str) -> tuple[tuple[str, CampaignState, StudyCell], ...]:
        """Returns the campaigns of a study in their order: id, state, and place in the study."""
        rows = self._session.execute(
            select(
                CampaignRow.id,
                CampaignRow.state,
                CampaignRow.study_scenario,
                CampaignRow.study_agent,
                CampaignRow.study_method,
                CampaignRow.repetition,
            )
            .where(CampaignRow.study_id == study_id)
            .order_by(CampaignRow.seq)
        )
        return tuple(
            (
                campaign_id,
                CampaignState(state),
                StudyCell(scenario=scenario, agent=agent, method=method, repetition=repetition),
            )
            for campaign_id, state, scenario, agent, method, repetition in rows
        )

    def ask_for(self, study_id: str, request: CampaignRequest) -> None:
        """Stores a request, or withdraws it.

        Raises:
            UnknownName: There is none of this id.
        """
        self._row(study_id).request = request

    def request_of(self, study_id: str) -> CampaignRequest:
        """Returns the pending request to a study.

        Raises:
            UnknownName: There is none of this id.
        """
        return CampaignRequest(self._row(study_id).request)

    def _row(self, study_id: str) -> StudyRow:
        row = self._session.scalar(select(StudyRow).where(StudyRow.id == study_id))
        if row is None:
            ids = self._session.scalars(
                select(StudyRow.id).order_by(StudyRow.seq.desc()).limit(_MOST_NAMED)
            )
            raise UnknownName("study", study_id, tuple(ids))
        return row

    def _summaries(self, rows: Sequence[StudyRow]) -> tuple[StudySummary, ...]:
        columns = CampaignRow.__table__.c
        query = (
            select(
                CampaignRow.study_id,
                CampaignRow.state,
                func.count().label("number"),
                func.sum(CampaignRow.budget).label("budget"),
                func.max(CampaignRow.updated_at).label("updated_at"),
                func.max(CampaignRow.batch_id).label("batch_id"),
                *(func.sum(columns[name]).label(name) for name in _COUNTED),
            )
            .where(CampaignRow.study_id.in_([row.id for row in rows]))
            .group_by(CampaignRow.study_id, CampaignRow.state)
        )
        found: dict[str, list[Row[Any]]] = {row.id: [] for row in rows}
        for part in self._session.execute(query):
            found[part.study_id].append(part)
        return tuple(_summary(row, found[row.id]) for row in rows)


def _sum_counts(parts: Sequence[Row[Any]]) -> CampaignCounts:
    # Old campaigns lack some counts, but none of them is of a study, except for the newest counts.
    sums = {name: sum(getattr(part, name) or 0 for part in parts) for name in _COUNTED}
    is_old = any(part.agent_failed is None for part in parts)
    counts = CampaignCounts(**sums)
    return replace(counts, agent_failed=None, not_at_fault=None) if is_old else counts


def _summary(row: StudyRow, parts: Sequence[Row[Any]]) -> StudySummary:
    counts = _sum_counts(parts)
    return combine(
        StudySummary,
        row,
        request=CampaignRequest(row.request),
        campaigns={CampaignState(part.state): part.number for part in parts},
        budget=sum(part.budget for part in parts),
        simulations=counts.simulations,
        counts=counts,
        is_on_service=any(part.batch_id for part in parts),
        updated_at=max((part.updated_at for part in parts), default=row.created_at),
    )
