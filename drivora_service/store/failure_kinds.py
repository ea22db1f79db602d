"""The counters of the kinds of failures of a campaign."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.oracles.accountability import Accountability
from drivora_service.shapes import combine
from drivora_service.store.campaign_records import Confirmation, FailureKind
from drivora_service.store.campaign_tables import FailureKindRow, FailureRow


def failure_kinds(session: Session, campaign_seq: int) -> tuple[FailureKind, ...]:
    """Returns the kinds of failures of a campaign, in the order of their first evaluations."""
    rows = session.scalars(
        select(FailureKindRow).where(FailureKindRow.campaign_seq == campaign_seq)
    )
    return tuple(
        combine(FailureKind, row, groups=row.groups or None)
        for row in sorted(rows, key=lambda row: (row.first, row.kind))
    )


def count_failures(session: Session, failures: Sequence[FailureRow]) -> None:
    """Counts the newly stored failures of one evaluation."""
    by_kind: dict[str, list[FailureRow]] = {}
    for failure in failures:
        by_kind.setdefault(failure.kind, []).append(failure)
    for kind, alike in by_kind.items():
        row = session.get(FailureKindRow, (alike[0].campaign_seq, kind))
        if row is None:
            row = FailureKindRow(
                campaign_seq=alike[0].campaign_seq,
                kind=kind,
                failures=0,
                violations=0,
                at_fault=0,
                avoidable=0,
                confirmed=0,
                flaky=0,
                first=alike[0].number,
                groups=0,
            )
            session.add(row)
        row.failures += 1
        row.violations += len(alike)
        row.at_fault += any(failure.at_fault for failure in alike)
        row.avoidable += any(
            failure.accountability == Accountability.AVOIDABLE for failure in alike
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
