"""Looking for contradictions in what is stored of campaigns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.runs.encoding import report_from_json
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaign_records import Confirmation
from drivora_service.store.campaign_tables import CampaignRow, EvaluationRow, FailureRow
from drivora_service.store.findings import Finding


@dataclass(frozen=True, slots=True, kw_only=True)
class TracedFailure:
    """The trace of a failing evaluation.

    Attributes:
        name: Of the file, in the campaign's folder of traces.
        trace_sha256: Hash that it must have; "" for a failure that did not happen again, whose
            trace may be any.
    """

    campaign_id: str
    name: str
    trace_sha256: str


def campaign_counts(session: Session) -> Iterator[Finding]:
    """Compares what campaigns say of their evaluations with these.

    As numbers are unique and begin with 0, their count and the greatest of them tell of gaps.
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


def traced_failures(session: Session) -> tuple[TracedFailure, ...]:
    """Gives the traces of all failures that have one, each once."""
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
