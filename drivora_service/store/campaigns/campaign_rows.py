"""The evaluations and failures of one campaign as rows of tables."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pydantic_core import from_json
from sqlalchemy import select
from sqlalchemy.orm import Session

from drivora_service.oracles.verdicts.failure_facts import avoidable_until, failure_sentence
from drivora_service.oracles.verdicts.verdict_json import verdict_from_json
from drivora_service.store.campaigns.campaign_repository import campaign_row
from drivora_service.store.campaigns.campaign_tables import EvaluationRow, FailureRow
from drivora_service.store.engine.base_tables import DocumentRow

Row = dict[str, Any]
"""Values by column."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateRow:
    """A candidate and whether it failed, for counts of what was tried.

    Attributes:
        document: Canonical JSON of its scenario; "" if it is invalid.
        accountability: The strongest of its violations, or ``None``.
    """

    number: int
    seed_number: int
    status: str
    violations: int
    accountability: str | None
    genes: tuple[float, ...]
    document: str


class CampaignRowRepository:
    """Reads evaluations and failures for tables, without the parts that tables do not have."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def objectives(self, campaign_id: str) -> tuple[str, ...]:
        """Returns the names of the objectives that any evaluation of a campaign has a value of.

        Raises:
            UnknownName: There is no such campaign.
        """
        return tuple(sorted(json.loads(campaign_row(self._session, campaign_id).best)))

    def evaluations(
        self, campaign_id: str, *, after: int = -1, limit: int = 500
    ) -> tuple[Row, ...]:
        """Returns evaluations in the order of their numbers.

        Args:
            campaign_id: Id of the campaign.
            after: Only those of greater numbers.
            limit: Greatest number of evaluations.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        rows = self._session.scalars(
            select(EvaluationRow)
            .where(EvaluationRow.campaign_seq == campaign.seq, EvaluationRow.number > after)
            .order_by(EvaluationRow.number)
            .limit(limit)
        )
        return tuple(_evaluation(row) for row in rows)

    def candidates(
        self, campaign_id: str, *, after: int = -1, limit: int = 500
    ) -> tuple[CandidateRow, ...]:
        """Returns candidates in the order of their numbers.

        Args:
            campaign_id: Id of the campaign.
            after: Only those of greater numbers.
            limit: Greatest number of candidates.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        rows = self._session.execute(
            select(
                EvaluationRow.number,
                EvaluationRow.seed_number,
                EvaluationRow.status,
                EvaluationRow.violations,
                EvaluationRow.accountability,
                EvaluationRow.genes,
                DocumentRow.body,
            )
            .outerjoin(DocumentRow, DocumentRow.sha256 == EvaluationRow.document_sha256)
            .where(EvaluationRow.campaign_seq == campaign.seq, EvaluationRow.number > after)
            .order_by(EvaluationRow.number)
            .limit(limit)
        )
        return tuple(
            CandidateRow(
                number=number,
                seed_number=seed_number,
                status=status,
                violations=violations,
                accountability=degree,
                genes=tuple(json.loads(genes)),
                document=body or "",
            )
            for number, seed_number, status, violations, degree, genes, body in rows
        )

    def failures(
        self, campaign_id: str, *, after: int = -1, evaluations: int = 500
    ) -> tuple[Sequence[Row], int]:
        """Returns the failures of the next evaluations that have some.

        Args:
            campaign_id: Id of the campaign.
            after: Only those of evaluations of greater numbers.
            evaluations: Greatest number of evaluations.

        Returns:
            The rows, and the number of the last evaluation; -1 if there is none.

        Raises:
            UnknownName: There is no such campaign.
        """
        campaign = campaign_row(self._session, campaign_id)
        numbers = self._session.scalars(
            select(FailureRow.number)
            .where(FailureRow.campaign_seq == campaign.seq, FailureRow.number > after)
            .order_by(FailureRow.number)
            .distinct()
            .limit(evaluations)
        ).all()
        if not numbers:
            return (), -1
        rows = self._session.scalars(
            select(FailureRow)
            .where(
                FailureRow.campaign_seq == campaign.seq,
                FailureRow.number > after,
                FailureRow.number <= numbers[-1],
            )
            .order_by(FailureRow.number, FailureRow.place)
        )
        return [_failure(row, campaign.town) for row in rows], numbers[-1]


def _evaluation(row: EvaluationRow) -> Row:
    # Reading the whole reports would take ten times as long.
    report: dict[str, Any] = from_json(row.report)
    measurement = report.get("measurement") or {}
    objectives: dict[str, float | None] = measurement.get("objectives") or {}
    return {
        "evaluation": row.number,
        "generation": row.generation,
        "origin": row.origin,
        "parents": json.loads(row.parents),
        "redrawn": row.redrawn,
        "seed_number": row.seed_number,
        "status": row.status,
        "cause": (report.get("failure") or {}).get("cause", ""),
        "violations": row.violations,
        "at_fault_violations": row.at_fault_violations,
        "accountability": row.accountability,
        "sim_time_s": row.sim_time_s,
        "wall_time_s": row.wall_time_s,
        "search_s": row.search_s,
        "prepare_s": row.prepare_s,
        "told_at": row.told_at,
        "scenario_sha256": row.document_sha256 or "",
        "trace_sha256": report.get("trace_sha256", ""),
        "egos_sha256": report.get("egos_sha256", ""),
        "genes": json.loads(row.genes),
        "metrics": json.dumps(report.get("metrics") or {}, sort_keys=True),
        "objectives": objectives,
    }


def _failure(row: FailureRow, town: str) -> Row:
    verdict = verdict_from_json(row.verdict)
    x, y = (None, None) if verdict.location is None else verdict.location
    speed = verdict.evidence.get("ego_speed")
    return {
        "evaluation": row.number,
        "place": row.place,
        "oracle": row.oracle,
        "kind": row.kind,
        "group": row.group,
        "ego": verdict.ego,
        "counterpart": verdict.counterpart,
        "at_fault": row.at_fault,
        "avoidable": None if verdict.avoidable is None else str(verdict.avoidable),
        "accountability": row.accountability,
        "confirmation": row.confirmation,
        "time_s": verdict.time,
        "avoidable_until_s": avoidable_until(verdict),
        "x": x,
        "y": y,
        "ego_speed": None if speed is None else float(speed),
        "sentence": failure_sentence(verdict, town=town, kind=row.kind),
        "message": verdict.message,
        "trace": row.trace,
    }
