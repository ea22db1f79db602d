"""Checks of stored campaigns for contradictions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import ColumnElement, case, func, select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.runs.report_encoding import report_from_json
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import Confirmation
from drivora_service.store.campaigns.campaign_tables import (
    CampaignRow,
    EvaluationRow,
    FailureKindRow,
    FailureRow,
)
from drivora_service.store.upkeep.contradictions import Finding


@dataclass(frozen=True, slots=True, kw_only=True)
class TracedFailure:
    """The trace of a failing evaluation.

    Attributes:
        name: Name of the file in the campaign's folder of traces.
        trace_sha256: Expected hash; "" for a failure that was not repeated, with any trace.
    """

    campaign_id: str
    name: str
    trace_sha256: str


def campaign_count_findings(session: Session) -> Iterator[Finding]:
    """Compares the counts of campaigns with their evaluations.

    As numbers are unique and start at 0, their count and the greatest of them reveal gaps.
    """
    number, status = EvaluationRow.number, EvaluationRow.status
    found = (
        func.count(number),
        func.coalesce(func.max(number) + 1, 0),
        *(func.count(number).filter(status == each) for each in EvaluationStatus),
        func.count(number).filter(EvaluationRow.violations > 0),
    )
    query = (
        select(CampaignRow, *found)
        .outerjoin(EvaluationRow, EvaluationRow.campaign_seq == CampaignRow.seq)
        .group_by(CampaignRow.seq)
    )
    for campaign, *numbers in session.execute(query):
        count, end, judged, invalid, failed, violating = numbers
        says = (
            campaign.evaluations,
            campaign.evaluations,
            campaign.judged,
            campaign.invalid,
            campaign.failed,
            campaign.violating,
        )
        holds = (count, end, judged, invalid, failed, violating)
        if says != holds:
            message = (
                f"the campaign says {campaign.evaluations} evaluations, {campaign.judged} judged, "
                f"{campaign.invalid} invalid, {campaign.failed} failed, {campaign.violating} "
                f"violating; there are {count} up to number {end - 1}, {judged}, {invalid}, "
                f"{failed} and {violating}"
            )
            yield Finding(kind="wrong_count", subject=campaign.id, message=message)


def failure_findings(session: Session) -> Iterator[Finding]:
    """Compares the counters of kinds of failures with a recount, and marks with the violations."""
    marked = (
        select(CampaignRow.id, func.count())
        .join(EvaluationRow, EvaluationRow.campaign_seq == CampaignRow.seq)
        .where(EvaluationRow.violating != (EvaluationRow.violations > 0))
        .group_by(CampaignRow.id)
    )
    for campaign_id, number in session.execute(marked):
        message = f"{number} evaluations are marked wrongly as with or without a violation"
        yield Finding(kind="wrong_count", subject=campaign_id, message=message)
    columns = (
        "failures",
        "violations",
        "at_fault",
        "avoidable",
        "confirmed",
        "flaky",
        "first",
        "groups",
    )
    says = {
        (row.campaign_seq, row.kind): tuple(getattr(row, name) for name in columns)
        for row in session.scalars(select(FailureKindRow))
    }
    kind = (FailureRow.campaign_seq, FailureRow.kind)
    recount = select(
        *kind,
        func.count(FailureRow.number.distinct()),
        func.count(),
        _evaluations_if(FailureRow.at_fault.is_(True)),
        _evaluations_if(FailureRow.accountability == Accountability.AVOIDABLE),
        _evaluations_if(FailureRow.confirmation == Confirmation.CONFIRMED),
        _evaluations_if(FailureRow.confirmation == Confirmation.FLAKY),
        func.min(FailureRow.number),
        func.count(FailureRow.group.distinct()),
    ).group_by(*kind)
    found = {(row[0], row[1]): tuple(row[2:]) for row in session.execute(recount)}
    for campaign_seq, name in sorted(says.keys() | found.keys()):
        said, holds = says.get((campaign_seq, name)), found.get((campaign_seq, name))
        if said != holds:
            subject = session.scalar(select(CampaignRow.id).where(CampaignRow.seq == campaign_seq))
            message = (
                f"the counters of failures {name!r} ({', '.join(columns)}) say {said}; "
                f"there are {holds}"
            )
            yield Finding(kind="wrong_count", subject=subject or "", message=message)


def _evaluations_if(condition: ColumnElement[bool]) -> ColumnElement[int]:
    return func.count(case((condition, FailureRow.number)).distinct())


def traced_failures(session: Session) -> tuple[TracedFailure, ...]:
    """Returns the traces of all failures that have one, each once."""
    query = (
        select(CampaignRow.id, FailureRow.trace, FailureRow.confirmation, EvaluationRow.report)
        .join(FailureRow, FailureRow.campaign_seq == CampaignRow.seq)
        .join(
            EvaluationRow,
            (EvaluationRow.campaign_seq == FailureRow.campaign_seq)
            & (EvaluationRow.number == FailureRow.number),
        )
        .where(FailureRow.trace != "", FailureRow.place == 0)
    )
    return tuple(
        TracedFailure(
            campaign_id=campaign_id,
            name=name,
            trace_sha256=report_from_json(report).trace_sha256
            if confirmation == Confirmation.CONFIRMED
            else "",
        )
        for campaign_id, name, confirmation, report in session.execute(query)
    )
