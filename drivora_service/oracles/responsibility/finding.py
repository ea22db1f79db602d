"""The result of the table of rules for a collision."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Fault(StrEnum):
    """The responsible party."""

    EGO = "ego"
    OTHER = "other"
    UNKNOWN = "unknown"
    """Undetermined by the rules or the trace."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """The result of the first rule that applies.

    Attributes:
        rule: Name of the rule in the table.
        fault: The responsible party.
        reason: Why, as part of a sentence.
        since: Row of the trace in which the responsible party came into the way of the other by a
            manoeuvre; None if it is not responsible for a manoeuvre.
    """

    rule: str
    fault: Fault
    reason: str
    since: int | None = None

    @property
    def at_fault(self) -> bool | None:
        """Whether the ego is responsible; None where that is unknown."""
        return None if self.fault is Fault.UNKNOWN else self.fault is Fault.EGO


def undetermined(rule: str, reason: str) -> Finding:
    """Returns the finding of a rule that cannot tell which party is responsible."""
    return Finding(rule=rule, fault=Fault.UNKNOWN, reason=reason)
