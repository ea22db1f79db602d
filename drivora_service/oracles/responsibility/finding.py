"""What the table of rules says of a collision."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Fault(StrEnum):
    """Which of the two is responsible."""

    EGO = "ego"
    OTHER = "other"
    UNKNOWN = "unknown"
    """The rules or the trace do not tell."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """The answer of the first rule that applies.

    Attributes:
        rule: Name of the rule in the table.
        fault: Which of the two is responsible.
        reason: Why, for people; part of a sentence.
    """

    rule: str
    fault: Fault
    reason: str

    @property
    def at_fault(self) -> bool | None:
        """Whether the ego is responsible; None where that is unknown."""
        return None if self.fault is Fault.UNKNOWN else self.fault is Fault.EGO
