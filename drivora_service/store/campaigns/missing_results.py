"""Why runs of campaigns have no result."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from pydantic_core import from_json
from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from drivora_service.runs.run_report import RunStatus
from drivora_service.search.tester import EvaluationStatus
from drivora_service.shapes import Shape
from drivora_service.store.campaigns.campaign_tables import CampaignRow, EvaluationRow

MOST_READ = 200
"""Number of runs whose reasons are read; a campaign is asked for often while it runs."""
_MOST_REASONS = 10
_NUMBER = re.compile(r"\d+(\.\d+)?")


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingResult(Shape):
    """A reason for which runs have no result.

    Attributes:
        status: Status of these runs, such as `agent_failed` or `plugin_failed`.
        cause: Short stable name, as in the `error` of a run.
        message: The reason of the first of these runs, in words.
        evaluation: Number of the first evaluation with it, from 0.
        runs: How many of the first 200 runs without a result have it. Messages that differ in
            numbers only are one reason.
    """

    status: RunStatus
    cause: str
    message: str
    evaluation: int
    runs: int


def missing_results(session: Session, *campaigns: ColumnElement[bool]) -> tuple[MissingResult, ...]:
    """Returns the reasons for which runs of campaigns have no result, the most frequent first.

    Args:
        session: The transaction.
        campaigns: Conditions of the campaigns.
    """
    chosen = select(CampaignRow.seq).where(*campaigns, CampaignRow.failed > 0)
    rows = session.execute(
        select(EvaluationRow.number, EvaluationRow.report)
        .where(
            EvaluationRow.campaign_seq.in_(chosen),
            EvaluationRow.status == EvaluationStatus.FAILED,
        )
        .order_by(EvaluationRow.campaign_seq, EvaluationRow.number)
        .limit(MOST_READ)
    )
    found: dict[tuple[str, str, str], list[tuple[int, str]]] = {}
    for number, text in rows:
        # Reading the whole reports would take ten times as long.
        report = from_json(text)
        failure = report.get("failure") or {}
        message = str(failure.get("message", ""))
        key = (str(report["status"]), str(failure.get("cause", "")), _NUMBER.sub("0", message))
        found.setdefault(key, []).append((number, message))
    reasons = [
        MissingResult(
            status=RunStatus(status),
            cause=cause,
            message=runs[0][1],
            evaluation=runs[0][0],
            runs=len(runs),
        )
        for (status, cause, _), runs in found.items()
    ]
    return tuple(sorted(reasons, key=lambda one: -one.runs))[:_MOST_REASONS]


def missing_words(runs: int, reasons: Sequence[MissingResult]) -> str:
    """Returns the number of runs without a result, with their most frequent reason.

    Args:
        runs: The number.
        reasons: Why they have none, the most frequent first.
    """
    words = f"{runs} run{'' if runs == 1 else 's'} without a result"
    if not reasons:
        return words
    first = reasons[0]
    message = first.message.splitlines()[0] if first.message else first.cause
    if first.runs == runs:
        return f"{words}: {message}"
    return f"{words}: {message} ({first.runs} of {min(runs, MOST_READ)}, the most frequent reason)"
