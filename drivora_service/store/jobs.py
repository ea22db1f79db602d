"""Jobs: submitting them, looking at them, cancelling them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.runs.encoding import report_from_json
from drivora_service.runs.report import RunReport, RunStatus
from drivora_service.store.cancelling import cancel_runs
from drivora_service.store.chunks import batched
from drivora_service.store.facet_tables import FacetRow
from drivora_service.store.job_lists import listed_runs
from drivora_service.store.job_records import job_query, to_record
from drivora_service.store.paging import make_token, read_token
from drivora_service.store.records import AttemptRecord, JobFilter, JobRecord, NewRun, Page
from drivora_service.store.submitting import queued_runs, submit_runs
from drivora_service.store.tables import AttemptRow, DocumentRow, ReportRow, RunRow


class JobRepository:
    """Reads and writes jobs."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def submit(
        self, runs: Sequence[NewRun], *, batch_id: str = "", queue_limit: int | None = None
    ) -> tuple[str, ...]:
        """Queues runs and gives their ids, in order.

        A run whose scenario is quarantined ends at once with the cause ``quarantined``.

        Args:
            runs: What to run.
            batch_id: The batch they belong to; "": posted alone, at interactive priority.
            queue_limit: Runs that may wait in all; ``None``: any number.

        Raises:
            UnknownName: There is no such batch.
            Conflict: The batch was cancelled.
            QueueFull: The queue would grow beyond its limit; nothing was queued.
        """
        return submit_runs(self._session, runs, batch_id=batch_id, queue_limit=queue_limit)

    def get(self, job_id: str) -> JobRecord:
        """Gives a job.

        Raises:
            UnknownName: There is none of this id.
        """
        found = self._session.execute(job_query().where(RunRow.id == job_id)).one_or_none()
        if found is None:
            raise UnknownName("job", job_id, ())
        return to_record(*found)

    def page(
        self,
        wanted: JobFilter = JobFilter(),  # noqa: B008 # frozen
        *,
        limit: int = 50,
        page_token: str = "",
        newest_first: bool = True,
    ) -> Page[JobRecord]:
        """Gives the jobs that a filter lets through, in the order of their submission.

        Raises:
            InvalidDocument: The token is not one of this query.
        """
        scope = f"jobs {newest_first} {_scope(wanted)}"
        last = read_token(scope, page_token) if page_token else None
        numbers = listed_runs(
            self._session, wanted, limit=limit + 1, after=last, newest_first=newest_first
        )
        more = make_token(scope, numbers[limit - 1]) if len(numbers) > limit else ""
        rows = self._session.execute(job_query().where(RunRow.seq.in_(numbers[:limit])))
        shown = sorted(rows, key=lambda row: row[0].seq, reverse=newest_first)
        return Page(items=tuple(to_record(*row) for row in shown), next_token=more)

    def changed_since(self, revision: int, *, limit: int = 500) -> tuple[JobRecord, ...]:
        """Gives the jobs that changed after a revision, oldest change first, as they are now."""
        query = job_query().where(RunRow.revision > revision).order_by(RunRow.revision).limit(limit)
        return tuple(to_record(*row) for row in self._session.execute(query))

    def latest_revision(self) -> int:
        """Gives the revision of the newest change, 0 if nothing has ever happened."""
        query = select(RunRow.revision).order_by(RunRow.revision.desc()).limit(1)
        return self._session.scalar(query) or 0

    def document(self, job_id: str) -> str:
        """Gives the scenario of a job as JSON text.

        Raises:
            UnknownName: There is no such job.
        """
        body = self._session.scalar(
            select(DocumentRow.body)
            .join(RunRow, RunRow.document_sha256 == DocumentRow.sha256)
            .where(RunRow.id == job_id)
        )
        if body is None:
            raise UnknownName("job", job_id, ())
        return body

    def report(self, job_id: str) -> RunReport | None:
        """Gives the report of a job, ``None`` until it has ended.

        Raises:
            UnknownName: There is no such job.
        """
        found = self._session.execute(
            select(RunRow.seq, ReportRow.body)
            .outerjoin(ReportRow, ReportRow.run_seq == RunRow.seq)
            .where(RunRow.id == job_id)
        ).one_or_none()
        if found is None:
            raise UnknownName("job", job_id, ())
        body: str | None = found.body
        return None if body is None else report_from_json(body)

    def reports(self, job_ids: Sequence[str]) -> dict[str, RunReport]:
        """Gives the reports of those of the jobs that have ended."""
        reports: dict[str, RunReport] = {}
        for chunk in batched(job_ids, 500):
            rows = self._session.execute(
                select(RunRow.id, ReportRow.body)
                .join(ReportRow, ReportRow.run_seq == RunRow.seq)
                .where(RunRow.id.in_(chunk))
            )
            reports.update((job_id, report_from_json(body)) for job_id, body in rows)
        return reports

    def attempts(self, job_id: str) -> tuple[AttemptRecord, ...]:
        """Gives every try at a job's run, first to last."""
        rows = self._session.scalars(
            select(AttemptRow)
            .join(RunRow, RunRow.seq == AttemptRow.run_seq)
            .where(RunRow.id == job_id)
            .order_by(AttemptRow.number)
        )
        return tuple(
            AttemptRecord(
                number=row.number,
                worker=row.worker,
                claimed_at=row.claimed_at,
                started_at=row.started_at,
                ended_at=row.ended_at,
                outcome=row.outcome,
                cause=row.cause,
                signal=row.signal,
                log=row.log,
            )
            for row in rows
        )

    def cancel(self, job_id: str) -> JobRecord:
        """Gives a job up; one that has ended stays as it is.

        Raises:
            UnknownName: There is no such job.
        """
        row = self._session.scalar(select(RunRow).where(RunRow.id == job_id))
        if row is None:
            raise UnknownName("job", job_id, ())
        cancel_runs(self._session, [row])
        return self.get(job_id)

    def counts(self) -> dict[RunStatus, int]:
        """Counts all runs by status; statuses that no run has are 0."""
        found = self._session.execute(
            select(FacetRow.status, func.sum(FacetRow.runs)).group_by(FacetRow.status)
        )
        numbers = {RunStatus(status): number for status, number in found}
        return {status: numbers.get(status, 0) for status in RunStatus}

    def queued(self) -> int:
        """Counts the runs that wait."""
        return queued_runs(self._session)


def _scope(wanted: JobFilter) -> str:
    return repr(replace(wanted, statuses=frozenset())) + ",".join(sorted(wanted.statuses))
