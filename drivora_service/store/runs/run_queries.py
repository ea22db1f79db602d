"""Queries of runs for lists."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sqlalchemy import Label, Row, Select, case, select

from drivora_service.shapes import field_names, read_all
from drivora_service.store.runs.batch_repository import SINGLE_JOBS
from drivora_service.store.runs.run_records import RunSummary
from drivora_service.store.runs.run_tables import BatchRow, RunRow


def run_query() -> Select[*tuple[Any, ...]]:
    """Returns a query of the columns of a summary, labelled by the names of its fields."""
    elsewhere = {
        "batch_id": case((BatchRow.id.startswith(SINGLE_JOBS), ""), else_=BatchRow.id),
        "seed": RunRow.seed_override,
        "scenario_sha256": RunRow.document_sha256,
    }
    columns: list[Label[Any]] = [
        (elsewhere[name] if name in elsewhere else getattr(RunRow, name)).label(name)
        for name in field_names(RunSummary)
    ]
    return select(*columns).join(BatchRow, BatchRow.seq == RunRow.batch_seq)


def summaries(rows: Iterable[Row[*tuple[Any, ...]]]) -> tuple[RunSummary, ...]:
    """Reads the rows of such a query."""
    return read_all(RunSummary, (row._asdict() for row in rows))
