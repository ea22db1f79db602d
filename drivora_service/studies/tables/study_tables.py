"""The numbers of a study as tables, for Parquet and CSV; docs/reference/study.md describes them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

import pyarrow as pa

from drivora_service.campaigns.document.campaign_documents import CampaignDocument
from drivora_service.given_names import read_stored
from drivora_service.oracles.verdicts.accountability import accountability
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.oracles.verdicts.verdict_json import verdict_content
from drivora_service.store.campaigns.campaign_records import (
    CampaignRecord,
    EvaluationRecord,
    Failure,
)
from drivora_service.store.database import Database
from drivora_service.studies.found_counts import uncounted_violations
from drivora_service.studies.table_names import TableForm, TableName
from drivora_service.studies.tables.table_forms import Row, Table, table_chunks

_PAGE = 500
_CELL = (
    ("study_id", pa.string()),
    ("campaign_id", pa.string()),
    ("scenario", pa.string()),
    ("agent", pa.string()),
    ("configuration", pa.string()),
    ("configuration_id", pa.string()),
    ("method", pa.string()),
    ("repetition", pa.int32()),
    ("seed", pa.int64()),
)

SCHEMAS = {
    TableName.CAMPAIGNS: pa.schema(
        [
            *_CELL,
            ("state", pa.string()),
            ("budget", pa.int32()),
            ("evaluations", pa.int32()),
            ("judged", pa.int32()),
            ("invalid", pa.int32()),
            ("failed", pa.int32()),
            ("failing", pa.int32()),
            ("at_fault", pa.int32()),
            ("avoidable", pa.int32()),
            ("active_s", pa.float64()),
        ]
    ),
    TableName.EVALUATIONS: pa.schema(
        [
            *_CELL,
            ("evaluation", pa.int32()),
            ("generation", pa.int32()),
            ("origin", pa.string()),
            ("parents", pa.list_(pa.int32())),
            ("status", pa.string()),
            ("cause", pa.string()),
            ("violations", pa.int32()),
            ("at_fault", pa.bool_()),
            ("accountability", pa.string()),
            ("not_at_fault", pa.int32()),
            ("redrawn", pa.int32()),
            ("sim_time_s", pa.float64()),
            ("wall_time_s", pa.float64()),
            ("search_s", pa.float64()),
            ("prepare_s", pa.float64()),
            ("scenario_sha256", pa.string()),
            ("trace_sha256", pa.string()),
            ("egos_sha256", pa.string()),
            ("genes", pa.list_(pa.float64())),
            ("objectives", pa.string()),
            ("metrics", pa.string()),
        ]
    ),
    TableName.FAILURES: pa.schema(
        [
            *_CELL,
            ("evaluation", pa.int32()),
            ("place", pa.int32()),
            ("oracle", pa.string()),
            ("kind", pa.string()),
            ("ego", pa.string()),
            ("counterpart", pa.string()),
            ("at_fault", pa.bool_()),
            ("avoidable", pa.string()),
            ("accountability", pa.string()),
            ("confirmation", pa.string()),
            ("group", pa.int32()),
            ("time_s", pa.float64()),
            ("x", pa.float64()),
            ("y", pa.float64()),
            ("message", pa.string()),
            ("evidence", pa.string()),
            ("trace", pa.string()),
        ]
    ),
}


def study_table(database: Database, study_id: str, name: TableName) -> Table:
    """Returns a table of a study; reading it raises ``UnknownName`` if there is no such study."""
    return Table(schema=SCHEMAS[name], pages=lambda: _pages(database, study_id, name))


def parquet_chunks(database: Database, study_id: str, name: TableName) -> Iterator[bytes]:
    """Yields a table as the parts of a Parquet file.

    Raises:
        UnknownName: There is no such study.
    """
    return table_chunks(study_table(database, study_id, name), TableForm.PARQUET)


def csv_chunks(database: Database, study_id: str, name: TableName) -> Iterator[bytes]:
    """Yields a table as the parts of a CSV file; items of lists are separated by blanks.

    Raises:
        UnknownName: There is no such study.
    """
    return table_chunks(study_table(database, study_id, name), TableForm.CSV)


def _pages(database: Database, study_id: str, name: TableName) -> Iterator[Sequence[Row]]:
    with database.read() as transaction:
        transaction.studies.get(study_id)
        ids = transaction.studies.campaign_ids(study_id)
    for campaign_id in ids:
        with database.read() as transaction:
            campaign = transaction.campaigns.get(campaign_id)
        match name:
            case TableName.CAMPAIGNS:
                yield [_campaign_row(campaign)]
            case TableName.EVALUATIONS:
                yield from _evaluation_pages(database, campaign)
            case TableName.FAILURES:
                with database.read() as transaction:
                    failures = transaction.evaluations.failures(campaign_id)
                yield [_failure_row(campaign, failure) for failure in failures]


def _place(campaign: CampaignRecord) -> Row:
    cell = campaign.cell
    return {
        "study_id": campaign.study_id,
        "campaign_id": campaign.id,
        "scenario": "" if cell is None else cell.scenario,
        "agent": "" if cell is None else cell.agent,
        "configuration": campaign.configuration,
        "configuration_id": campaign.configuration_id,
        "method": "" if cell is None else cell.method,
        "repetition": 0 if cell is None else cell.repetition,
        "seed": campaign.document["seed"],
    }


def _campaign_row(campaign: CampaignRecord) -> Row:
    counts = campaign.counts
    return {
        **_place(campaign),
        "state": str(campaign.state),
        "budget": campaign.budget,
        "evaluations": counts.evaluations,
        "judged": counts.judged,
        "invalid": counts.invalid,
        "failed": counts.failed,
        "failing": counts.violating,
        "at_fault": counts.at_fault,
        "avoidable": counts.avoidable,
        "active_s": campaign.active_s,
    }


def _evaluation_pages(database: Database, campaign: CampaignRecord) -> Iterator[Sequence[Row]]:
    place, after = _place(campaign), -1
    definition = read_stored(CampaignDocument, campaign.document).definition
    while True:
        with database.read() as transaction:
            page = transaction.evaluations.page(campaign.id, after=after, limit=_PAGE)
        yield [{**place, **_evaluation_row(record, definition)} for record in page]
        if len(page) < _PAGE:
            return
        after = page[-1].number


def _evaluation_row(record: EvaluationRecord, definition: FailureDefinition) -> Row:
    report, degree = record.report, record.accountability
    measurement = report.measurement
    return {
        "evaluation": record.number,
        "generation": record.proposal.generation,
        "origin": record.proposal.origin,
        "parents": [int(parent) for parent in record.proposal.parents],
        "status": str(record.status),
        "cause": "" if report.failure is None else report.failure.cause,
        "violations": len(record.violations),
        "at_fault": record.at_fault,
        "accountability": None if degree is None else str(degree),
        "not_at_fault": sum(
            one.at_fault is False for one in uncounted_violations(report.verdicts, definition)
        ),
        "redrawn": record.proposal.redrawn,
        "sim_time_s": float(report.sim_time_s),
        "wall_time_s": float(report.wall_time_s),
        "search_s": record.search_s,
        "prepare_s": record.prepare_s,
        "scenario_sha256": record.document_sha256,
        "trace_sha256": report.trace_sha256,
        "egos_sha256": report.egos_sha256,
        "genes": record.proposal.values.tolist(),
        "objectives": _json({} if measurement is None else measurement.objectives),
        "metrics": _json(report.metrics),
    }


def _failure_row(campaign: CampaignRecord, failure: Failure) -> Row:
    verdict = failure.verdict
    x, y = (None, None) if verdict.location is None else verdict.location
    return {
        **_place(campaign),
        "evaluation": failure.evaluation,
        "place": failure.place,
        "oracle": verdict.oracle,
        "kind": failure.kind,
        "ego": verdict.ego,
        "counterpart": verdict.counterpart,
        "at_fault": verdict.at_fault,
        "avoidable": None if verdict.avoidable is None else str(verdict.avoidable),
        "accountability": str(accountability(verdict)),
        "confirmation": str(failure.confirmation),
        "group": failure.group,
        "time_s": verdict.time,
        "x": x,
        "y": y,
        "message": verdict.message,
        "evidence": json.dumps(verdict_content(verdict)["evidence"], sort_keys=True),
        "trace": failure.trace,
    }


def _json(values: Any) -> str:
    return json.dumps(dict(values), sort_keys=True)
