"""The runs of campaigns on a service: one batch a campaign, one run an evaluation."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.errors import Conflict
from drivora_service.runs.candidate import Candidate
from drivora_service.runs.report_encoding import choice_to_json, report_from_json
from drivora_service.runs.run_report import UNFINISHED, RunReport, RunStatus
from drivora_service.store.campaigns.campaign_repository import campaign_row
from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.engine.chunks import batched
from drivora_service.store.engine.stored_documents import store_documents
from drivora_service.store.queue.endings import reset_run
from drivora_service.store.queue.queued_candidates import (
    candidate_from_json,
    source_to_json,
    without_policy,
)
from drivora_service.store.queue.submitting import submit_runs
from drivora_service.store.runs.batch_repository import BatchRepository
from drivora_service.store.runs.run_records import BatchState, NewRun, Priority
from drivora_service.store.runs.run_tables import BatchRow, ReportRow, RunRow

_WITHOUT_RESULT = frozenset({RunStatus.INFRASTRUCTURE_FAILED, RunStatus.CANCELLED})
"""Statuses of runs without a result of the scenario, which are run again."""


class CampaignRunRepository:
    """Queues the runs of campaigns, each once."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def open(self, campaign_id: str) -> str:
        """Opens the batch of a campaign's runs.

        Returns:
            The id of the batch, which is made if there is none.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        batches = BatchRepository(self._session)
        batch = self._session.scalar(select(BatchRow).where(BatchRow.id == campaign.batch_id))
        if batch is None:
            campaign.batch_id = batches.create(name=campaign.name, priority=Priority.CAMPAIGN).id
        elif batch.state == BatchState.PAUSED:
            batches.resume(batch.id)
        else:
            batch.state = BatchState.OPEN
        return campaign.batch_id

    def put(self, batch_id: str, *runs: NewRun) -> None:
        """Queues runs under their own ``run_id``s, unless they are queued, running or ended.

        A run that ended without a result, or that had another scenario when it was queued, is
        queued again. All runs are looked for, and all new ones written, together.

        Raises:
            UnknownName: There is no such batch.
            Conflict: A run is running with another scenario.
        """
        known: dict[str, RunRow] = {}
        for chunk in batched([run.run_id for run in runs]):
            rows = self._session.scalars(select(RunRow).where(RunRow.id.in_(chunk)))
            known.update((row.id, row) for row in rows)
        new = [run for run in runs if run.run_id not in known]
        if new:
            submit_runs(self._session, new, batch_id=batch_id, owner_id="", queue_limit=None)
        for run in runs:
            if run.run_id in known:
                self._put_again(known[run.run_id], run)

    def _put_again(self, row: RunRow, run: NewRun) -> None:
        feedback = None if run.feedback is None else choice_to_json(run.feedback)
        candidate = None if run.candidate is None else source_to_json(run.candidate)
        # The policy of an adversary is not kept after the end of a run.
        known, wanted = (text and without_policy(text) for text in (row.candidate, candidate))
        same = (known, row.feedback) == (wanted, feedback) and (
            candidate is not None or row.document_sha256 == run.scenario_sha256
        )
        if not same:
            if row.status == RunStatus.RUNNING:
                raise Conflict(
                    f"run {run.run_id} is running with another scenario, because the program has "
                    "changed since it was queued; try again when it has ended"
                )
            store_documents(self._session, {run.scenario_sha256: run.document})
            row.document_sha256 = run.scenario_sha256
            row.candidate, row.feedback = candidate, feedback
            if row.status != RunStatus.QUEUED:
                self._queue_again(row)
        elif row.status in _WITHOUT_RESULT:
            # A candidate may have been decoded already.
            store_documents(self._session, {run.scenario_sha256: run.document})
            row.document_sha256, row.candidate = run.scenario_sha256, candidate
            self._queue_again(row)

    def read_reports(
        self, run_ids: Sequence[str]
    ) -> tuple[tuple[RunReport, Candidate | None], ...]:
        """Returns the reports of the runs that have ended, with what their genes decode to."""
        found: list[tuple[RunReport, Candidate | None]] = []
        for chunk in batched(run_ids):
            rows = self._session.execute(
                select(ReportRow.body, ReportRow.candidate, DocumentRow.body)
                .join(RunRow, RunRow.seq == ReportRow.run_seq)
                .join(DocumentRow, DocumentRow.sha256 == RunRow.document_sha256)
                .where(RunRow.id.in_(chunk), RunRow.status.not_in(UNFINISHED))
            )
            for report, candidate, document in rows:
                decoded = candidate and candidate_from_json(candidate, document)
                found.append((report_from_json(report), decoded or None))
        return tuple(found)

    def forget_policies(self, run_ids: Sequence[str]) -> None:
        """Replaces the policies of adversaries of runs that have ended by their hashes."""
        for chunk in batched(run_ids):
            rows = self._session.scalars(
                select(RunRow).where(RunRow.id.in_(chunk), RunRow.status.not_in(UNFINISHED))
            )
            for row in rows:
                row.candidate = row.candidate and without_policy(row.candidate)

    def _queue_again(self, row: RunRow) -> None:
        reset_run(self._session, row)
        row.status = RunStatus.QUEUED
        batch = self._session.get_one(BatchRow, row.batch_seq)
        batch.queued += 1
