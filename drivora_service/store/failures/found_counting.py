"""Numbers of the failures of all campaigns and batches, with what they count."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import case, func, select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.failure_definition import (
    DefinitionOrigin,
    FailureDefinition,
    StatedDefinition,
    definition_of_document,
    state_definition,
)
from drivora_service.runs.run_report import RunStatus
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_tables import CampaignRow, StudyRow
from drivora_service.store.failures.failure_queries import conditions_of
from drivora_service.store.failures.failure_records import FoundFilter
from drivora_service.store.failures.failure_tables import FoundRow
from drivora_service.store.runs.batch_definitions import definition_of_batch
from drivora_service.store.runs.facet_tables import BatchFacetRow, FacetRow
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.runs.run_scope import facet_conditions
from drivora_service.store.runs.run_tables import BatchRow


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundCounts(Shape):
    """Numbers of failures that pass a filter.

    Attributes:
        failures: Number of failures.
        avoidable: Those that are the fault of an ego and avoidable.
        preventable: Those at the fault of others that a careful driver of the ego avoids.
        runs: Runs, and evaluations of campaigns, with one of them; null unless the filter names a
            batch, a campaign or a study.
        agent_failed_runs: Runs outside campaigns in which the ADS itself failed: failures that are
            no violations, and neither listed nor counted in `failures`; null if the filter asks for
            more than batch, ADS and network.
        definition: What they count; null if each run and campaign has its own, or the filter
            chooses by accountability or fault.
    """

    failures: int
    avoidable: int
    preventable: int
    runs: int | None
    agent_failed_runs: int | None
    definition: StatedDefinition | None


def count_found(session: Session, wanted: FoundFilter) -> FoundCounts:
    """Counts the failures that pass a filter."""
    definition = _definition(session, wanted)
    conditions = conditions_of(session, wanted)
    if conditions is None:
        return FoundCounts(
            failures=0,
            avoidable=0,
            preventable=0,
            runs=0,
            agent_failed_runs=None,
            definition=definition,
        )
    degrees = (Accountability.AVOIDABLE, Accountability.PREVENTABLE)
    of_degrees = [
        func.coalesce(func.sum(case((FoundRow.accountability == degree, 1), else_=0)), 0)
        for degree in degrees
    ]
    numbers = select(func.count(), *of_degrees).select_from(FoundRow).where(*conditions)
    failures, avoidable, preventable = session.execute(numbers).one()
    runs: int | None = None
    # Over everything, this would read all rows and not their index alone.
    if wanted.batch_id or wanted.campaign_id or wanted.study_id:
        of_runs = select(FoundRow.run_seq, FoundRow.campaign_seq, FoundRow.number)
        different = of_runs.where(*conditions).distinct().subquery()
        runs = session.scalar(select(func.count()).select_from(different)) or 0
    return FoundCounts(
        failures=failures,
        avoidable=avoidable,
        preventable=preventable,
        runs=runs,
        agent_failed_runs=_count_agent_failed(session, wanted),
        definition=definition,
    )


def _count_agent_failed(session: Session, wanted: FoundFilter) -> int | None:
    # Filters by anything else choose among violations, or cannot be answered by counters.
    answered = FoundFilter(
        batch_id=wanted.batch_id,
        agent=wanted.agent,
        configuration_id=wanted.configuration_id,
        town=wanted.town,
        counts=wanted.counts,
    )
    if wanted != answered:
        return None
    failed = JobFilter(
        statuses=frozenset({RunStatus.AGENT_FAILED}),
        agent=wanted.agent,
        configuration_id=wanted.configuration_id,
        town=wanted.town,
        # A definition that is asked for knows no failures that do not count.
        failing=True if wanted.counts is None else None,
    )
    of_campaigns = select(CampaignRow.batch_id).where(CampaignRow.batch_id != "")
    of_batch = (
        BatchRow.id == wanted.batch_id if wanted.batch_id else BatchRow.id.not_in(of_campaigns)
    )
    query = (
        select(func.coalesce(func.sum(BatchFacetRow.runs), 0))
        .join(FacetRow, FacetRow.key == BatchFacetRow.facet)
        .join(BatchRow, BatchRow.seq == BatchFacetRow.batch_seq)
        .where(*facet_conditions(failed), of_batch)
    )
    return session.scalar(query)


def _definition(session: Session, wanted: FoundFilter) -> StatedDefinition | None:
    if wanted.counts is not None:
        requested = FailureDefinition(counts=wanted.counts)
        return state_definition((requested,), DefinitionOrigin.REQUEST)
    if wanted.accountability is not None or wanted.at_fault is not None:
        return None
    if wanted.batch_id:
        return definition_of_batch(session, wanted.batch_id)
    for chosen, table in ((wanted.campaign_id, CampaignRow), (wanted.study_id, StudyRow)):
        if chosen:
            documents = session.scalars(select(table.document).where(table.id == chosen))
            return state_definition(map(definition_of_document, documents))
    return None
