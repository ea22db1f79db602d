"""Whose rows of a trace are wanted; apart, so that naming them does not load Arrow."""

from __future__ import annotations

from enum import StrEnum


class TraceRows(StrEnum):
    """Whose rows a stream of a trace has."""

    ALL = "all"
    EGOS = "egos"
