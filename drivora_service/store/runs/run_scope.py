"""The conditions of a filter of runs, on runs, on verdicts and on facets."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, exists, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from drivora_service.oracles.verdicts.accountability import AT_FAULT, Accountability
from drivora_service.store.campaigns.campaign_tables import CampaignRow
from drivora_service.store.runs.facet_tables import FacetRow
from drivora_service.store.runs.facets import Facet
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.runs.run_tables import BatchRow, RunRow, VerdictRow


@dataclass(frozen=True, slots=True, kw_only=True)
class RunScope:
    """The batch and the time of submission that a filter restricts to.

    Attributes:
        batch_seq: ``seq`` of the batch; ``None``: any.
        first: Least ``seq`` of the runs; ``None``: any.
        end: Their ``seq`` is less than this; ``None``: any.
    """

    batch_seq: int | None
    first: int | None
    end: int | None

    def conditions_on_seq(
        self, number: InstrumentedAttribute[int]
    ) -> tuple[ColumnElement[bool], ...]:
        """Returns the conditions on the ``seq`` of a run."""
        conditions: list[ColumnElement[bool]] = []
        if self.first is not None:
            conditions.append(number >= self.first)
        if self.end is not None:
            conditions.append(number < self.end)
        return tuple(conditions)

    def of_runs(self) -> tuple[ColumnElement[bool], ...]:
        """Returns the conditions on runs."""
        of_batch = () if self.batch_seq is None else (RunRow.batch_seq == self.batch_seq,)
        return (*of_batch, *self.conditions_on_seq(RunRow.seq))

    def of_verdicts(self) -> tuple[ColumnElement[bool], ...]:
        """Returns the conditions on verdicts."""
        of_batch = () if self.batch_seq is None else (VerdictRow.batch_seq == self.batch_seq,)
        return (*of_batch, *self.conditions_on_seq(VerdictRow.run_seq))


def run_scope(session: Session, wanted: JobFilter) -> RunScope | None:
    """Returns the batch and the time of a filter, ``None`` if no run can pass it."""
    batch_ids = {wanted.batch_id} if wanted.batch_id else set()
    if wanted.campaign_id:
        of_campaign = select(CampaignRow.batch_id).where(CampaignRow.id == wanted.campaign_id)
        batch_ids.add(session.scalar(of_campaign) or "")
    batch_seq = None
    if batch_ids:
        # Two batches have no run in common.
        batch_id = batch_ids.pop() if len(batch_ids) == 1 else ""
        batch_seq = session.scalar(select(BatchRow.seq).where(BatchRow.id == batch_id))
        if batch_seq is None:
            return None
    return RunScope(
        batch_seq=batch_seq,
        first=None if wanted.since is None else _first_since(session, wanted.since),
        end=None if wanted.until is None else _first_since(session, wanted.until),
    )


def facet_conditions(wanted: JobFilter) -> list[ColumnElement[bool]]:
    """Returns the conditions of a filter on facets."""
    conditions: list[ColumnElement[bool]] = []
    if wanted.statuses:
        conditions.append(FacetRow.status.in_(sorted(wanted.statuses)))
    if wanted.agent:
        conditions.append(FacetRow.agent == wanted.agent)
    if wanted.configuration_id:
        conditions.append(FacetRow.configuration_id == wanted.configuration_id)
    if wanted.town:
        conditions.append(FacetRow.town == wanted.town)
    if wanted.violated is not None:
        conditions.append(FacetRow.violated.is_(wanted.violated))
    if wanted.failing is not None:
        conditions.append(FacetRow.failing.is_(wanted.failing))
    if wanted.accountability is not None:
        conditions.append(FacetRow.accountability == wanted.accountability)
    if wanted.at_fault is not None and not wanted.oracle:
        degrees = sorted(one for one in Accountability if (one in AT_FAULT) == wanted.at_fault)
        conditions.append(FacetRow.accountability.in_(degrees))
    return conditions


def facet_passes(facet: Facet, wanted: JobFilter) -> bool:
    """Whether the runs of a facet pass the conditions of a filter on facets."""
    if wanted.at_fault is not None and not wanted.oracle:
        degree = facet.accountability
        if degree is None or (degree in AT_FAULT) != wanted.at_fault:
            return False
    return (
        (not wanted.statuses or facet.status in wanted.statuses)
        and wanted.agent in ("", facet.agent)
        and wanted.configuration_id in ("", facet.configuration_id)
        and wanted.town in ("", facet.town)
        and wanted.violated in (None, facet.violated)
        and wanted.failing in (None, facet.failing)
        and wanted.accountability in (None, facet.accountability)
    )


def has_verdict(wanted: JobFilter) -> ColumnElement[bool]:
    """Returns the condition that a run has the wanted verdict of the wanted oracle."""
    said = exists().where(
        VerdictRow.run_seq == RunRow.seq,
        VerdictRow.oracle == wanted.oracle,
        VerdictRow.outcome == wanted.outcome,
    )
    if wanted.at_fault is None:
        return said
    # A plain comparison would be looked up in the index of all verdicts, not of those of the run.
    fault = func.coalesce(VerdictRow.at_fault, not wanted.at_fault)
    return said.where(fault == wanted.at_fault)


def _first_since(session: Session, time: datetime) -> int:
    """Returns the least ``seq`` such that all runs from it on were submitted at a time or later.

    Runs are numbered in the order of their submission, so that bisection needs no index.
    """
    low, high = 0, (session.scalar(select(func.max(RunRow.seq))) or 0) + 1
    while low < high:
        middle = (low + high) // 2
        found = session.execute(
            select(RunRow.seq, RunRow.created_at)
            .where(RunRow.seq >= middle)
            .order_by(RunRow.seq)
            .limit(1)
        ).one_or_none()
        if found is None or found.created_at >= time:
            high = middle
        else:
            low = found.seq + 1
    return low
