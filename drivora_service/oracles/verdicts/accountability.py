"""The accountability of an ego for a violation, from its fault and the avoidability."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from drivora_service.oracles.verdict import Answer, Verdict


class Accountability(StrEnum):
    """The degrees of an ego's accountability for a violation, the strongest first."""

    AVOIDABLE = "avoidable"
    """At fault, and avoided by a careful and competent driver, or avoidability is not judged."""
    NOT_MEASURABLE = "not_measurable"
    """At fault; the trace does not show whether it was avoidable."""
    UNAVOIDABLE = "unavoidable"
    """At fault, and a careful and competent driver does not avoid it either."""
    UNDETERMINED = "undetermined"
    """The oracle attributes fault, but not in this case."""
    NOT_JUDGED = "not_judged"
    """The oracle does not attribute fault."""
    PREVENTABLE = "preventable"
    """Another actor is responsible, but a careful and competent driver avoids it."""
    NOT_AT_FAULT = "not_at_fault"
    """Another actor is responsible, and a careful driver does not avoid it, or it is not known."""


IN_WORDS = {
    Accountability.AVOIDABLE: "at fault",
    Accountability.NOT_MEASURABLE: "at fault, avoidable or not: not measurable",
    Accountability.UNAVOIDABLE: "at fault, not avoidable",
    Accountability.UNDETERMINED: "fault undetermined",
    Accountability.NOT_JUDGED: "",
    Accountability.PREVENTABLE: "not at fault, but avoidable",
    Accountability.NOT_AT_FAULT: "not at fault",
}
"""Names of the degrees in texts; "" where the oracle does not attribute fault."""

AT_FAULT = frozenset(
    {Accountability.AVOIDABLE, Accountability.NOT_MEASURABLE, Accountability.UNAVOIDABLE}
)
"""Degrees of an ego that is at fault."""

ACCOUNTABLE = frozenset(
    {Accountability.AVOIDABLE, Accountability.NOT_MEASURABLE, Accountability.NOT_JUDGED}
)
"""Degrees that count by default: not faults of others, unavoidable violations and undetermined
faults."""

_RANK = {member: rank for rank, member in enumerate(Accountability)}
_AT_FAULT = {
    None: Accountability.AVOIDABLE,
    Answer.YES: Accountability.AVOIDABLE,
    Answer.NOT_MEASURABLE: Accountability.NOT_MEASURABLE,
    Answer.NO: Accountability.UNAVOIDABLE,
}


def accountability(verdict: Verdict) -> Accountability:
    """Returns the accountability of a violation's ego.

    It depends on ``avoidable``; ``physically_avoidable`` has no effect.
    """
    return accountable(verdict.at_fault, verdict.avoidable, undetermined=verdict.undetermined)


def accountable(
    at_fault: bool | None, avoidable: Answer | None, *, undetermined: bool
) -> Accountability:
    """Returns the accountability for three fields of a verdict."""
    if at_fault:
        return _AT_FAULT[avoidable]
    if at_fault is False:
        # UNECE R157 asks what a careful and competent driver would have prevented, regardless of
        # who caused the danger.
        is_preventable = avoidable is Answer.YES
        return Accountability.PREVENTABLE if is_preventable else Accountability.NOT_AT_FAULT
    return Accountability.UNDETERMINED if undetermined else Accountability.NOT_JUDGED


def strongest(violations: Iterable[Verdict]) -> Accountability | None:
    """Returns the strongest accountability of several violations; ``None`` without any."""
    return strongest_of(map(accountability, violations))


def strongest_of(found: Iterable[Accountability]) -> Accountability | None:
    """Returns the strongest of several accountabilities; ``None`` without any."""
    return min(found, key=_RANK.__getitem__, default=None)
