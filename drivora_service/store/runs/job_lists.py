"""The runs on a page of a list, found by the facets that pass a filter."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence

from sqlalchemy import ColumnElement, Select, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from drivora_service.store.engine.merging import Branch, first_numbers, merge_branches
from drivora_service.store.runs.facet_tables import BatchFacetRow, FacetRow
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.runs.run_scope import RunScope, facet_conditions, has_verdict, run_scope
from drivora_service.store.runs.run_tables import RunRow, VerdictRow

Conditions = tuple[ColumnElement[bool], ...]


def list_run_numbers(
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
    scope = run_scope(session, wanted)
    if scope is None:
        return []
    if wanted == JobFilter(outcome=wanted.outcome, since=wanted.since, until=wanted.until):
        everything = Branch(number=RunRow.seq, conditions=scope.conditions_on_seq(RunRow.seq))
        return first_numbers(
            session, [everything], limit=limit, after=after, descending=newest_first
        )
    batch_seq = scope.batch_seq
    heads: list[tuple[int, _Source, int]] = []
    sources = _sources(wanted, scope)
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
    return merge_branches(fetch, branches=branches, limit=limit, descending=newest_first)


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


def _sources(wanted: JobFilter, scope: RunScope) -> Sequence[_Source]:
    if wanted.scenario_sha256:
        # A scenario has few runs: their other attributes are looked up one by one.
        conditions = [RunRow.document_sha256 == wanted.scenario_sha256, *scope.of_runs()]
        if wanted.oracle:
            conditions.append(has_verdict(wanted))
        return [_Source(RunRow.seq, RunRow.facet, tuple(conditions))]
    if wanted.oracle:
        said = (
            VerdictRow.oracle == wanted.oracle,
            VerdictRow.outcome == wanted.outcome,
            *scope.of_verdicts(),
        )
        faults = (None, False, True) if wanted.at_fault is None else (wanted.at_fault,)
        return [
            _Source(VerdictRow.run_seq, VerdictRow.facet, (*said, VerdictRow.at_fault.is_(fault)))
            for fault in faults
        ]
    return [_Source(RunRow.seq, RunRow.facet, scope.of_runs())]


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
    query = select(FacetRow.key, head).where(*facet_conditions(wanted))
    if batch_seq is None:
        query = query.where(FacetRow.runs > 0)
    else:
        query = query.join(BatchFacetRow, BatchFacetRow.facet == FacetRow.key).where(
            BatchFacetRow.batch_seq == batch_seq, BatchFacetRow.runs > 0
        )
    return [(number, source, key) for key, number in session.execute(query) if number is not None]
