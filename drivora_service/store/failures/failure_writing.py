"""Writing failures to the table of all campaigns and batches, in the order of finding them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime
from functools import cache
from typing import cast

from sqlalchemy import (
    Insert,
    Select,
    Table,
    bindparam,
    delete,
    exists,
    insert,
    literal_column,
    select,
    update,
)
from sqlalchemy.orm import Session

from drivora_service.oracles.verdict import Verdict
from drivora_service.oracles.verdicts.accountability import accountability
from drivora_service.oracles.verdicts.failure_definition import DEFAULT_DEFINITION
from drivora_service.oracles.verdicts.failure_facts import failure_group
from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.store.engine.plain_statements import Row, execute_many
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.runs.notable_verdicts import NotableVerdict
from drivora_service.store.runs.run_tables import BatchRow

FOUND = cast("Table", FoundRow.__table__)
_BATCHES = cast("Table", BatchRow.__table__)
_CAMPAIGNS = cast("Table", CampaignRow.__table__)


def make_found_rows_of_run(
    notable: Iterable[NotableVerdict],
    *,
    run_seq: int,
    batch_seq: int,
    agent: str,
    configuration: str,
    configuration_id: str,
    town: str,
    found_at: datetime,
) -> list[Row]:
    """Returns the rows of the violations of a run that count; see :func:`write_found_in_runs`."""
    return [
        {
            "oracle": one.verdict.oracle,
            "group_name": failure_group(one.verdict),
            "at_fault": one.verdict.at_fault,
            "accountability": one.accountability,
            "found_at": found_at,
            "campaign_seq": None,
            "number": None,
            "run_seq": run_seq,
            "batch_seq": batch_seq,
            "place": one.place,
            "agent": agent,
            "configuration": configuration,
            "configuration_id": configuration_id,
            "town": town,
            "confirmation": "",
            "is_counted": one.is_counted,
            "is_violation": one.is_violation,
        }
        for one in notable
        if one.is_violation or one.is_counted
    ]


def write_found_in_runs(session: Session, rows: Sequence[Row]) -> None:
    """Writes the violations of runs, those of campaigns left out: these write their failures."""
    batches = {row["batch_seq"] for row in rows}
    if not batches:
        return
    found = session.connection().execute(_of_campaigns(), {"batches": list(batches)})
    of_campaigns = {row[0] for row in found}
    _insert(session, [row for row in rows if row["batch_seq"] not in of_campaigns])


def make_found_rows_of_campaign(
    violations: Iterable[Verdict],
    *,
    campaign_seq: int,
    number: int,
    agent: str,
    configuration: str,
    configuration_id: str,
    town: str,
    found_at: datetime,
) -> list[Row]:
    """Returns the rows of the failures of an evaluation, in the order of their places."""
    return [
        {
            "oracle": verdict.oracle,
            "group_name": failure_group(verdict),
            "at_fault": verdict.at_fault,
            "accountability": accountability(verdict),
            "found_at": found_at,
            "campaign_seq": campaign_seq,
            "number": number,
            "run_seq": None,
            "batch_seq": None,
            "place": place,
            "agent": agent,
            "configuration": configuration,
            "configuration_id": configuration_id,
            "town": town,
            "confirmation": "open",
            # A campaign stores what it counts.
            "is_counted": True,
            "is_violation": DEFAULT_DEFINITION.looks_at(verdict),
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
    execute_many(session.connection(), _make_insert(), rows)


@cache
def _of_campaigns() -> Select[int]:
    """Returns the query for those of ``batches`` that are of campaigns."""
    return select(_BATCHES.c.seq).where(
        _BATCHES.c.seq.in_(bindparam("batches", expanding=True)),
        exists().where(
            _CAMPAIGNS.c.batch_id == _BATCHES.c.id,
            _CAMPAIGNS.c.batch_id != literal_column("''"),
        ),
    )


@cache
def _make_insert() -> Insert:
    return insert(FOUND)
