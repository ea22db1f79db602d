"""Facets: the attributes that lists of runs filter by, as one number a run, with counters.

The facet of a run is its agent, its configuration, its town, its status, whether it violated an
oracle, how far an ego is accountable for that, and whether that is a failure. A million runs have a
few hundred facets. An index on the facet and the order of submission therefore serves every
combination of these filters, and the counters of the facets are the counts of the batches and of
the service.

The counters change with the flush that writes the runs, in the same transaction. Only statements
that change many runs at once, which no flush sees, call :func:`add_counts` themselves.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Any

from sqlalchemy import inspect, update
from sqlalchemy.orm import Session

from drivora_service.store.engine.dialects import insert_class
from drivora_service.store.engine.plain_statements import execute_many
from drivora_service.store.runs.facet_tables import BatchFacetRow, FacetRow
from drivora_service.store.runs.run_tables import RunRow

_RUN_FIELDS = (
    "agent",
    "town",
    "status",
    "violations",
    "accountability",
    "configuration",
    "configuration_id",
    "failures",
)

FacetChanges = Counter[tuple[int, "Facet"]]
"""Changes of the numbers of runs, by the ``seq`` of their batch and their facet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Facet:
    """The attributes that lists of runs filter by.

    Attributes:
        violated: Whether an oracle was violated; ``None`` unless finished.
        accountability: The strongest of the violations, or ``None``.
        configuration_id: Id of the agent with its parameters; "": not known.
        configuration: The same in words, which the id determines.
        failing: Whether it has a failure by its own definition; ``None`` if it says nothing about
            its ADS, or was judged before this was recorded.
    """

    agent: str
    town: str
    status: str
    violated: bool | None
    accountability: str | None
    configuration_id: str = ""
    configuration: str = field(default="", compare=False)
    failing: bool | None = None


@lru_cache(maxsize=4096)
def facet_key(facet: Facet) -> int:
    """Returns the number of a facet: a hash of 63 bits, so that no lookup is needed."""
    parts: list[object] = [
        facet.agent,
        facet.town,
        facet.status,
        facet.violated,
        facet.accountability,
    ]
    if facet.configuration_id:
        parts.append(facet.configuration_id)
    if facet.failing is not None:
        parts.append({"failing": facet.failing})
    digest = hashlib.blake2b(json.dumps(parts).encode(), digest_size=8).digest()
    return int.from_bytes(digest) >> 1


@lru_cache(maxsize=4096)
def make_facet_with_key(
    agent: str,
    town: str,
    status: str,
    violations: int | None = None,
    accountability: str | None = None,
    configuration: str = "",
    configuration_id: str = "",
    failures: int | None = None,
) -> tuple[Facet, int]:
    """Returns the facet of a run with these values, and its number."""
    facet = _facet(
        agent,
        town,
        status,
        violations,
        accountability,
        configuration,
        configuration_id,
        failures,
    )
    return facet, facet_key(facet)


def facet_of(row: RunRow) -> Facet:
    """Returns the facet of a row's current values."""
    return _facet(*(getattr(row, name) for name in _RUN_FIELDS))


def count_changes(session: Session, *_: object) -> None:
    """Counts the changes of a flush; a listener of ``before_flush``."""
    changes: FacetChanges = Counter()
    for row in session.new:
        if isinstance(row, RunRow):
            row.facet = facet_key(facet_of(row))
            changes[row.batch_seq, facet_of(row)] += 1
    for row in session.dirty:
        if isinstance(row, RunRow):
            after = facet_of(row)
            if facet_key(after) != row.facet:
                changes[row.batch_seq, _facet_before(session, row)] -= 1
                changes[row.batch_seq, after] += 1
                row.facet = facet_key(after)
    for row in session.deleted:
        if isinstance(row, RunRow):
            changes[row.batch_seq, _facet_before(session, row)] -= 1
    add_counts(session, changes)


def add_counts(session: Session, changes: Mapping[tuple[int, Facet], int]) -> None:
    """Adds to the counters of facets and of batches; makes those that are missing."""
    totals: Counter[Facet] = Counter()
    for (_, facet), number in changes.items():
        totals[facet] += number
    # In a fixed order, so that two transactions never wait for each other.
    facets = [
        {
            "key": facet_key(facet),
            "agent": facet.agent,
            "town": facet.town,
            "status": facet.status,
            "violated": facet.violated,
            "accountability": facet.accountability,
            "configuration": facet.configuration,
            "configuration_id": facet.configuration_id,
            "failing": facet.failing,
            "runs": number,
        }
        for facet, number in sorted(totals.items(), key=lambda item: facet_key(item[0]))
        if number
    ]
    batches = [
        {"batch_seq": batch_seq, "facet": facet_key(facet), "runs": number}
        for (batch_seq, facet), number in sorted(
            changes.items(), key=lambda item: (item[0][0], facet_key(item[0][1]))
        )
        if number
    ]
    for table, keys, rows in (
        (FacetRow.__table__, ("key",), facets),
        (BatchFacetRow.__table__, ("batch_seq", "facet"), batches),
    ):
        if rows:
            connection = session.connection()
            execute_many(connection, _make_upsert(connection.dialect.name, table, keys), rows)


def subtract_runs(session: Session, numbers: Mapping[tuple[int, int], int]) -> None:
    """Subtracts deleted runs from the counters.

    Args:
        session: Session of the transaction that deletes them.
        numbers: Numbers of runs, by the ``seq`` of their batch and the number of their facet.
    """
    for (batch_seq, key), number in sorted(numbers.items()):
        session.execute(
            update(BatchFacetRow)
            .where(BatchFacetRow.batch_seq == batch_seq, BatchFacetRow.facet == key)
            .values(runs=BatchFacetRow.runs - number)
        )
        session.execute(
            update(FacetRow).where(FacetRow.key == key).values(runs=FacetRow.runs - number)
        )


@cache
def _make_upsert(dialect: str, table: Any, keys: tuple[str, ...]) -> Any:
    insert = insert_class(dialect)(table)
    return insert.on_conflict_do_update(
        index_elements=list(keys), set_={"runs": table.c.runs + insert.excluded.runs}
    )


def _facet_before(session: Session, row: RunRow) -> Facet:
    """Returns the facet with which a row was last written."""
    old = inspect(row).committed_state
    facet = _facet(*(old.get(name, getattr(row, name)) for name in _RUN_FIELDS))
    if facet_key(facet) == row.facet:
        return facet
    # An attribute was set before its old value was read: only the stored number tells.
    return facet_of_row(session.get_one(FacetRow, row.facet))


def facet_of_row(row: FacetRow) -> Facet:
    """Returns the facet that a row counts."""
    return Facet(
        agent=row.agent,
        town=row.town,
        status=row.status,
        violated=row.violated,
        accountability=row.accountability,
        configuration=row.configuration,
        configuration_id=row.configuration_id,
        failing=row.failing,
    )


def _facet(
    agent: str,
    town: str,
    status: str,
    violations: int | None,
    accountability: str | None,
    configuration: str,
    configuration_id: str,
    failures: int | None,
) -> Facet:
    return Facet(
        agent=agent,
        town=town,
        status=status,
        violated=None if violations is None else violations > 0,
        accountability=accountability,
        configuration=configuration,
        configuration_id=configuration_id,
        failing=None if failures is None else failures > 0,
    )
