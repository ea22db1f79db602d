"""The counters of the kinds of failures of a campaign."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sqlalchemy import Select, select
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
        combine(FailureKind, row, clusters=row.clusters or None)
        for row in sorted(rows, key=lambda row: (row.first, row.key))
    )


def _of_campaign(campaign_seq: int) -> Select[FailureKindRow]:
    return select(FailureKindRow).where(FailureKindRow.campaign_seq == campaign_seq)


def count_failures(session: Session, failures: Sequence[FailureRow]) -> None:
    """Counts the failures of one evaluation, which have just been stored."""
    by_key: dict[str, list[FailureRow]] = {}
    for failure in failures:
        by_key.setdefault(failure.key, []).append(failure)
    for key, alike in by_key.items():
        row = session.get(FailureKindRow, (alike[0].campaign_seq, key))
        if row is None:
            row = FailureKindRow(
                campaign_seq=alike[0].campaign_seq,
                key=key,
                failures=0,
                violations=0,
                at_fault=0,
                avoidable=0,
                confirmed=0,
                flaky=0,
                first=alike[0].number,
                clusters=0,
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
    """Counts what the failures of one evaluation are about to be called."""
    for campaign_seq, key, before in {
        (failure.campaign_seq, failure.key, failure.confirmation) for failure in failures
    }:
        row = session.get_one(FailureKindRow, (campaign_seq, key))
        row.confirmed += (confirmation == Confirmation.CONFIRMED) - (
            before == Confirmation.CONFIRMED
        )
        row.flaky += (confirmation == Confirmation.FLAKY) - (before == Confirmation.FLAKY)


def count_clusters(session: Session, campaign_seq: int, keys: Mapping[str, set[int]]) -> None:
    """Writes how many clusters the failures of each key lie in."""
    rows = session.scalars(
        select(FailureKindRow).where(FailureKindRow.campaign_seq == campaign_seq)
    )
    for row in rows:
        row.clusters = len(keys.get(row.key, ()))
