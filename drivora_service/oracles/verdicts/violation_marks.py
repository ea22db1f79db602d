"""Violations of a run with their numbers and moments, for pictures and time lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from drivora_service.oracles.verdict import Outcome, Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A violation with its number."""

    number: int
    verdict: Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Moments:
    """The moments of a violation, as rows of the trace.

    Attributes:
        first: Row in which it began.
        last: Last row in which it went on; ``first`` for a violation of a moment.
        risk_perceived: Row from which on a careful driver perceives the risk; None where the
            oracle does not measure that, or no risk was to be perceived.
        avoidable_until: Last row in which a careful driver could still avoid it; None where it
            could not be avoided, or the oracle does not measure that.
    """

    first: int
    last: int
    risk_perceived: int | None
    avoidable_until: int | None


def marks_of(verdicts: Sequence[Verdict]) -> tuple[Mark, ...]:
    """Numbers the violations in order of time; those without a time come last."""
    violated = [v for v in verdicts if v.outcome is Outcome.VIOLATED]
    violated.sort(key=lambda v: (v.time is None, v.time or 0.0, v.oracle, v.ego))
    return tuple(Mark(number=k + 1, verdict=v) for k, v in enumerate(violated))


def moments_of(verdict: Verdict, step_length: float) -> Moments | None:
    """Returns the moments of a violation; None if it has no time.

    Violations that last have the time of their last row as ``until`` in the evidence; the moments
    of avoidability are in the evidence ``avoidability``, in seconds before the contact.
    """
    step, time = verdict.step, verdict.time
    if step is None or time is None:
        return None
    replayed = verdict.evidence.get("avoidability")
    evidence: Mapping[str, object] = replayed if isinstance(replayed, Mapping) else {}

    def before(name: str) -> int | None:
        seconds = _seconds(evidence.get(name))
        return None if seconds is None else step - round(seconds / step_length)

    until = _seconds(verdict.evidence.get("until"))
    return Moments(
        first=step,
        last=step if until is None else step + max(round((until - time) / step_length), 0),
        risk_perceived=before("risk_perceived_before"),
        avoidable_until=before("latest_before"),
    )


def _seconds(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None
