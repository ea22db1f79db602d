"""Failures of all campaigns and batches: the conditions of filters, and one failure in full."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pydantic_core import from_json
from sqlalchemy import ColumnElement, Row, Select, case, func, select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import COUNTED, Counted
from drivora_service.oracles.verdicts.failure_facts import avoidable_until, failure_sentence
from drivora_service.oracles.verdicts.verdict_json import verdict_from_json
from drivora_service.shapes import combine, read_all
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.campaigns.campaign_tables import CampaignRow, FailureRow
from drivora_service.store.campaigns.evaluation_runs import EvaluationId
from drivora_service.store.failures.failure_records import FoundFailure, FoundFilter
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.failures.group_membership import find_membership
from drivora_service.store.failures.group_records import group_id
from drivora_service.store.failures.group_tables import FailureGroupNameRow, FailureGroupRow
from drivora_service.store.runs.batch_repository import SINGLE_JOBS
from drivora_service.store.runs.run_tables import BatchRow, ReportRow, RunRow


def conditions_of(session: Session, wanted: FoundFilter) -> list[ColumnElement[bool]] | None:
    """Returns the conditions of a filter; ``None``: no failure can pass it."""
    conditions: list[ColumnElement[bool]] = [
        column == value
        for column, value in (
            (FoundRow.oracle, wanted.oracle),
            (FoundRow.agent, wanted.agent),
            (FoundRow.configuration_id, wanted.configuration_id),
            (FoundRow.town, wanted.town),
            (FoundRow.accountability, wanted.accountability),
            (FoundRow.confirmation, wanted.confirmation),
        )
        if value
    ]
    if wanted.at_fault is not None:
        conditions.append(FoundRow.at_fault.is_(wanted.at_fault))
    if not wanted.all_kept:
        conditions += _counted_conditions(wanted)
    if wanted.since is not None:
        conditions.append(FoundRow.found_at >= wanted.since)
    if wanted.until is not None:
        conditions.append(FoundRow.found_at < wanted.until)
    if wanted.group:
        membership = find_membership(session, wanted.group)
        if membership is None:
            return None
        conditions.append(membership.condition())
    owners = _owner_conditions(session, wanted)
    return None if owners is None else [*conditions, *owners]


def _counted_conditions(wanted: FoundFilter) -> list[ColumnElement[bool]]:
    if wanted.counts is None:
        # Who asks for a degree, or for fault, chooses by that.
        is_chosen = wanted.accountability is not None or wanted.at_fault is not None
        return [] if is_chosen else [FoundRow.is_counted.is_(True)]
    # What only its own definition looks at is kept, too: an observation, or what just follows.
    is_violation = FoundRow.is_violation.is_(True)
    if wanted.counts is Counted.ANY:
        return [is_violation]
    # What was found before degrees were recorded counts by its definition.
    unknown = FoundRow.accountability.is_(None) & FoundRow.is_counted
    degrees = FoundRow.accountability.in_(sorted(COUNTED[wanted.counts]))
    return [is_violation, degrees | unknown]


def _owner_conditions(session: Session, wanted: FoundFilter) -> list[ColumnElement[bool]] | None:
    conditions: list[ColumnElement[bool]] = []
    if wanted.campaign_id:
        campaign = select(CampaignRow.seq).where(CampaignRow.id == wanted.campaign_id)
        campaign_seq = session.scalar(campaign)
        if campaign_seq is None:
            return None
        # An expression, as its index is not in the order of finding.
        conditions.append(FoundRow.campaign_seq + 0 == campaign_seq)
    if wanted.study_id:
        of_study = select(CampaignRow.seq).where(CampaignRow.study_id == wanted.study_id)
        campaigns = session.scalars(of_study).all()
        if not campaigns:
            return None
        conditions.append((FoundRow.campaign_seq + 0).in_(campaigns))
    if wanted.batch_id:
        batch = select(BatchRow.seq).where(BatchRow.id == wanted.batch_id)
        batch_seq = session.scalar(batch)
        if batch_seq is None:
            return None
        conditions.append(FoundRow.batch_seq == batch_seq)
    return conditions


def failures_of(session: Session, seqs: Sequence[int]) -> dict[int, FoundFailure]:
    """Returns failures by their ``seq``."""
    rows = session.execute(_detail_query().where(FoundRow.seq.in_(seqs))).all()
    return {row.seq: _failure(row) for row in rows}


def find_recorded(session: Session, seqs: Iterable[int | None]) -> set[int]:
    """Returns those of the failures that have a recording."""
    known = {seq for seq in seqs if seq is not None}
    query = (
        select(FoundRow.seq)
        .outerjoin(FailureRow, _OF_FAILURE)
        .outerjoin(RunRow, RunRow.seq == FoundRow.run_seq)
        .where(_HAS_IDENTICAL_RUN | (RunRow.trace_sha256 != ""), FoundRow.seq.in_(known))
    )
    return set(session.scalars(query))


_HAS_IDENTICAL_RUN = (FailureRow.trace != "") & (FailureRow.confirmation == Confirmation.CONFIRMED)
"""The trace of a flaky failure is of a second run that drove otherwise."""

_OF_FAILURE = (
    (FailureRow.campaign_seq == FoundRow.campaign_seq)
    & (FailureRow.number == FoundRow.number)
    & (FailureRow.place == FoundRow.place)
)


def _detail_query() -> Select[*tuple[Any, ...]]:
    batch_id = case((BatchRow.id.startswith(SINGLE_JOBS), ""), else_=BatchRow.id)
    return (
        select(
            FoundRow.seq,
            FoundRow.found_at,
            FoundRow.oracle,
            FoundRow.group.label("group_name"),
            FailureGroupRow.id.label("decided_id"),
            FoundRow.agent,
            FoundRow.configuration,
            FoundRow.configuration_id,
            FoundRow.town,
            FoundRow.at_fault,
            FoundRow.accountability,
            FoundRow.confirmation,
            FoundRow.number,
            FoundRow.place,
            CampaignRow.id.label("campaign_id"),
            FailureRow.kind,
            FailureRow.verdict,
            _HAS_IDENTICAL_RUN.label("has_identical_run"),
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
        .outerjoin(FailureGroupNameRow, FailureGroupNameRow.name == FoundRow.group)
        .outerjoin(
            FailureGroupRow,
            FailureGroupRow.seq == func.coalesce(FoundRow.group_seq, FailureGroupNameRow.group_seq),
        )
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
        group_id=row.decided_id or group_id(row.group_name),
        accountability=None if row.accountability is None else Accountability(row.accountability),
        campaign_id=row.campaign_id or "",
        evaluation=row.number,
        kind=kind,
        confirmation=Confirmation(row.confirmation) if row.confirmation else None,
        batch_id=row.batch_id or "",
        run_id=run_id,
        is_recorded=bool(row.has_identical_run or row.trace_sha256),
        avoidable_until=avoidable_until(verdict),
        sentence=failure_sentence(verdict, town=row.town, kind=kind),
        verdict=verdict,
    )
