"""Jobs: submitting, reading and cancelling them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.failure_definition import (
    DEFAULT_DEFINITION,
    FailureDefinition,
    definition_from_json,
    state_definition,
)
from drivora_service.runs.report_encoding import report_from_json
from drivora_service.runs.run_report import RunReport, RunStatus
from drivora_service.shapes import combine, field_names, read_all
from drivora_service.store.campaigns.campaign_tables import CampaignRow, is_campaign_of
from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.engine.chunks import batched
from drivora_service.store.engine.paging import make_token, read_token
from drivora_service.store.queue.cancelling import cancel_runs
from drivora_service.store.queue.submitting import count_queued_runs, submit_runs
from drivora_service.store.runs.facet_tables import FacetRow
from drivora_service.store.runs.job_lists import list_run_numbers
from drivora_service.store.runs.notable_verdicts import find_failing_verdicts
from drivora_service.store.runs.run_counts import RunCounts, count_runs
from drivora_service.store.runs.run_queries import run_query, summaries
from drivora_service.store.runs.run_records import (
    Attempt,
    JobFilter,
    NewRun,
    Page,
    RunRecord,
    RunSummary,
)
from drivora_service.store.runs.run_tables import AttemptRow, BatchRow, ReportRow, RunRow


class JobRepository:
    """Reads and writes jobs."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def submit(
        self,
        runs: Sequence[NewRun],
        *,
        batch_id: str = "",
        owner_id: str = "",
        queue_limit: int | None = None,
    ) -> tuple[str, ...]:
        """Queues runs; returns their ids, in order.

        A run whose scenario is quarantined ends at once with the cause ``quarantined``.

        Args:
            runs: The runs.
            batch_id: Their batch; "": posted singly, at interactive priority.
            owner_id: Process for which runs that are posted singly are reserved; "": any server.
            queue_limit: Greatest number of queued runs; ``None``: any number.

        Raises:
            UnknownName: There is no such batch.
            Conflict: The batch was cancelled.
            QueueFull: The queue would grow beyond its limit; nothing was queued.
        """
        return submit_runs(
            self._session, runs, batch_id=batch_id, owner_id=owner_id, queue_limit=queue_limit
        )

    def get(self, job_id: str) -> RunSummary:
        """Returns a job.

        Raises:
            UnknownName: There is none of this id.
        """
        found = summaries(self._session.execute(run_query().where(RunRow.id == job_id)))
        if not found:
            raise UnknownName("run", job_id, ())
        return found[0]

    def detail(self, job_id: str) -> RunRecord:
        """Returns a job with the results of its run.

        Raises:
            UnknownName: There is none of this id.
        """
        summary = self.get(job_id)
        campaign_id = self._campaign_of(job_id)
        definition = self.definition(job_id)
        known = {
            "tries": self.attempts(job_id),
            "campaign_id": campaign_id,
            "evaluation": summary.item if campaign_id else None,
            "definition": state_definition((definition,)),
        }
        report = self.report(job_id) if summary.status.is_final else None
        if report is None:
            return combine(RunRecord, summary, **known)
        return combine(
            RunRecord,
            summary,
            report,
            **known,
            failing_verdicts=find_failing_verdicts(report, definition),
            error=report.failure,
            step_cost_us=report.step_cost_us if report.steps else None,
            simulation_sha256=report.trace_sha256,
        )

    def page(
        self,
        wanted: JobFilter = JobFilter(),  # noqa: B008 # frozen
        *,
        limit: int = 50,
        page_token: str = "",
        newest_first: bool = True,
    ) -> Page[RunSummary]:
        """Returns the jobs that pass a filter, in the order of their submission.

        Raises:
            InvalidDocument: The token is not one of this query.
        """
        scope = f"jobs {newest_first} {_scope(wanted)}"
        last = read_token(scope, page_token) if page_token else None
        numbers = list_run_numbers(
            self._session, wanted, limit=limit + 1, after=last, newest_first=newest_first
        )
        more = make_token(scope, numbers[limit - 1]) if len(numbers) > limit else ""
        order = RunRow.seq.desc() if newest_first else RunRow.seq
        query = run_query().where(RunRow.seq.in_(numbers[:limit])).order_by(order)
        return Page(items=summaries(self._session.execute(query)), next_page_token=more)

    def overrides(self, job_id: str) -> tuple[str, int | None]:
        """Returns the agent ("": none) and the seed that override those of a job's scenario.

        Raises:
            UnknownName: There is no such job.
        """
        row = self._session.execute(
            select(RunRow.agent_override, RunRow.seed_override).where(RunRow.id == job_id)
        ).one_or_none()
        if row is None:
            raise UnknownName("run", job_id, ())
        return row.agent_override, row.seed_override

    def definition(self, job_id: str) -> FailureDefinition:
        """Returns what counts as a failure of a job's run."""
        return self.definitions([job_id]).get(job_id, DEFAULT_DEFINITION)

    def definitions(self, job_ids: Sequence[str]) -> dict[str, FailureDefinition]:
        """Returns what counts as a failure of the runs of jobs; those with the default left out."""
        found: dict[str, FailureDefinition] = {}
        for chunk in batched(job_ids, 500):
            query = select(RunRow.id, RunRow.definition).where(
                RunRow.id.in_(chunk), RunRow.definition != ""
            )
            rows = self._session.execute(query)
            found.update((job_id, definition_from_json(text)) for job_id, text in rows)
        return found

    def document(self, job_id: str) -> str:
        """Returns the scenario of a job as JSON text.

        Raises:
            UnknownName: There is no such job.
        """
        body = self._session.scalar(
            select(DocumentRow.body)
            .join(RunRow, RunRow.document_sha256 == DocumentRow.sha256)
            .where(RunRow.id == job_id)
        )
        if body is None:
            raise UnknownName("run", job_id, ())
        return body

    def report(self, job_id: str) -> RunReport | None:
        """Returns the report of a job, ``None`` until it has ended.

        Raises:
            UnknownName: There is no such job.
        """
        found = self._session.execute(
            select(RunRow.seq, ReportRow.body)
            .outerjoin(ReportRow, ReportRow.run_seq == RunRow.seq)
            .where(RunRow.id == job_id)
        ).one_or_none()
        if found is None:
            raise UnknownName("run", job_id, ())
        body: str | None = found.body
        return None if body is None else report_from_json(body)

    def reports(self, job_ids: Sequence[str]) -> dict[str, RunReport]:
        """Returns the reports of those of the jobs that have ended."""
        reports: dict[str, RunReport] = {}
        for chunk in batched(job_ids, 500):
            rows = self._session.execute(
                select(RunRow.id, ReportRow.body)
                .join(ReportRow, ReportRow.run_seq == RunRow.seq)
                .where(RunRow.id.in_(chunk))
            )
            reports.update((job_id, report_from_json(body)) for job_id, body in rows)
        return reports

    def documents(self, sha256s: Sequence[str]) -> dict[str, str]:
        """Returns the scenarios of hashes as JSON text; those that are not stored are left out."""
        found: dict[str, str] = {}
        for chunk in batched(sha256s, 500):
            query = select(DocumentRow.sha256, DocumentRow.body).where(
                DocumentRow.sha256.in_(chunk)
            )
            found.update((sha256, body) for sha256, body in self._session.execute(query))
        return found

    def attempts(self, job_id: str) -> tuple[Attempt, ...]:
        """Returns every attempt at a job's run, first to last."""
        query = (
            select(*(getattr(AttemptRow, name) for name in field_names(Attempt)))
            .join(RunRow, RunRow.seq == AttemptRow.run_seq)
            .where(RunRow.id == job_id)
            .order_by(AttemptRow.number)
        )
        return read_all(Attempt, (row._asdict() for row in self._session.execute(query)))

    def cancel(self, job_id: str) -> RunSummary:
        """Cancels a job; one that has ended is unchanged.

        Raises:
            UnknownName: There is no such job.
        """
        row = self._session.scalar(select(RunRow).where(RunRow.id == job_id))
        if row is None:
            raise UnknownName("run", job_id, ())
        cancel_runs(self._session, [row])
        return self.get(job_id)

    def counts(self) -> dict[RunStatus, int]:
        """Returns the numbers of runs by status; 0 for statuses without runs."""
        found = self._session.execute(
            select(FacetRow.status, func.sum(FacetRow.runs)).group_by(FacetRow.status)
        )
        numbers = {RunStatus(status): number for status, number in found}
        return {status: numbers.get(status, 0) for status in RunStatus}

    def counts_by_filter(self, wanted: JobFilter) -> RunCounts:
        """Returns the numbers of jobs that pass a filter, and by the values of its parts."""
        return count_runs(self._session, wanted)

    def _campaign_of(self, job_id: str) -> str:
        """Returns the id of a job's campaign, in whose batch its place is the evaluation."""
        query = (
            select(CampaignRow.id)
            .select_from(RunRow)
            .join(BatchRow, BatchRow.seq == RunRow.batch_seq)
            .join(CampaignRow, is_campaign_of(BatchRow.id))
            .where(RunRow.id == job_id)
        )
        return self._session.scalar(query) or ""

    def count_queued_runs(self) -> int:
        """Returns the number of queued runs."""
        return count_queued_runs(self._session)


def _scope(wanted: JobFilter) -> str:
    return repr(replace(wanted, statuses=frozenset())) + ",".join(sorted(wanted.statuses))
