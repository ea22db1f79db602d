"""The evaluations of campaigns and the failures among them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np
from sqlalchemy import insert, select
from sqlalchemy.orm import Session

from drivora_service.errors import Conflict, UnknownName
from drivora_service.feedback.measurement import Measurement
from drivora_service.oracles.accountability import Accountability, accountability
from drivora_service.oracles.verdict_json import verdict_from_json, verdict_to_json
from drivora_service.runs.encoding import report_from_json, report_to_json
from drivora_service.search.tester import EvaluationStatus, Proposal
from drivora_service.shapes import combine
from drivora_service.store.campaign_records import Confirmation, EvaluationRecord, Failure
from drivora_service.store.campaign_tables import CampaignRow, EvaluationRow, FailureRow
from drivora_service.store.campaigns import campaign_row
from drivora_service.store.chunks import batched
from drivora_service.store.documents import store_documents
from drivora_service.store.failure_kinds import (
    count_confirmation,
    count_failures,
    count_groups,
)
from drivora_service.store.found_writing import (
    confirm_found,
    found_in_campaign,
    write_found_in_campaign,
)
from drivora_service.store.tables import DocumentRow


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
        for place, (record, _) in enumerate(entries):
            if record.number != campaign.evaluations + place:
                raise Conflict(
                    f"evaluation {record.number} of campaign {campaign_id} does not follow the "
                    f"{campaign.evaluations + place} that are stored; is it run twice?"
                )
        store_documents(
            self._session,
            {record.document_sha256: document for record, document in entries if document},
        )
        now = datetime.now(UTC)
        if entries:
            rows = [_new_row(campaign.seq, record, now) for record, _ in entries]
            self._session.execute(insert(EvaluationRow), rows)
        best: dict[str, list[float]] = json.loads(campaign.best)
        found: list[dict[str, Any]] = []
        for record, _ in entries:
            if record.violations:
                failures = _failure_rows(campaign.seq, record)
                self._session.add_all(failures)
                count_failures(self._session, failures)
                found += found_in_campaign(
                    record.violations,
                    campaign_seq=campaign.seq,
                    number=record.number,
                    agent=campaign.agent,
                    town=town_of_seed(campaign, record.seed_number),
                    found_at=now,
                )
            _count(campaign, record)
            measurement = record.report.measurement
            if measurement is not None and record.status is EvaluationStatus.JUDGED:
                best = _better(best, record.number, measurement)
        write_found_in_campaign(self._session, found)
        campaign.best = json.dumps(best)
        campaign.active_s += active_s
        campaign.updated_at = now

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
                "scenario of evaluation", str(number), (), hint="invalid candidates have none"
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


def town_of_seed(campaign: CampaignRow, seed_number: int) -> str:
    """Returns the road network of a seed scenario."""
    seeds = json.loads(campaign.document).get("scenarios") or ()
    if seed_number >= len(seeds):
        return campaign.town
    town: str = seeds[seed_number]["scenario"]["map_region"]["town"]
    return town


def _failure_rows(campaign_seq: int, record: EvaluationRecord) -> list[FailureRow]:
    return [
        FailureRow(
            campaign_seq=campaign_seq,
            number=record.number,
            place=place,
            oracle=verdict.oracle,
            kind=kind,
            at_fault=verdict.at_fault,
            accountability=accountability(verdict),
            confirmation=Confirmation.OPEN,
            verdict=verdict_to_json(verdict),
        )
        for place, (verdict, kind) in enumerate(
            zip(record.violations, record.failure_kinds, strict=True)
        )
    ]


def _new_row(campaign_seq: int, record: EvaluationRecord, now: datetime) -> dict[str, Any]:
    return {
        "campaign_seq": campaign_seq,
        "number": record.number,
        "generation": record.proposal.generation,
        "origin": record.proposal.origin,
        "parents": json.dumps(record.proposal.parents),
        "genes": json.dumps(record.proposal.values.tolist()),
        "status": record.status,
        "document_sha256": record.document_sha256 or None,
        "violations": len(record.violations),
        "at_fault_violations": sum(bool(verdict.at_fault) for verdict in record.violations),
        "accountability": record.accountability,
        "sim_time_s": record.report.sim_time_s,
        "wall_time_s": record.report.wall_time_s,
        "search_s": record.search_s,
        "prepare_s": record.prepare_s,
        "asked_sha256": record.asked_sha256 or None,
        "seed_number": record.seed_number,
        "told_at": now,
        "report": report_to_json(record.report),
        "violating": bool(record.violations),
    }


def _count(campaign: CampaignRow, record: EvaluationRecord) -> None:
    campaign.evaluations += 1
    match record.status:
        case EvaluationStatus.JUDGED:
            campaign.judged += 1
        case EvaluationStatus.INVALID:
            campaign.invalid += 1
        case EvaluationStatus.FAILED:
            campaign.failed += 1
    campaign.violating += bool(record.violations)
    campaign.at_fault += record.at_fault
    match record.accountability:
        # A campaign from before this was recorded has no such counts, and never gets partial ones.
        case Accountability.AVOIDABLE if campaign.avoidable is not None:
            campaign.avoidable += 1
        case Accountability.UNAVOIDABLE if campaign.unavoidable is not None:
            campaign.unavoidable += 1
        case Accountability.UNDETERMINED if campaign.undetermined is not None:
            campaign.undetermined += 1


def _better(
    best: dict[str, list[float]], number: int, measurement: Measurement
) -> dict[str, list[float]]:
    """Returns the least value of each objective, and the number of its evaluation."""
    found = {
        name: [value, number]
        for name, value in measurement.objectives.items()
        if value is not None
        and math.isfinite(value)
        and (name not in best or value < best[name][0])
    }
    return best | found


def _evaluation(row: EvaluationRow, failures: Sequence[FailureRow]) -> EvaluationRecord:
    return EvaluationRecord(
        number=row.number,
        proposal=Proposal(
            values=np.array(json.loads(row.genes), dtype=np.float64),
            origin=row.origin,
            generation=row.generation,
            parents=tuple(json.loads(row.parents)),
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
