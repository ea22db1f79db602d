"""Writing the evaluations of a campaign and their failures, many at a time.

With one statement a table for all of them, which costs less than objects of the ORM.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any, cast

from sqlalchemy import Table, insert
from sqlalchemy.orm import Session

from drivora_service.errors import Conflict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.verdict_json import verdict_to_json
from drivora_service.runs.report_encoding import report_to_json
from drivora_service.runs.run_report import RunStatus
from drivora_service.search.tester import EvaluationStatus
from drivora_service.store.campaigns.campaign_records import Confirmation, EvaluationRecord
from drivora_service.store.campaigns.campaign_tables import CampaignRow, EvaluationRow, FailureRow
from drivora_service.store.campaigns.kind_counters import NewFailure, count_failures
from drivora_service.store.engine.stored_documents import store_documents
from drivora_service.store.failures.failure_writing import (
    make_found_rows_of_campaign,
    write_found_in_campaign,
)

_EVALUATIONS = cast("Table", EvaluationRow.__table__)
_FAILURES = cast("Table", FailureRow.__table__)

Row = dict[str, Any]
"""Values of a row by column."""


def append_evaluations(
    session: Session, campaign: CampaignRow, entries: Sequence[tuple[EvaluationRecord, str]]
) -> None:
    """Writes the next evaluations of a campaign, their failures, and the campaign's counts.

    Args:
        session: The transaction.
        campaign: The campaign.
        entries: The evaluations, each with the canonical JSON text of its scenario, "" if there is
            none; their numbers follow that of the evaluation before.

    Raises:
        Conflict: The campaign holds a number already, or not the one before it.
    """
    for number, (record, _) in enumerate(entries, campaign.evaluations):
        if record.number != number:
            raise Conflict(
                f"evaluation {record.number} of campaign {campaign.id} does not follow the "
                f"{number} that are stored; is it run twice?"
            )
    store_documents(
        session, {record.document_sha256: document for record, document in entries if document}
    )
    now = datetime.now(UTC)
    failures: list[NewFailure] = []
    found: list[Row] = []
    towns: dict[int, str] = {}
    for record, _ in entries:
        if not record.violations:
            continue
        seed = record.seed_number
        if seed not in towns:
            towns[seed] = town_of_seed(campaign, seed)
        failures += _failures(campaign.seq, record)
        found += make_found_rows_of_campaign(
            record.violations,
            campaign_seq=campaign.seq,
            number=record.number,
            agent=campaign.agent,
            configuration=campaign.configuration,
            configuration_id=campaign.configuration_id,
            town=towns[seed],
            found_at=now,
        )
    connection = session.connection()
    if entries:
        rows = [_row(campaign.seq, record, now) for record, _ in entries]
        connection.execute(insert(_EVALUATIONS), rows)
    if failures:
        connection.execute(insert(_FAILURES), [_failure_row(failure) for failure in failures])
        count_failures(session, failures)
        write_found_in_campaign(session, found)
    _count(campaign, [record for record, _ in entries])


def town_of_seed(campaign: CampaignRow, seed_number: int) -> str:
    """Returns the road network of a seed scenario."""
    seeds = json.loads(campaign.document).get("scenarios") or ()
    if seed_number >= len(seeds):
        return campaign.town
    town: str = seeds[seed_number]["scenario"]["map_region"]["town"]
    return town


def _row(campaign_seq: int, record: EvaluationRecord, now: datetime) -> Row:
    proposal, report, violations = record.proposal, record.report, record.violations
    return {
        "campaign_seq": campaign_seq,
        "number": record.number,
        "generation": proposal.generation,
        "origin": proposal.origin,
        "parents": json.dumps(proposal.parents),
        "redrawn": proposal.redrawn,
        "genes": json.dumps(proposal.values.tolist()),
        "status": record.status,
        "document_sha256": record.document_sha256 or None,
        "violations": len(violations),
        "at_fault_violations": sum(bool(verdict.at_fault) for verdict in violations),
        "accountability": record.accountability,
        "sim_time_s": report.sim_time_s,
        "wall_time_s": report.wall_time_s,
        "search_s": record.search_s,
        "prepare_s": record.prepare_s,
        "asked_sha256": record.asked_sha256 or None,
        "seed_number": record.seed_number,
        "told_at": now,
        "report": report_to_json(report),
        "violating": bool(violations),
    }


def _failures(campaign_seq: int, record: EvaluationRecord) -> list[NewFailure]:
    return [
        NewFailure(
            campaign_seq=campaign_seq,
            number=record.number,
            place=place,
            kind=kind,
            accountability=accountability(verdict),
            verdict=verdict,
        )
        for place, (verdict, kind) in enumerate(
            zip(record.violations, record.failure_kinds, strict=True)
        )
    ]


def _failure_row(failure: NewFailure) -> Row:
    return {
        "campaign_seq": failure.campaign_seq,
        "number": failure.number,
        "place": failure.place,
        "oracle": failure.verdict.oracle,
        "kind": failure.kind,
        "at_fault": failure.verdict.at_fault,
        "accountability": failure.accountability,
        "confirmation": Confirmation.OPEN,
        "verdict": verdict_to_json(failure.verdict),
    }


def _count(campaign: CampaignRow, records: Sequence[EvaluationRecord]) -> None:
    """Adds to the counts of a campaign, and keeps the least value of each objective."""
    statuses = Counter(record.status for record in records)
    degrees = Counter(record.accountability for record in records)
    campaign.evaluations += len(records)
    campaign.judged += statuses[EvaluationStatus.JUDGED]
    campaign.invalid += statuses[EvaluationStatus.INVALID]
    campaign.failed += statuses[EvaluationStatus.FAILED]
    campaign.violating += sum(bool(record.violations) for record in records)
    campaign.at_fault += sum(record.at_fault for record in records)
    # A campaign from before these were recorded has no such counts, and never gets partial ones.
    if campaign.avoidable is not None:
        campaign.avoidable += degrees[Accountability.AVOIDABLE]
    if campaign.unavoidable is not None:
        campaign.unavoidable += degrees[Accountability.UNAVOIDABLE]
    if campaign.undetermined is not None:
        campaign.undetermined += degrees[Accountability.UNDETERMINED]
    if campaign.preventable is not None:
        campaign.preventable += degrees[Accountability.PREVENTABLE]
    if campaign.not_at_fault is not None:
        campaign.not_at_fault += degrees[Accountability.NOT_AT_FAULT]
    if campaign.agent_failed is not None:
        campaign.agent_failed += sum(
            record.report.status is RunStatus.AGENT_FAILED for record in records
        )
    best: dict[str, list[float]] = json.loads(campaign.best)
    for record in records:
        measurement = record.report.measurement
        if measurement is None or record.status is not EvaluationStatus.JUDGED:
            continue
        for name, value in measurement.objectives.items():
            if value is None or not math.isfinite(value):
                continue
            if name not in best or value < best[name][0]:
                best[name] = [value, record.number]
    campaign.best = json.dumps(best)
