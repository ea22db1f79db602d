"""Writing failures to the table of all campaigns and batches, in the order of finding them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import Any, cast

from sqlalchemy import Table, delete, exists, insert, select, update
from sqlalchemy.orm import Session

from drivora_service.oracles.accountability import accountability
from drivora_service.oracles.failure_facts import failure_group
from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.runs.report import RunReport, RunStatus
from drivora_service.store.campaign_tables import CampaignRow
from drivora_service.store.found_tables import FoundRow
from drivora_service.store.tables import BatchRow

FOUND = cast("Table", FoundRow.__table__)

Row = dict[str, Any]
"""Values of a row by column."""


def found_in_run(
    report: RunReport,
    *,
    run_seq: int,
    batch_seq: int,
    agent: str,
    town: str,
    found_at: datetime,
) -> list[Row]:
    """Returns the rows of the violations of a run that count; see :func:`write_found_in_runs`."""
    if report.status is not RunStatus.FINISHED:
        return []
    return [
        {
            **_facts(verdict),
            "found_at": found_at,
            "campaign_seq": None,
            "number": None,
            "run_seq": run_seq,
            "batch_seq": batch_seq,
            "place": place,
            "agent": agent,
            "town": town,
            "confirmation": "",
        }
        for place, verdict in enumerate(report.verdicts)
        if verdict.outcome is Outcome.VIOLATED and verdict.severity is not Severity.OBSERVATION
    ]


def write_found_in_runs(session: Session, rows: Sequence[Row]) -> None:
    """Writes the violations of runs, those of campaigns left out: these write their failures."""
    batches = {row["batch_seq"] for row in rows}
    if not batches:
        return
    of_campaigns = set(
        session.scalars(
            select(BatchRow.seq).where(
                BatchRow.seq.in_(batches),
                exists().where(CampaignRow.batch_id == BatchRow.id, CampaignRow.batch_id != ""),
            )
        )
    )
    _insert(session, [row for row in rows if row["batch_seq"] not in of_campaigns])


def found_in_campaign(
    violations: Iterable[Verdict],
    *,
    campaign_seq: int,
    number: int,
    agent: str,
    town: str,
    found_at: datetime,
) -> list[Row]:
    """Returns the rows of the failures of an evaluation, in the order of their places."""
    return [
        {
            **_facts(verdict),
            "found_at": found_at,
            "campaign_seq": campaign_seq,
            "number": number,
            "run_seq": None,
            "batch_seq": None,
            "place": place,
            "agent": agent,
            "town": town,
            "confirmation": "open",
        }
        for place, verdict in enumerate(violations)
    ]


def write_found_in_campaign(session: Session, rows: Sequence[Row]) -> None:
    """Writes the failures of a campaign."""
    _insert(session, rows)


def confirm_found(session: Session, campaign_seq: int, number: int, confirmation: str) -> None:
    """Writes whether an identical run repeated the failures of an evaluation."""
    session.execute(
        update(FoundRow)
        .where(FoundRow.campaign_seq == campaign_seq, FoundRow.number == number)
        .values(confirmation=confirmation)
    )


def forget_found(session: Session, run_seq: int) -> None:
    """Deletes the violations of a run that is queued again."""
    session.execute(delete(FoundRow).where(FoundRow.run_seq == run_seq))


def _insert(session: Session, rows: Sequence[Row]) -> None:
    if rows:
        session.connection().execute(insert(FOUND), list(rows))


def _facts(verdict: Verdict) -> Row:
    return {
        "oracle": verdict.oracle,
        "group_name": failure_group(verdict),
        "at_fault": verdict.at_fault,
        "accountability": accountability(verdict),
    }
