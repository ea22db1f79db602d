"""The result of an import: a document, and notes on dropped parts."""

from __future__ import annotations

import re
from dataclasses import dataclass

from drivora_service.scenario.documents import ScenarioDocument


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportedScenario:
    """A scenario read from a file.

    Attributes:
        name: Short name for files and listings; letters, digits, ``_`` and ``-``.
        document: Document in the frame of the file.
        notes: What was dropped or interpreted, one sentence each.
    """

    name: str
    document: ScenarioDocument
    notes: tuple[str, ...]


def short_name(text: str, default: str) -> str:
    """Returns a file name made from a text."""
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", text).strip("_")[:64]
    return name or default
