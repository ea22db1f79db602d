"""Reports and choices of feedback as JSON text, for the database and for programs."""

from __future__ import annotations

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.oracles.verdicts.verdict_json import plain_value
from drivora_service.runs.run_report import RunReport
from drivora_service.shapes import adapter


def report_to_json(report: RunReport) -> str:
    """Writes a report as JSON; NaN and infinities become ``null``."""
    return adapter(RunReport).dump_json(report, fallback=plain_value).decode()


def report_to_message(report: RunReport) -> bytes:
    """Writes a report as JSON for another process of this version, without what has its default.

    Most fields of a passed verdict have: a report is a third smaller, and quicker to read.
    Stored reports have all fields, since later versions may have other defaults.
    """
    return adapter(RunReport).dump_json(report, exclude_defaults=True, fallback=plain_value)


def report_from_json(text: str | bytes) -> RunReport:
    """Reads what :func:`report_to_json` or :func:`report_to_message` wrote."""
    report: RunReport = adapter(RunReport).validate_json(text)
    return report


def choice_to_json(choice: FeedbackChoice) -> str:
    """Writes a choice of feedback as JSON, as earlier versions did if it has no objectives."""
    # Rows of runs are compared with this text when a campaign goes on.
    left_out = None if choice.objectives else {"objectives"}
    return (
        adapter(FeedbackChoice).dump_json(choice, exclude=left_out, fallback=plain_value).decode()
    )


def choice_from_json(text: str | bytes) -> FeedbackChoice:
    """Reads what :func:`choice_to_json` wrote."""
    choice: FeedbackChoice = adapter(FeedbackChoice).validate_json(text)
    return choice
