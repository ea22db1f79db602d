"""Evaluations and failures of a campaign as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pyarrow as pa

from drivora_service.store.database import Database
from drivora_service.studies.table_names import CampaignTableName
from drivora_service.studies.tables.table_forms import Row, Table

_PAGE = 500
_TIME = pa.timestamp("us", tz="UTC")
OBJECTIVE = "objective."
"""Prefix of the names of the columns of objectives."""


_EVALUATIONS = (
    ("evaluation", pa.int32()),
    ("generation", pa.int32()),
    ("origin", pa.string()),
    ("parents", pa.list_(pa.int32())),
    ("redrawn", pa.int32()),
    ("seed_number", pa.int32()),
    ("status", pa.string()),
    ("cause", pa.string()),
    ("violations", pa.int32()),
    ("at_fault_violations", pa.int32()),
    ("accountability", pa.string()),
    ("sim_time_s", pa.float64()),
    ("wall_time_s", pa.float64()),
    ("search_s", pa.float64()),
    ("prepare_s", pa.float64()),
    ("told_at", _TIME),
    ("scenario_sha256", pa.string()),
    ("trace_sha256", pa.string()),
    ("egos_sha256", pa.string()),
    ("genes", pa.list_(pa.float64())),
    ("metrics", pa.string()),
)
_FAILURES = (
    ("evaluation", pa.int32()),
    ("place", pa.int32()),
    ("oracle", pa.string()),
    ("kind", pa.string()),
    ("group", pa.int32()),
    ("ego", pa.string()),
    ("counterpart", pa.string()),
    ("at_fault", pa.bool_()),
    ("avoidable", pa.string()),
    ("accountability", pa.string()),
    ("confirmation", pa.string()),
    ("time_s", pa.float64()),
    ("avoidable_until_s", pa.float64()),
    ("x", pa.float64()),
    ("y", pa.float64()),
    ("ego_speed", pa.float64()),
    ("sentence", pa.string()),
    ("message", pa.string()),
    ("trace", pa.string()),
)


def campaign_table(
    database: Database, campaign_id: str, name: CampaignTableName, *, after: int = -1
) -> Table:
    """Returns a table of a campaign, finished or not.

    Args:
        database: Holds the campaign.
        campaign_id: Id of the campaign.
        name: Which table.
        after: Only evaluations of greater numbers.

    Raises:
        UnknownName: There is no such campaign.
    """
    with database.read() as transaction:
        objectives = transaction.campaign_rows.objectives(campaign_id)
    if name is CampaignTableName.FAILURES:
        return Table(
            schema=pa.schema(_FAILURES),
            pages=lambda: _failure_pages(database, campaign_id, after),
        )
    columns = [(OBJECTIVE + objective, pa.float64()) for objective in objectives]
    return Table(
        schema=pa.schema([*_EVALUATIONS, *columns]),
        pages=lambda: _evaluation_pages(database, campaign_id, objectives, after),
    )


def _evaluation_pages(
    database: Database, campaign_id: str, objectives: Sequence[str], after: int
) -> Iterator[Sequence[Row]]:
    while True:
        with database.read() as transaction:
            page = transaction.campaign_rows.evaluations(campaign_id, after=after, limit=_PAGE)
        for row in page:
            measured = row.pop("objectives")
            row.update((OBJECTIVE + name, measured.get(name)) for name in objectives)
        yield page
        if len(page) < _PAGE:
            return
        after = page[-1]["evaluation"]


def _failure_pages(database: Database, campaign_id: str, after: int) -> Iterator[Sequence[Row]]:
    while True:
        with database.read() as transaction:
            rows, last = transaction.campaign_rows.failures(
                campaign_id, after=after, evaluations=_PAGE
            )
        if not rows:
            return
        yield rows
        after = last
