"""The results of runs, page by page, for tables of all of them.

A run of a batch, and of a campaign on a service, has a row of its own. The evaluations of a
campaign of a command have none, and runs that retention removed have none any more: these are read
from the journals of their campaigns.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from pydantic_core import from_json
from sqlalchemy import ColumnElement, or_, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.failure_definition import definition_from_json
from drivora_service.store.campaigns.campaign_tables import CampaignRow, StudyRow
from drivora_service.store.campaigns.evaluation_results import evaluation_results
from drivora_service.store.runs.facet_tables import FacetRow
from drivora_service.store.runs.result_conditions import campaign_columns, is_named, seeds_of
from drivora_service.store.runs.result_records import EvaluationPlace, ResultFilter, StoredResult
from drivora_service.store.runs.run_queries import run_query
from drivora_service.store.runs.run_records import JobFilter
from drivora_service.store.runs.run_scope import facet_conditions, has_verdict, run_scope
from drivora_service.store.runs.run_tables import BatchRow, ReportRow, RunRow

_AGAIN = "-again"
_SEED = "-seed-"
"""Part of the id of a run of a campaign's seed scenario, which is no evaluation."""
"""Ends the ids of the runs of a campaign that confirm failures."""


class ResultRepository:
    """Reads the results of many runs."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def check(self, wanted: ResultFilter) -> None:
        """Checks that the batches, campaigns and studies of a choice exist.

        Raises:
            UnknownName: One of them does not.
        """
        for kind, column, ids in (
            ("batch", BatchRow.id, wanted.batch_ids),
            ("campaign", CampaignRow.id, wanted.campaign_ids),
            ("study", StudyRow.id, wanted.study_ids),
        ):
            for one in ids:
                if self._session.scalar(select(column).where(column == one)) is None:
                    raise UnknownName(kind, one, ())

    def numbers(self, wanted: ResultFilter, *, after: int, limit: int) -> Sequence[int]:
        """Returns the ``seq`` of chosen runs that have a row, in the order of their submission.

        Args:
            wanted: The choice.
            after: Only those of greater numbers.
            limit: Greatest number of runs.
        """
        runs = wanted.runs
        conditions = [RunRow.seq > after]
        times = run_scope(self._session, JobFilter(since=runs.since, until=runs.until))
        if times is not None:
            conditions += times.conditions_on_seq(RunRow.seq)
        if wanted.names_any:
            of_campaigns = select(CampaignRow.batch_id).where(
                is_named(wanted), CampaignRow.batch_id != ""
            )
            batches = select(BatchRow.seq).where(
                or_(BatchRow.id.in_(wanted.batch_ids), BatchRow.id.in_(of_campaigns))
            )
            conditions.append(RunRow.batch_seq.in_(batches))
        conditions += _conditions(runs)
        query = select(RunRow.seq).where(*conditions).order_by(RunRow.seq).limit(limit)
        return self._session.scalars(query).all()

    def runs(self, numbers: Sequence[int], *, with_seeds: bool) -> list[StoredResult]:
        """Returns the runs of these ``seq`` that there are, in the order of their submission.

        Args:
            numbers: Their numbers.
            with_seeds: Whether to read the scenarios for the seeds that these have.
        """
        rows = self._session.execute(
            run_query()
            .add_columns(ReportRow.body.label("report"), RunRow.definition)
            .outerjoin(ReportRow, ReportRow.run_seq == RunRow.seq)
            .where(RunRow.seq.in_(numbers))
            .order_by(RunRow.seq)
        ).all()
        campaigns = self._campaigns_of({row.batch_id for row in rows})
        hashes = {row.scenario_sha256 for row in rows} if with_seeds else set()
        seeds = seeds_of(self._session, hashes)
        found = []
        for row in rows:
            campaign = campaigns.get(row.batch_id)
            summary = row._asdict()
            report, definition = summary.pop("report"), summary.pop("definition")
            values = {
                **summary,
                **campaign_columns(campaign, None if _SEED in row.id else row.item),
                "run_id": row.id,
                "source": "run",
                "confirms": campaign is not None and row.id.endswith(_AGAIN),
                "seed": seeds.get(row.scenario_sha256) if row.seed is None else row.seed,
            }
            found.append(
                StoredResult(
                    values=values,
                    report={} if report is None else from_json(report),
                    definition=definition_from_json(definition),
                )
            )
        return found

    def evaluations(
        self,
        wanted: ResultFilter,
        *,
        after: EvaluationPlace | None,
        limit: int,
        with_seeds: bool,
    ) -> tuple[list[StoredResult], EvaluationPlace | None]:
        """Returns chosen evaluations whose run has no row; see ``evaluation_results``."""
        return evaluation_results(
            self._session, wanted, after=after, limit=limit, with_seeds=with_seeds
        )

    def _campaigns_of(self, batch_ids: Iterable[str]) -> Mapping[str, CampaignRow]:
        """Returns the campaigns of batches, by the ids of these."""
        # The second condition is that of the index.
        conditions = CampaignRow.batch_id.in_(list(batch_ids)), CampaignRow.batch_id != ""
        rows = self._session.scalars(select(CampaignRow).where(*conditions))
        return {row.batch_id: row for row in rows}


def _conditions(wanted: JobFilter) -> list[ColumnElement[bool]]:
    """Returns the conditions on the attributes of a run, its time of submission left out."""
    conditions: list[ColumnElement[bool]] = []
    if facets := facet_conditions(wanted):
        conditions.append(RunRow.facet.in_(select(FacetRow.key).where(*facets)))
    if wanted.scenario_sha256:
        conditions.append(RunRow.document_sha256 == wanted.scenario_sha256)
    if wanted.oracle:
        conditions.append(has_verdict(wanted))
    return conditions
