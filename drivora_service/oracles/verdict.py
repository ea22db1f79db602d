"""What an oracle says about a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Protocol

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.trace import Trace


class Outcome(StrEnum):
    """The three answers of an oracle."""

    PASSED = "passed"
    VIOLATED = "violated"
    NOT_MEASURABLE = "not_measurable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """One oracle's answer for one ego.

    Attributes:
        oracle: Name of the oracle.
        ego: Id of the ego.
        outcome: Violated or not, or why neither can be said (in ``message``).
        message: One sentence for people.
        at_fault: Whether the ego is responsible; ``None`` where the rule knows no fault.
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
    at_fault: bool | None = None
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

    def judge(self, trace: Trace, network: RoadNetwork) -> tuple[Verdict, ...]:
        """Judges a run: at least one verdict for every ego; several where a rule is broken often.

        A rule that was not broken by an ego gives exactly one verdict for it.
        """
        ...
