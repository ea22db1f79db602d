"""Checks of the facets of runs and their counters against the runs."""

from __future__ import annotations

from collections.abc import Iterator

from sqlalchemy import ColumnElement, case, func, or_, select
from sqlalchemy.orm import Session

from drivora_service.store.runs.facet_tables import BatchFacetRow, FacetRow
from drivora_service.store.runs.run_tables import BatchRow, RunRow, VerdictRow
from drivora_service.store.upkeep.contradictions import Finding


def facet_findings(session: Session) -> Iterator[Finding]:
    """Compares the facets with the runs, and the counters with a recount."""
    yield from _facets_of_runs(session)
    yield from _facets_of_verdicts(session)
    yield from _counts_of_facets(session)
    yield from _counts_of_batches(session)


def _facets_of_runs(session: Session) -> Iterator[Finding]:
    violated = case((RunRow.violations.is_(None), None), else_=RunRow.violations > 0)
    query = (
        select(RunRow.id)
        .outerjoin(FacetRow, FacetRow.key == RunRow.facet)
        .where(
            or_(
                FacetRow.key.is_(None),
                FacetRow.agent != RunRow.agent,
                FacetRow.configuration_id != RunRow.configuration_id,
                FacetRow.town != RunRow.town,
                FacetRow.status != RunRow.status,
                FacetRow.violated.is_distinct_from(violated),
                FacetRow.accountability.is_distinct_from(RunRow.accountability),
            )
        )
    )
    for run_id in session.scalars(query):
        message = "lists find the run under an agent, town, status or verdict that it does not have"
        yield Finding(kind="wrong_facet", subject=run_id, message=message)


def _facets_of_verdicts(session: Session) -> Iterator[Finding]:
    query = (
        select(RunRow.id, VerdictRow.oracle)
        .join(VerdictRow, VerdictRow.run_seq == RunRow.seq)
        .where((VerdictRow.batch_seq != RunRow.batch_seq) | (VerdictRow.facet != RunRow.facet))
    )
    for run_id, oracle in session.execute(query):
        message = f"lists by oracle find the run's verdict of {oracle} in another batch or state"
        yield Finding(kind="wrong_facet", subject=run_id, message=message)


def _counts_of_facets(session: Session) -> Iterator[Finding]:
    counted = select(RunRow.facet, func.count()).group_by(RunRow.facet)
    found = {key: number for key, number in session.execute(counted)}  # noqa: C416 # rows, not pairs
    for facet in session.scalars(select(FacetRow)):
        number = found.get(facet.key, 0)
        if facet.runs != number:
            name = f"{facet.agent} on {facet.town}, {facet.status}"
            if facet.violated is not None:
                name += f", violated: {facet.violated}, {facet.accountability}"
            message = f"the counter says {facet.runs} runs; there are {number}"
            yield Finding(kind="wrong_count", subject=name, message=message)


def _counts_of_batches(session: Session) -> Iterator[Finding]:
    runs: ColumnElement[int] = func.count()
    counted = select(RunRow.batch_seq, RunRow.facet, runs).group_by(RunRow.batch_seq, RunRow.facet)
    found = {(batch, facet): number for batch, facet, number in session.execute(counted)}
    stored = select(BatchFacetRow.batch_seq, BatchFacetRow.facet, BatchFacetRow.runs)
    says = {(batch, facet): number for batch, facet, number in session.execute(stored)}
    wrong: dict[int, list[tuple[int, int, int]]] = {}
    for key in found.keys() | says.keys():
        if found.get(key, 0) != says.get(key, 0):
            wrong.setdefault(key[0], []).append((key[1], says.get(key, 0), found.get(key, 0)))
    for batch_seq, differences in sorted(wrong.items()):
        batch_id = session.scalar(select(BatchRow.id).where(BatchRow.seq == batch_seq))
        for facet, said, number in sorted(differences):
            status = session.scalar(select(FacetRow.status).where(FacetRow.key == facet))
            message = (
                f"the batch says {said} {status or 'unknown'} runs of facet {facet}; "
                f"there are {number}"
            )
            yield Finding(kind="wrong_count", subject=batch_id or str(batch_seq), message=message)
