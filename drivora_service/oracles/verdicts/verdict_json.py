"""Verdicts as JSON text, for the database and for programs."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic_core import from_json

from drivora_service.oracles.verdict import Verdict
from drivora_service.shapes import adapter


def verdict_to_json(verdict: Verdict) -> str:
    """Writes a verdict as JSON; NaN and infinities become ``null``."""
    return adapter(Verdict).dump_json(verdict, fallback=plain_value).decode()


def verdict_content(verdict: Verdict) -> dict[str, Any]:
    """Returns a verdict as the values of its JSON."""
    content: dict[str, Any] = from_json(verdict_to_json(verdict))
    return content


def verdict_from_json(text: str | bytes) -> Verdict:
    """Reads what :func:`verdict_to_json` wrote."""
    verdict: Verdict = adapter(Verdict).validate_json(text)
    return verdict


def plain_verdict(verdict: Verdict) -> Verdict:
    """Returns a verdict as it is read back from storage, with Python's own types only.

    Raises:
        ValueError: A field is of a wrong type, or the evidence cannot be written as JSON.
    """
    # Types are checked on reading, where NumPy's numbers count as numbers.
    text = adapter(Verdict).dump_json(verdict, fallback=plain_value, warnings=False)
    return verdict_from_json(text)


def plain_value(value: Any) -> Any:
    """Converts the NumPy values that evidence may hold to Python's.

    Raises:
        TypeError: JSON cannot express the value.
    """
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a report cannot hold a {type(value).__name__}")
