"""What an oracle says about a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Protocol

from drivora_service.shapes import Shape

if TYPE_CHECKING:
    # Whoever only handles verdicts and reports is spared the loading of what judges need.
    from drivora_service.observations.run_view import EgoView, RunView


class Outcome(StrEnum):
    """The three answers of an oracle."""

    PASSED = "passed"
    VIOLATED = "violated"
    NOT_MEASURABLE = "not_measurable"


class Severity(StrEnum):
    """How much a violation of a rule weighs."""

    CRITICAL = "critical"
    """Harm was done: a collision."""
    MAJOR = "major"
    """Harm was risked, or traffic law broken: a red light, the wrong way."""
    MINOR = "minor"
    """A fault of driving that endangers no other actor: speeding, a missed destination."""
    OBSERVATION = "observation"
    """No failure unless a campaign or gate names the oracle: discomfort, a near miss."""


class Answer(StrEnum):
    """The answer to a question about a violation that not every trace can decide."""

    YES = "yes"
    NO = "no"
    NOT_MEASURABLE = "not_measurable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict(Shape):
    """One oracle's answer for one ego.

    Attributes:
        oracle: Name of the oracle.
        ego: Id of the ego.
        outcome: Violated or not, or why neither can be said (in ``message``).
        message: One sentence for people.
        severity: Of the rule that was broken.
        at_fault: Whether the ego is responsible; ``None`` where the rule knows no fault, and where
            it cannot tell.
        undetermined: The rule knows fault and cannot tell it here (``at_fault`` is ``None``).
        avoidable: Whether a careful and competent driver would have avoided it (UNECE R157);
            ``None`` where the rule does not ask.
        physically_avoidable: Whether braking or steering to the full grip from the same moment
            without delay would have; ``None`` where the rule does not ask.
        time: Seconds of simulation at which the violation began; ``None`` if there is none.
        step: Row of the trace at that time.
        location: (x, y) in metres at that time.
        counterpart: Id of the other actor involved, or "".
        evidence: Measured values by name; SI units.
    """

    oracle: str
    ego: str
    outcome: Outcome
    message: str
    severity: Severity = Severity.MAJOR
    at_fault: bool | None = None
    undetermined: bool = False
    avoidable: Answer | None = None
    physically_avoidable: Answer | None = None
    time: float | None = None
    step: int | None = None
    location: tuple[float, float] | None = None
    counterpart: str = ""
    evidence: Mapping[str, Any] = field(default_factory=dict)


class Oracle(Protocol):
    """A rule. Frozen dataclasses whose fields are the thresholds implement it."""

    @property
    def name(self) -> str:
        """Name in the catalogue, in snake case."""
        ...

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Judges a run: at least one verdict for every ego; several where a rule is broken often.

        A rule that was not broken by an ego gives exactly one verdict for it. Only rows of the
        trace up to the end of the ego's part count.
        """
        ...


def passed(oracle: str, ego: EgoView, message: str, **evidence: Any) -> Verdict:
    """Says that an ego kept a rule."""
    return Verdict(
        oracle=oracle, ego=ego.id, outcome=Outcome.PASSED, message=message, evidence=evidence
    )


def not_measurable(oracle: str, ego: EgoView, message: str, **evidence: Any) -> Verdict:
    """Says why it cannot be said whether an ego kept a rule."""
    return Verdict(
        oracle=oracle,
        ego=ego.id,
        outcome=Outcome.NOT_MEASURABLE,
        message=message,
        evidence=evidence,
    )


def violated(
    oracle: str,
    ego: EgoView,
    k: int,
    message: str,
    *,
    severity: Severity = Severity.MAJOR,
    at_fault: bool | None = None,
    undetermined: bool = False,
    avoidable: Answer | None = None,
    physically_avoidable: Answer | None = None,
    counterpart: str = "",
    **evidence: Any,
) -> Verdict:
    """Says that an ego broke a rule, from its row ``k`` on."""
    return Verdict(
        oracle=oracle,
        ego=ego.id,
        outcome=Outcome.VIOLATED,
        message=message,
        severity=severity,
        at_fault=at_fault,
        undetermined=undetermined,
        avoidable=avoidable,
        physically_avoidable=physically_avoidable,
        time=float(ego.times[k]),
        step=ego.first + k,
        location=ego.location(k),
        counterpart=counterpart,
        evidence=evidence,
    )


def not_started(oracle: str, ego: EgoView) -> Verdict:
    """Says that an ego never began to drive."""
    return not_measurable(oracle, ego, "The run ended before the ego's start time.")
