"""Reports, verdicts and choices of feedback as JSON text, for the database and for programs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.oracles.verdict import Verdict
from drivora_service.runs.report import RunReport


def report_to_json(report: RunReport) -> str:
    """Writes a report as JSON; NaN and infinities become ``null``."""
    return _adapter().dump_json(report, fallback=_plain).decode()


def report_from_json(text: str | bytes) -> RunReport:
    """Reads what :func:`report_to_json` wrote."""
    return _adapter().validate_json(text)


def verdict_to_json(verdict: Verdict) -> str:
    """Writes a verdict as JSON; NaN and infinities become ``null``."""
    return _verdict_adapter().dump_json(verdict, fallback=_plain).decode()


def verdict_from_json(text: str | bytes) -> Verdict:
    """Reads what :func:`verdict_to_json` wrote."""
    return _verdict_adapter().validate_json(text)


def choice_to_json(choice: FeedbackChoice) -> str:
    """Writes a choice of feedback as JSON."""
    return _choice_adapter().dump_json(choice, fallback=_plain).decode()


def choice_from_json(text: str | bytes) -> FeedbackChoice:
    """Reads what :func:`choice_to_json` wrote."""
    return _choice_adapter().validate_json(text)


@cache
def _choice_adapter() -> TypeAdapter[FeedbackChoice]:
    return TypeAdapter(FeedbackChoice)


@cache
def _verdict_adapter() -> TypeAdapter[Verdict]:
    return TypeAdapter(Verdict)


@cache
def _adapter() -> TypeAdapter[RunReport]:
    return TypeAdapter(RunReport)


def _plain(value: Any) -> Any:
    """Turns the NumPy values that evidence may hold into Python's."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a report cannot hold a {type(value).__name__}")
