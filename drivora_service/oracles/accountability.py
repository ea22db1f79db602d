"""How far an ego is accountable for a violation: at fault, and able to avoid it."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from drivora_service.oracles.verdict import Answer, Verdict


class Accountability(StrEnum):
    """How far an ego is accountable for a violation, the strongest first."""

    AVOIDABLE = "avoidable"
    """At fault, and a careful and competent driver avoids it; also where the rule does not ask."""
    NOT_MEASURABLE = "not_measurable"
    """At fault; the trace does not show whether it could be avoided."""
    UNAVOIDABLE = "unavoidable"
    """At fault, and a careful and competent driver does not avoid it either."""
    UNDETERMINED = "undetermined"
    """The rule knows fault and cannot tell it here."""
    NOT_JUDGED = "not_judged"
    """The rule knows no fault."""
    NOT_AT_FAULT = "not_at_fault"
    """Another actor is responsible."""


IN_WORDS = {
    Accountability.AVOIDABLE: "at fault",
    Accountability.NOT_MEASURABLE: "at fault, avoidable or not: not measurable",
    Accountability.UNAVOIDABLE: "at fault, not avoidable",
    Accountability.UNDETERMINED: "fault undetermined",
    Accountability.NOT_JUDGED: "",
    Accountability.NOT_AT_FAULT: "not at fault",
}
"""How texts name each; nothing where the rule knows no fault."""

_RANK = {member: rank for rank, member in enumerate(Accountability)}
_AT_FAULT = {
    None: Accountability.AVOIDABLE,
    Answer.YES: Accountability.AVOIDABLE,
    Answer.NOT_MEASURABLE: Accountability.NOT_MEASURABLE,
    Answer.NO: Accountability.UNAVOIDABLE,
}


def accountability(verdict: Verdict) -> Accountability:
    """Returns how far the ego of a violation is accountable for it.

    Only ``avoidable`` counts; ``physically_avoidable`` never does by itself.
    """
    return accountable(verdict.at_fault, verdict.avoidable, undetermined=verdict.undetermined)


def accountable(
    at_fault: bool | None, avoidable: Answer | None, *, undetermined: bool
) -> Accountability:
    """Returns what those three fields of a verdict come to."""
    if at_fault:
        return _AT_FAULT[avoidable]
    if at_fault is False:
        return Accountability.NOT_AT_FAULT
    return Accountability.UNDETERMINED if undetermined else Accountability.NOT_JUDGED


def strongest(violations: Iterable[Verdict]) -> Accountability | None:
    """Returns the strongest accountability of several violations; ``None`` without any."""
    return min(map(accountability, violations), key=_RANK.__getitem__, default=None)
