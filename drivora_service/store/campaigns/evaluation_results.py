"""The results of evaluations whose runs have no rows of their own, for tables of all runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import datetime
from typing import Any

from pydantic_core import from_json
from sqlalchemy import ColumnElement, String, cast, exists, literal, select, tuple_
from sqlalchemy.orm import Session

from drivora_service.oracles.verdict import WITHOUT_FINDING
from drivora_service.oracles.verdicts.failure_definition import definition_of_document
from drivora_service.runs.run_report import RunReport
from drivora_service.shapes import adapter, field_names
from drivora_service.store.campaigns.campaign_tables import CampaignRow, EvaluationRow
from drivora_service.store.campaigns.evaluation_writing import town_of_seed
from drivora_service.store.queue.endings import end_values
from drivora_service.store.runs.facets import make_facet_with_key
from drivora_service.store.runs.result_conditions import campaign_columns, is_named, seeds_of
from drivora_service.store.runs.result_records import EvaluationPlace, ResultFilter, StoredResult
from drivora_service.store.runs.run_records import JobFilter, RunSummary
from drivora_service.store.runs.run_scope import facet_passes
from drivora_service.store.runs.run_tables import RunRow

_KEPT = ("run_id", "status", "failure", "steps", "sim_time_s", "wall_time_s")


def evaluation_results(
    session: Session,
    wanted: ResultFilter,
    *,
    after: EvaluationPlace | None,
    limit: int,
    with_seeds: bool,
) -> tuple[list[StoredResult], EvaluationPlace | None]:
    """Returns chosen evaluations whose run has no row.

    Args:
        session: The transaction.
        wanted: The choice.
        after: Only those behind this place; ``None``: from the beginning.
        limit: Greatest number of evaluations that are looked at.
        with_seeds: Whether to read the scenarios for the seeds that these have.

    Returns:
        The evaluations that pass, which may be none, and the place of the last one that was looked
        at; ``None`` at the end.
    """
    rows = session.execute(
        select(
            EvaluationRow.campaign_seq,
            EvaluationRow.number,
            EvaluationRow.seed_number,
            EvaluationRow.document_sha256,
            EvaluationRow.told_at,
            EvaluationRow.report,
        )
        .join(CampaignRow, CampaignRow.seq == EvaluationRow.campaign_seq)
        .where(*_conditions(wanted, after))
        .order_by(EvaluationRow.campaign_seq, EvaluationRow.number)
        .limit(limit)
    ).all()
    campaigns = _campaigns(session, {row.campaign_seq for row in rows})
    hashes = {row.document_sha256 or "" for row in rows} if with_seeds else set()
    seeds = seeds_of(session, hashes)
    towns: dict[tuple[int, int], str] = {}
    found = []
    for row in rows:
        campaign, report = campaigns[row.campaign_seq], from_json(row.report)
        place = row.campaign_seq, row.seed_number
        if place not in towns:
            towns[place] = town_of_seed(campaign, row.seed_number)
        short = _without_details(report)
        values = {
            # What only stored runs have is null.
            **dict.fromkeys(field_names(RunSummary)),
            **_make_run_columns(short, campaign, row.told_at),
            **campaign_columns(campaign, row.number),
            "run_id": f"{campaign.id}-{row.number}",
            "source": "evaluation",
            "label": f"{campaign.name} #{row.number}",
            "batch_id": campaign.batch_id,
            "item": row.number,
            "confirms": False,
            "town": towns[place],
            "agent": campaign.agent,
            "configuration": campaign.configuration,
            "configuration_id": campaign.configuration_id,
            "scenario_sha256": row.document_sha256,
            "seed": seeds.get(row.document_sha256 or ""),
        }
        if _passes(values, short, wanted.runs):
            definition = definition_of_document(campaign.document)
            found.append(StoredResult(values=values, report=report, definition=definition))
    if len(rows) < limit:
        return found, None
    return found, EvaluationPlace(rows[-1].campaign_seq, rows[-1].number)


def _conditions(wanted: ResultFilter, after: EvaluationPlace | None) -> list[ColumnElement[bool]]:
    """Returns the conditions that need no report."""
    run_id = CampaignRow.id + "-" + cast(EvaluationRow.number, String)
    conditions: list[ColumnElement[bool]] = [~exists().where(RunRow.id == run_id)]
    if after is not None:
        place = tuple_(EvaluationRow.campaign_seq, EvaluationRow.number)
        conditions.append(place > tuple_(literal(after.campaign_seq), literal(after.number)))
    if wanted.names_any:
        of_batch = CampaignRow.batch_id.in_(wanted.batch_ids) & (CampaignRow.batch_id != "")
        chosen = select(CampaignRow.seq).where(is_named(wanted) | of_batch)
        conditions.append(EvaluationRow.campaign_seq.in_(chosen))
    runs = wanted.runs
    if runs.agent:
        conditions.append(CampaignRow.agent == runs.agent)
    if runs.configuration_id:
        conditions.append(CampaignRow.configuration_id == runs.configuration_id)
    if runs.scenario_sha256:
        conditions.append(EvaluationRow.document_sha256 == runs.scenario_sha256)
    if runs.since is not None:
        conditions.append(EvaluationRow.told_at >= runs.since)
    if runs.until is not None:
        conditions.append(EvaluationRow.told_at < runs.until)
    return conditions


def _campaigns(session: Session, seqs: Iterable[int]) -> Mapping[int, CampaignRow]:
    rows = session.scalars(select(CampaignRow).where(CampaignRow.seq.in_(list(seqs))))
    return {row.seq: row for row in rows}


def _without_details(report: Mapping[str, Any]) -> RunReport:
    """Returns a report without what only tables of details have; reading all takes far longer."""
    verdicts = report.get("verdicts") or ()
    notable = [one for one in verdicts if one["outcome"] not in WITHOUT_FINDING]
    kept = {name: report[name] for name in _KEPT if name in report}
    short: RunReport = adapter(RunReport).validate_python({**kept, "verdicts": notable})
    return short


def _make_run_columns(
    report: RunReport, campaign: CampaignRow, told_at: datetime
) -> dict[str, Any]:
    """Returns the columns of a run that its report determines."""
    definition = definition_of_document(campaign.document)
    values = end_values(report, definition, keeps_trace=False, ended=told_at)
    del values["trace_sha256"]
    return {
        **values,
        "status": report.status,
        "created_at": told_at,
        "started_at": None,
        "attempts": 1,
    }


def _passes(values: Mapping[str, Any], report: RunReport, wanted: JobFilter) -> bool:
    names = (
        "agent",
        "town",
        "status",
        "violations",
        "accountability",
        "configuration",
        "configuration_id",
        "failures",
    )
    facet, _ = make_facet_with_key(**{name: values[name] for name in names})
    if not facet_passes(facet, wanted):
        return False
    return not wanted.oracle or any(
        verdict.oracle == wanted.oracle
        and verdict.outcome == wanted.outcome
        and wanted.at_fault in (None, verdict.at_fault)
        for verdict in report.verdicts
    )
