"""The runs on a page of a list, found by the facets that pass a filter."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence

from sqlalchemy import ColumnElement, Select, exists, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from drivora_service.store.facet_tables import BatchFacetRow, FacetRow
from drivora_service.store.merging import Branch, first_numbers, merged
from drivora_service.store.records import JobFilter
from drivora_service.store.tables import BatchRow, RunRow, VerdictRow

Conditions = tuple[ColumnElement[bool], ...]


def listed_runs(
    session: Session, wanted: JobFilter, *, limit: int, after: int | None, newest_first: bool
) -> list[int]:
    """Returns the ``seq`` of the first runs that pass a filter, in their order.

    Args:
        session: Session of the transaction.
        wanted: The filter.
        limit: Greatest number of runs.
        after: Only those behind this ``seq``, in the order; ``None``: from the beginning.
        newest_first: Whether the greatest come first.
    """
    if wanted == JobFilter(outcome=wanted.outcome, at_fault=wanted.at_fault):
        everything = Branch(number=RunRow.seq, conditions=())
        return first_numbers(
            session, [everything], limit=limit, after=after, descending=newest_first
        )
    batch_seq = None
    if wanted.batch_id:
        batch_seq = session.scalar(select(BatchRow.seq).where(BatchRow.id == wanted.batch_id))
        if batch_seq is None:
            return []
    heads: list[tuple[int, _Source, int]] = []
    sources = _sources(wanted, batch_seq)
    for source in sources:
        heads += _heads(session, source, wanted, batch_seq, after, newest_first=newest_first)
    # If there are more facets than wanted rows, the facets with the first heads hold all of these
    # rows. A run may be the head of its facet in every source.
    choose = heapq.nlargest if newest_first else heapq.nsmallest
    keys: dict[_Source, list[int]] = {}
    for _, source, key in choose(limit * len(sources), heads, key=lambda head: head[0]):
        keys.setdefault(source, []).append(key)

    def fetch(take: int) -> Iterable[tuple[tuple[_Source, int], int]]:
        for source, of_source in keys.items():
            query = source.first(of_source, take, after, newest_first=newest_first)
            for key, number in session.execute(query):
                yield (source, key), number

    branches = sum(map(len, keys.values()))
    return merged(fetch, branches=branches, limit=limit, descending=newest_first)


class _Source:
    """An index in which the runs of each facet are adjacent."""

    def __init__(
        self,
        number: InstrumentedAttribute[int],
        facet: InstrumentedAttribute[int],
        conditions: Conditions,
    ) -> None:
        self.number = number
        self.facet = facet
        self.conditions = conditions

    def head(self, after: int | None, *, newest_first: bool) -> Select[int]:
        """Selects the first run of the facet of the enclosing query."""
        return self._of_facet(1, after, newest_first=newest_first)

    def first(
        self, keys: Sequence[int], take: int, after: int | None, *, newest_first: bool
    ) -> Select[int, int]:
        """Selects the first ``limit`` runs of each facet, with its number, in any order.

        One statement of the same text for all facets: compiling a union of one part for each takes
        longer than executing it.
        """
        of_facet = self._of_facet(take, after, newest_first=newest_first)
        return (
            select(FacetRow.key, RunRow.seq)
            .join(RunRow, RunRow.seq.in_(of_facet))
            .where(FacetRow.key.in_(keys))
        )

    def _of_facet(self, limit: int, after: int | None, *, newest_first: bool) -> Select[int]:
        # A run has a verdict of an oracle for each ego.
        query = select(self.number).where(*self.conditions, self.facet == FacetRow.key).distinct()
        if after is not None:
            query = query.where(self.number < after if newest_first else self.number > after)
        ordered = query.order_by(self.number.desc() if newest_first else self.number)
        return ordered.limit(limit).correlate(FacetRow)


def _sources(wanted: JobFilter, batch_seq: int | None) -> Sequence[_Source]:
    if wanted.scenario_sha256:
        # A scenario has few runs: their other attributes are looked up one by one.
        conditions: list[ColumnElement[bool]] = [RunRow.document_sha256 == wanted.scenario_sha256]
        if batch_seq is not None:
            conditions.append(RunRow.batch_seq == batch_seq)
        if wanted.oracle:
            conditions.append(_has_verdict(wanted))
        return [_Source(RunRow.seq, RunRow.facet, tuple(conditions))]
    if wanted.oracle:
        said: list[ColumnElement[bool]] = [
            VerdictRow.oracle == wanted.oracle,
            VerdictRow.outcome == wanted.outcome,
        ]
        if batch_seq is not None:
            said.insert(0, VerdictRow.batch_seq == batch_seq)
        faults = (None, False, True) if wanted.at_fault is None else (wanted.at_fault,)
        return [
            _Source(VerdictRow.run_seq, VerdictRow.facet, (*said, VerdictRow.at_fault.is_(fault)))
            for fault in faults
        ]
    in_batch: Conditions = () if batch_seq is None else (RunRow.batch_seq == batch_seq,)
    return [_Source(RunRow.seq, RunRow.facet, in_batch)]


def _heads(
    session: Session,
    source: _Source,
    wanted: JobFilter,
    batch_seq: int | None,
    after: int | None,
    *,
    newest_first: bool,
) -> list[tuple[int, _Source, int]]:
    """Returns the facets that pass a filter, each after its first run and its index."""
    head = source.head(after, newest_first=newest_first).scalar_subquery()
    query = select(FacetRow.key, head).where(*_conditions(wanted))
    if batch_seq is None:
        query = query.where(FacetRow.runs > 0)
    else:
        query = query.join(BatchFacetRow, BatchFacetRow.facet == FacetRow.key).where(
            BatchFacetRow.batch_seq == batch_seq, BatchFacetRow.runs > 0
        )
    return [(number, source, key) for key, number in session.execute(query) if number is not None]


def _conditions(wanted: JobFilter) -> list[ColumnElement[bool]]:
    conditions: list[ColumnElement[bool]] = []
    if wanted.statuses:
        conditions.append(FacetRow.status.in_(sorted(wanted.statuses)))
    if wanted.agent:
        conditions.append(FacetRow.agent == wanted.agent)
    if wanted.town:
        conditions.append(FacetRow.town == wanted.town)
    if wanted.violated is not None:
        conditions.append(FacetRow.violated.is_(wanted.violated))
    if wanted.accountability is not None:
        conditions.append(FacetRow.accountability == wanted.accountability)
    return conditions


def _has_verdict(wanted: JobFilter) -> ColumnElement[bool]:
    said = exists().where(
        VerdictRow.run_seq == RunRow.seq,
        VerdictRow.oracle == wanted.oracle,
        VerdictRow.outcome == wanted.outcome,
    )
    return said if wanted.at_fault is None else said.where(VerdictRow.at_fault == wanted.at_fault)
