"""The failures of all campaigns and batches: pages of them, and their groups.

Lists read the table from its end, whatever the filter: its rows are narrow and in the order of
finding, so that tens of thousands take a few milliseconds. Groups read an index of their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any

from pydantic_core import from_json
from sqlalchemy import ColumnElement, Row, Select, case, distinct, func, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.oracles.accountability import Accountability
from drivora_service.oracles.failure_facts import avoidable_until, failure_sentence
from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdict_json import verdict_from_json
from drivora_service.shapes import combine, read_all
from drivora_service.store.batches import SINGLE_JOBS
from drivora_service.store.campaign_records import Confirmation
from drivora_service.store.campaign_tables import CampaignRow, FailureRow
from drivora_service.store.evaluation_runs import EvaluationId
from drivora_service.store.found_records import FailureGroup, FoundFailure, FoundFilter
from drivora_service.store.found_tables import FoundRow
from drivora_service.store.paging import make_token, read_token
from drivora_service.store.records import Page
from drivora_service.store.tables import BatchRow, ReportRow, RunRow


class FoundRepository:
    """Reads the failures of all campaigns and batches."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def page(
        self,
        wanted: FoundFilter = FoundFilter(),  # noqa: B008 # frozen
        *,
        limit: int = 50,
        page_token: str = "",
    ) -> Page[FoundFailure]:
        """Returns the failures that pass a filter, the last found first.

        Raises:
            InvalidDocument: The token is not one of this query.
        """
        scope = f"found failures {wanted}"
        conditions = self._conditions(wanted)
        if conditions is None:
            return Page(items=())
        query = select(FoundRow.seq).where(*conditions).order_by(FoundRow.seq.desc())
        if page_token:
            query = query.where(FoundRow.seq < read_token(scope, page_token))
        found = self._session.scalars(query.limit(limit + 1)).all()
        shown = found[:limit]
        more = make_token(scope, shown[-1]) if len(found) > limit else ""
        failures = self._of(shown)
        return Page(items=tuple(failures[seq] for seq in shown), next_page_token=more)

    def groups(
        self,
        wanted: FoundFilter = FoundFilter(),  # noqa: B008 # frozen
        *,
        limit: int = 50,
        page_token: str = "",
    ) -> Page[FailureGroup]:
        """Returns the groups of the failures that pass a filter, the last seen first.

        Raises:
            InvalidDocument: The token is not one of this query.
        """
        scope = f"failure groups {wanted}"
        conditions = self._conditions(wanted)
        if conditions is None:
            return Page(items=())
        last = func.max(FoundRow.seq)
        query = _group_query().where(*conditions).order_by(last.desc())
        if page_token:
            query = query.having(last < read_token(scope, page_token))
        rows = self._session.execute(query.limit(limit + 1)).all()
        shown = rows[:limit]
        more = make_token(scope, shown[-1].last) if len(rows) > limit else ""
        chosen = self._examples(shown, conditions)
        examples = self._of(chosen)
        items = tuple(_group(row, examples[seq]) for row, seq in zip(shown, chosen, strict=True))
        return Page(items=items, next_page_token=more)

    def failure(self, failure_id: int) -> FoundFailure:
        """Returns one failure.

        Raises:
            UnknownName: There is none of this id.
        """
        found = self._of([failure_id])
        if failure_id not in found:
            raise UnknownName("failure", str(failure_id), ())
        return found[failure_id]

    def _conditions(self, wanted: FoundFilter) -> list[ColumnElement[bool]] | None:
        """Returns the conditions of a filter, ``None`` if no failure can pass it."""
        conditions: list[ColumnElement[bool]] = []
        for column, value in (
            (FoundRow.oracle, wanted.oracle),
            (FoundRow.group, wanted.group),
            (FoundRow.agent, wanted.agent),
            (FoundRow.town, wanted.town),
            (FoundRow.accountability, wanted.accountability),
            (FoundRow.confirmation, wanted.confirmation),
        ):
            if value:
                conditions.append(column == value)
        if wanted.at_fault is not None:
            conditions.append(FoundRow.at_fault.is_(wanted.at_fault))
        if wanted.since is not None:
            conditions.append(FoundRow.found_at >= wanted.since)
        if wanted.until is not None:
            conditions.append(FoundRow.found_at < wanted.until)
        if wanted.campaign_id:
            campaign = select(CampaignRow.seq).where(CampaignRow.id == wanted.campaign_id)
            campaign_seq = self._session.scalar(campaign)
            if campaign_seq is None:
                return None
            # An expression, as its index is not in the order of finding.
            conditions.append(FoundRow.campaign_seq + 0 == campaign_seq)
        if wanted.batch_id:
            batch = select(BatchRow.seq).where(BatchRow.id == wanted.batch_id)
            batch_seq = self._session.scalar(batch)
            if batch_seq is None:
                return None
            conditions.append(FoundRow.batch_seq == batch_seq)
        return conditions

    def _examples(
        self, groups: Sequence[Row[*tuple[Any, ...]]], conditions: Sequence[ColumnElement[bool]]
    ) -> list[int]:
        """Returns the ``seq`` of the example of each group."""
        usual = {row.group: _usual_example(row) for row in groups}
        recorded = self._recorded(usual.values())
        lacking = [group for group, seq in usual.items() if seq not in recorded]
        if lacking:
            # A second look at these groups only: in most lists there is none.
            query = _kept_query().where(*conditions, FoundRow.group.in_(lacking))
            others = {group: seqs for group, *seqs in self._session.execute(query)}
            recorded = self._recorded(chain.from_iterable(others.values()))
            for group, seqs in others.items():
                usual[group] = next((seq for seq in seqs if seq in recorded), usual[group])
        return [usual[row.group] for row in groups]

    def _recorded(self, seqs: Iterable[int | None]) -> set[int]:
        """Returns those of the failures that have a recording."""
        known = {seq for seq in seqs if seq is not None}
        return set(self._session.scalars(_recorded_query().where(FoundRow.seq.in_(known))))

    def _of(self, seqs: Sequence[int]) -> dict[int, FoundFailure]:
        """Returns failures by their ``seq``."""
        rows = self._session.execute(_detail_query().where(FoundRow.seq.in_(seqs))).all()
        return {row.seq: _failure(row) for row in rows}


def _group_query() -> Select[*tuple[Any, ...]]:
    is_avoidable = FoundRow.accountability == Accountability.AVOIDABLE
    return select(
        FoundRow.group,
        # The group names the oracle, so that all are the same.
        func.min(FoundRow.oracle).label("oracle"),
        func.count().label("failures"),
        func.sum(case((is_avoidable, 1), else_=0)).label("avoidable"),
        func.count(distinct(FoundRow.campaign_seq)).label("campaigns"),
        func.count(distinct(FoundRow.town)).label("towns"),
        func.min(FoundRow.found_at).label("first_seen"),
        func.max(FoundRow.found_at).label("last_seen"),
        func.max(FoundRow.seq).label("last"),
        func.max(case((is_avoidable, FoundRow.seq))).label("last_avoidable"),
    ).group_by(FoundRow.group)


def _kept_query() -> Select[*tuple[Any, ...]]:
    """Returns a query of the failures of groups that are most likely recorded, the best first.

    The index does not know recordings, but in campaigns only failures that were run again have one.
    Retention leaves those of the first failures of a campaign and of the last runs.
    """
    is_avoidable = FoundRow.accountability == Accountability.AVOIDABLE
    return (
        select(
            FoundRow.group,
            func.max(case((is_avoidable, FoundRow.seq))),
            func.max(FoundRow.seq),
            func.min(FoundRow.seq),
        )
        .where(FoundRow.confirmation != Confirmation.OPEN)
        .group_by(FoundRow.group)
    )


_OF_FAILURE = (
    (FailureRow.campaign_seq == FoundRow.campaign_seq)
    & (FailureRow.number == FoundRow.number)
    & (FailureRow.place == FoundRow.place)
)


def _recorded_query() -> Select[int]:
    """Returns a query of the failures that have a recording."""
    return (
        select(FoundRow.seq)
        .outerjoin(FailureRow, _OF_FAILURE)
        .outerjoin(RunRow, RunRow.seq == FoundRow.run_seq)
        .where((FailureRow.trace != "") | (RunRow.trace_sha256 != ""))
    )


def _detail_query() -> Select[*tuple[Any, ...]]:
    batch_id = case((BatchRow.id.startswith(SINGLE_JOBS), ""), else_=BatchRow.id)
    return (
        select(
            FoundRow.seq,
            FoundRow.found_at,
            FoundRow.oracle,
            FoundRow.group,
            FoundRow.agent,
            FoundRow.town,
            FoundRow.at_fault,
            FoundRow.accountability,
            FoundRow.confirmation,
            FoundRow.number,
            FoundRow.place,
            CampaignRow.id.label("campaign_id"),
            FailureRow.kind,
            FailureRow.verdict,
            FailureRow.trace,
            RunRow.trace_sha256,
            batch_id.label("batch_id"),
            RunRow.id.label("run_id"),
            ReportRow.body.label("report"),
        )
        .outerjoin(CampaignRow, CampaignRow.seq == FoundRow.campaign_seq)
        .outerjoin(FailureRow, _OF_FAILURE)
        .outerjoin(BatchRow, BatchRow.seq == FoundRow.batch_seq)
        .outerjoin(RunRow, RunRow.seq == FoundRow.run_seq)
        .outerjoin(ReportRow, ReportRow.run_seq == FoundRow.run_seq)
    )


def _failure(row: Row[*tuple[Any, ...]]) -> FoundFailure:
    kind = row.kind or ""
    if row.campaign_id:
        verdict = verdict_from_json(row.verdict)
        run_id = EvaluationId(row.campaign_id, row.number).run_id
    else:
        # Parsing the whole reports would take a second for a page.
        (verdict,) = read_all(Verdict, [from_json(row.report)["verdicts"][row.place]])
        run_id = row.run_id
    return combine(
        FoundFailure,
        row,
        id=row.seq,
        accountability=None if row.accountability is None else Accountability(row.accountability),
        campaign_id=row.campaign_id or "",
        evaluation=row.number,
        kind=kind,
        confirmation=Confirmation(row.confirmation) if row.confirmation else None,
        batch_id=row.batch_id or "",
        run_id=run_id,
        is_recorded=bool(row.trace or row.trace_sha256),
        avoidable_until=avoidable_until(verdict),
        sentence=failure_sentence(verdict, town=row.town, kind=kind),
        verdict=verdict,
    )


def _usual_example(row: Row[*tuple[Any, ...]]) -> int:
    example: int = row.last if row.last_avoidable is None else row.last_avoidable
    return example


def _group(row: Row[*tuple[Any, ...]], example: FoundFailure) -> FailureGroup:
    return combine(
        FailureGroup,
        row,
        others=row.failures - row.avoidable,
        example=example,
        sentence=example.sentence,
    )
