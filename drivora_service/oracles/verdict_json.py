"""Verdicts as JSON text, for the database and for programs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from drivora_service.oracles.verdict import Verdict


def verdict_to_json(verdict: Verdict) -> str:
    """Writes a verdict as JSON; NaN and infinities become ``null``."""
    return _adapter().dump_json(verdict, fallback=plain_value).decode()


def verdict_from_json(text: str | bytes) -> Verdict:
    """Reads what :func:`verdict_to_json` wrote."""
    return _adapter().validate_json(text)


def plain_verdict(verdict: Verdict) -> Verdict:
    """Returns a verdict as it is read back from storage, with Python's own types only.

    Raises:
        ValueError: A field is of a wrong type, or the evidence cannot be written as JSON.
    """
    # Types are checked on reading, where NumPy's numbers count as numbers.
    text = _adapter().dump_json(verdict, fallback=plain_value, warnings=False)
    return verdict_from_json(text)


def plain_value(value: Any) -> Any:
    """Converts the NumPy values that evidence may hold to Python's.

    Raises:
        TypeError: JSON cannot express the value.
    """
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a report cannot hold a {type(value).__name__}")


@cache
def _adapter() -> TypeAdapter[Verdict]:
    return TypeAdapter(Verdict)
