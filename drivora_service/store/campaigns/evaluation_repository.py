"""The evaluations of campaigns and the failures among them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.errors import UnknownName
from drivora_service.oracles.verdicts.accountability import Accountability
from drivora_service.oracles.verdicts.verdict_json import verdict_from_json
from drivora_service.runs.report_encoding import report_from_json
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.shapes import combine
from drivora_service.store.campaigns.campaign_records import Confirmation, EvaluationRecord, Failure
from drivora_service.store.campaigns.campaign_repository import campaign_row
from drivora_service.store.campaigns.campaign_tables import CampaignRow, EvaluationRow, FailureRow
from drivora_service.store.campaigns.evaluation_writing import append_evaluations
from drivora_service.store.campaigns.kind_counters import count_confirmation, count_groups
from drivora_service.store.engine.base_tables import DocumentRow
from drivora_service.store.engine.chunks import batched
from drivora_service.store.failures.failure_writing import confirm_found


class EvaluationRepository:
    """Reads and writes the evaluations of campaigns."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def append(
        self, campaign_id: str, entries: Sequence[tuple[EvaluationRecord, str]], *, active_s: float
    ) -> None:
        """Writes the next evaluations of a campaign, their failures, and the campaign's counts.

        Args:
            campaign_id: Id of the campaign.
            entries: The evaluations, each with the canonical JSON text of its scenario, "" if there
                is none; their numbers follow that of the evaluation before.
            active_s: Seconds of the campaign's work since the last call.

        Raises:
            UnknownName: There is no such campaign.
            Conflict: The campaign holds a number already, or not the one before it.
        """
        campaign = campaign_row(self._session, campaign_id)
        append_evaluations(self._session, campaign, entries)
        campaign.active_s += active_s
        campaign.updated_at = datetime.now(UTC)

    def page(
        self, campaign_id: str, *, after: int = -1, limit: int = 100, violating: bool = False
    ) -> tuple[EvaluationRecord, ...]:
        """Returns evaluations in order.

        Args:
            campaign_id: Id of the campaign.
            after: Only those of greater numbers.
            limit: Greatest number of evaluations.
            violating: Only those with a failure.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        query = (
            select(EvaluationRow)
            .where(EvaluationRow.campaign_seq == campaign.seq, EvaluationRow.number > after)
            .order_by(EvaluationRow.number)
            .limit(limit)
        )
        if violating:
            query = query.where(EvaluationRow.violations > 0)
        return self._records(campaign.seq, self._session.scalars(query).all())

    def get(self, campaign_id: str, number: int) -> EvaluationRecord:
        """Returns one evaluation.

        Raises:
            UnknownName: There is no such campaign, or it has no evaluation of this number.
        """
        campaign = campaign_row(self._session, campaign_id)
        row = evaluation_row(self._session, campaign, number)
        return self._records(campaign.seq, [row])[0]

    def document(self, campaign_id: str, number: int) -> str:
        """Returns the scenario of an evaluation as canonical JSON text.

        Raises:
            UnknownName: There is no such evaluation, or it has no scenario because it is invalid.
        """
        campaign = campaign_row(self._session, campaign_id)
        body = self._session.scalar(
            select(DocumentRow.body)
            .join(EvaluationRow, EvaluationRow.document_sha256 == DocumentRow.sha256)
            .where(EvaluationRow.campaign_seq == campaign.seq, EvaluationRow.number == number)
        )
        if body is None:
            evaluation_row(self._session, campaign, number)
            raise UnknownName(
                "scenario of evaluation", str(number), (), hint="Invalid candidates have none"
            )
        return body

    def documents(
        self, campaign_id: str, *, after: int = -1, limit: int = 100
    ) -> tuple[tuple[int, str], ...]:
        """Returns the numbers and scenarios (canonical JSON) of valid evaluations, in order.

        Args:
            campaign_id: Id of the campaign.
            after: Only those of greater numbers.
            limit: Greatest number of evaluations.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        rows = self._session.execute(
            select(EvaluationRow.number, DocumentRow.body)
            .join(DocumentRow, EvaluationRow.document_sha256 == DocumentRow.sha256)
            .where(EvaluationRow.campaign_seq == campaign.seq, EvaluationRow.number > after)
            .order_by(EvaluationRow.number)
            .limit(limit)
        )
        return tuple((number, body) for number, body in rows)

    def failures(self, campaign_id: str) -> tuple[Failure, ...]:
        """Returns every failure of a campaign, in the order of their evaluations.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        query = (
            select(FailureRow)
            .where(FailureRow.campaign_seq == campaign.seq)
            .order_by(FailureRow.number, FailureRow.place)
        )
        return tuple(failure_of(row) for row in self._session.scalars(query))

    def open_numbers(self, campaign_id: str) -> frozenset[int]:
        """Returns the numbers of the evaluations whose failures were not run again yet.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        query = select(FailureRow.number).where(
            FailureRow.campaign_seq == campaign.seq, FailureRow.confirmation == Confirmation.OPEN
        )
        return frozenset(self._session.scalars(query))

    def confirm(
        self, campaign_id: str, number: int, confirmation: Confirmation, *, trace: str
    ) -> None:
        """Writes whether an identical run repeated the failures of an evaluation.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        failures = self._session.scalars(
            select(FailureRow).where(
                FailureRow.campaign_seq == campaign.seq, FailureRow.number == number
            )
        ).all()
        count_confirmation(self._session, failures, confirmation)
        confirm_found(self._session, campaign.seq, number, confirmation)
        for failure in failures:
            failure.confirmation, failure.trace = confirmation, trace

    def group(self, campaign_id: str, groups: Mapping[tuple[int, int], int]) -> None:
        """Writes the groups of failures, by number of the evaluation and place.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        rows = self._session.scalars(
            select(FailureRow).where(FailureRow.campaign_seq == campaign.seq)
        )
        found: dict[str, set[int]] = {}
        for row in rows:
            row.group = groups.get((row.number, row.place))
            if row.group is not None:
                found.setdefault(row.kind, set()).add(row.group)
        count_groups(self._session, campaign.seq, found)

    def _records(
        self, campaign_seq: int, rows: Sequence[EvaluationRow]
    ) -> tuple[EvaluationRecord, ...]:
        failures: dict[int, list[FailureRow]] = {}
        for chunk in batched([row.number for row in rows if row.violations]):
            found = self._session.scalars(
                select(FailureRow)
                .where(FailureRow.campaign_seq == campaign_seq, FailureRow.number.in_(chunk))
                .order_by(FailureRow.number, FailureRow.place)
            )
            for row in found:
                failures.setdefault(row.number, []).append(row)
        return tuple(_evaluation(row, failures.get(row.number, [])) for row in rows)


def evaluation_row(session: Session, campaign: CampaignRow, number: int) -> EvaluationRow:
    """Returns the row of an evaluation.

    Raises:
        UnknownName: There is none of this number.
    """
    row = session.get(EvaluationRow, (campaign.seq, number))
    if row is None:
        known = (f"0 to {campaign.evaluations - 1}",) if campaign.evaluations else ()
        raise UnknownName("evaluation", str(number), known)
    return row


def _evaluation(row: EvaluationRow, failures: Sequence[FailureRow]) -> EvaluationRecord:
    return EvaluationRecord(
        number=row.number,
        proposal=Proposal(
            values=np.array(json.loads(row.genes), dtype=np.float64),
            origin=row.origin,
            generation=row.generation,
            parents=tuple(json.loads(row.parents)),
            redrawn=row.redrawn,
        ),
        status=EvaluationStatus(row.status),
        document_sha256=row.document_sha256 or "",
        report=report_from_json(row.report),
        violations=tuple(verdict_from_json(failure.verdict) for failure in failures),
        failure_kinds=tuple(failure.kind for failure in failures),
        search_s=row.search_s,
        prepare_s=row.prepare_s,
        asked_sha256=row.asked_sha256 or "",
        seed_number=row.seed_number,
        strongest=None if row.accountability is None else Accountability(row.accountability),
    )


def failure_of(row: FailureRow) -> Failure:
    """Returns the failure of a row."""
    return combine(
        Failure,
        row,
        evaluation=row.number,
        verdict=verdict_from_json(row.verdict),
        confirmation=Confirmation(row.confirmation),
    )
