"""The counters of the kinds of failures of a campaign."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_records import Confirmation, FailureKind
from drivora_service.store.campaigns.campaign_tables import FailureKindRow, FailureRow


def failure_kinds(session: Session, campaign_seq: int) -> tuple[FailureKind, ...]:
    """Returns the kinds of failures of a campaign, in the order of their first evaluations."""
    rows = session.scalars(
        select(FailureKindRow).where(FailureKindRow.campaign_seq == campaign_seq)
    )
    return tuple(
        combine(FailureKind, row, groups=row.groups or None)
        for row in sorted(rows, key=lambda row: (row.first, row.kind))
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class NewFailure:
    """A failure that is stored now, with the columns that identify it.

    Attributes:
        place: Its place among the failures of its evaluation.
    """

    campaign_seq: int
    number: int
    place: int
    kind: str
    accountability: Accountability
    verdict: Verdict


def count_failures(session: Session, failures: Iterable[NewFailure]) -> None:
    """Counts newly stored failures, all those of an evaluation among them."""
    together: dict[tuple[int, str, int], list[NewFailure]] = {}
    for failure in failures:
        key = (failure.campaign_seq, failure.kind, failure.number)
        together.setdefault(key, []).append(failure)
    rows: dict[tuple[int, str], FailureKindRow] = {}
    for (campaign_seq, kind, number), alike in together.items():
        row = rows.get((campaign_seq, kind)) or session.get(FailureKindRow, (campaign_seq, kind))
        if row is None:
            row = FailureKindRow(
                campaign_seq=campaign_seq,
                kind=kind,
                failures=0,
                violations=0,
                at_fault=0,
                avoidable=0,
                confirmed=0,
                flaky=0,
                first=number,
                groups=0,
            )
            session.add(row)
        rows[(campaign_seq, kind)] = row
        row.failures += 1
        row.violations += len(alike)
        row.at_fault += any(failure.verdict.at_fault for failure in alike)
        row.avoidable += any(
            failure.accountability is Accountability.AVOIDABLE for failure in alike
        )


def count_confirmation(
    session: Session, failures: Iterable[FailureRow], confirmation: Confirmation
) -> None:
    """Counts the new confirmation of the failures of one evaluation."""
    for campaign_seq, kind, before in {
        (failure.campaign_seq, failure.kind, failure.confirmation) for failure in failures
    }:
        row = session.get_one(FailureKindRow, (campaign_seq, kind))
        row.confirmed += (confirmation == Confirmation.CONFIRMED) - (
            before == Confirmation.CONFIRMED
        )
        row.flaky += (confirmation == Confirmation.FLAKY) - (before == Confirmation.FLAKY)


def count_groups(session: Session, campaign_seq: int, groups: Mapping[str, set[int]]) -> None:
    """Writes the number of groups of each kind of failure."""
    rows = session.scalars(
        select(FailureKindRow).where(FailureKindRow.campaign_seq == campaign_seq)
    )
    for row in rows:
        row.groups = len(groups.get(row.kind, ()))
