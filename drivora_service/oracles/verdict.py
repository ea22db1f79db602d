"""Oracles and their verdicts on a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from drivora_service.shapes import Shape

if TYPE_CHECKING:
    # Modules that only handle verdicts need not load the dependencies of oracles.
    from drivora_service.observations.run_view import EgoView, RunView


class Outcome(StrEnum):
    """The four possible outcomes of an oracle."""

    PASSED = "passed"
    VIOLATED = "violated"
    NOT_APPLICABLE = "not_applicable"
    """Nothing to judge: the ego did not come into a situation that the oracle judges."""
    NOT_MEASURABLE = "not_measurable"
    """The trace does not show whether the ego violated the oracle."""

    @property
    def in_words(self) -> str:
        """The outcome as texts and tables name it."""
        if self is Outcome.NOT_APPLICABLE:
            return "nothing to judge"
        return self.value.replace("_", " ")


WITHOUT_FINDING = frozenset({Outcome.PASSED, Outcome.NOT_APPLICABLE})
"""Outcomes of most verdicts, which have nothing to list: they are left out of rows and lists."""


class Severity(StrEnum):
    """The severity of a violation."""

    CRITICAL = "critical"
    """Harm was done: a collision."""
    MAJOR = "major"
    """Harm was risked, or traffic law was violated: a red light, the wrong way."""
    MINOR = "minor"
    """A fault of driving that endangers no other actor: speeding, a missed destination."""
    OBSERVATION = "observation"
    """Not a failure unless a campaign or gate names the oracle: discomfort, a near miss."""


class Answer(StrEnum):
    """The answer to a question about a violation, which some traces cannot decide."""

    YES = "yes"
    NO = "no"
    NOT_MEASURABLE = "not_measurable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict(Shape):
    """An oracle's verdict on one ego.

    Attributes:
        oracle: Name of the oracle.
        ego: Id of the ego.
        outcome: Violated, passed, nothing to judge or not measurable (``message`` has the reason).
        message: One sentence.
        severity: Severity of the oracle's violations.
        at_fault: Whether the ego is responsible; ``None`` if the oracle does not attribute fault,
            and if the fault is undetermined.
        undetermined: The oracle attributes fault, but not in this case (``at_fault`` is ``None``).
        avoidable: Whether a careful and competent driver would have avoided it (UNECE R157);
            ``None`` if the oracle does not measure that.
        physically_avoidable: Whether full braking or steering without delay from the same moment on
            would have avoided it; ``None`` if the oracle does not measure that.
        time: Simulation time in seconds at which the violation began; ``None`` if there is none.
        step: Row of the trace at that time.
        location: (x, y) in metres at that time.
        counterpart: Id of the other actor involved, or "".
        evidence: Measured values by name, SI units.
        follows: Oracle of the ego's violation that this one only follows from; empty: of none.
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
    follows: str = ""


class Oracle(Protocol):
    """An oracle: a frozen dataclass whose fields are its thresholds."""

    @property
    def name(self) -> str:
        """Name in the catalogue, in snake case."""
        ...

    def judge(self, run: RunView) -> tuple[Verdict, ...]:
        """Judges a run: at least one verdict for every ego, and one for each violation.

        An ego without violations has exactly one verdict. Only rows of the trace up to the end of
        the ego's part count.
        """
        ...


@runtime_checkable
class ConditionalOracle(Protocol):
    """An oracle that says nothing of most runs, for example of scenarios without what it needs."""

    def applies(self, run: RunView) -> bool:
        """Returns whether the oracle is to judge a run; without that, the run has no verdict."""
        ...


def passed(oracle: str, ego: EgoView, message: str, **evidence: Any) -> Verdict:
    """Returns the verdict that an ego passed."""
    return Verdict(
        oracle=oracle, ego=ego.id, outcome=Outcome.PASSED, message=message, evidence=evidence
    )


def not_applicable(oracle: str, ego: EgoView, message: str, **evidence: Any) -> Verdict:
    """Returns the verdict that an oracle had nothing to judge of an ego, with the reason."""
    return Verdict(
        oracle=oracle,
        ego=ego.id,
        outcome=Outcome.NOT_APPLICABLE,
        message=message,
        evidence=evidence,
    )


def not_measurable(oracle: str, ego: EgoView, message: str, **evidence: Any) -> Verdict:
    """Returns the verdict that an oracle is not measurable for an ego, with the reason."""
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
    """Returns the verdict of a violation that begins in the ego's row ``k``."""
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
    """Returns the verdict on an ego that never started."""
    return not_measurable(oracle, ego, "The run ended before the ego's start time.")
