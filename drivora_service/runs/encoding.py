"""Reports and choices of feedback as JSON text, for the database and for programs."""

from __future__ import annotations

from functools import cache

from pydantic import TypeAdapter

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.oracles.verdict_json import plain_value
from drivora_service.runs.report import RunReport


def report_to_json(report: RunReport) -> str:
    """Writes a report as JSON; NaN and infinities become ``null``."""
    return _adapter().dump_json(report, fallback=plain_value).decode()


def report_from_json(text: str | bytes) -> RunReport:
    """Reads what :func:`report_to_json` wrote."""
    return _adapter().validate_json(text)


def choice_to_json(choice: FeedbackChoice) -> str:
    """Writes a choice of feedback as JSON."""
    return _choice_adapter().dump_json(choice, fallback=plain_value).decode()


def choice_from_json(text: str | bytes) -> FeedbackChoice:
    """Reads what :func:`choice_to_json` wrote."""
    return _choice_adapter().validate_json(text)


@cache
def _choice_adapter() -> TypeAdapter[FeedbackChoice]:
    return TypeAdapter(FeedbackChoice)


@cache
def _adapter() -> TypeAdapter[RunReport]:
    return TypeAdapter(RunReport)
