"""What it means that two runs fail in the same way, and which violation of a run is followed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from drivora_service.oracles.verdict import Outcome, Severity, Verdict
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.oracles.verdicts.failure_definition import FailureDefinition
from drivora_service.shapes import Shape

DEFAULT_RADIUS_M = 10.0
"""Metres within which two violations are at the same place."""

_SEVERITIES = {severity: rank for rank, severity in enumerate(Severity)}
_ACCOUNTABILITIES = {degree: rank for rank, degree in enumerate(Accountability)}


@dataclass(frozen=True, slots=True, kw_only=True)
class FailureIdentity(Shape):
    """What a violation must have in common with another one to be the same failure.

    Attributes:
        oracle: Violated oracle.
        ego: Id of the ego.
        accountability: Responsibility and avoidability.
        counterpart_role: Role of the other actor; empty where the oracle names none.
        location: Place in metres; null where the oracle tells none, so that any place is the same.
        radius_m: Metres within which a violation is at that place.
    """

    oracle: str
    ego: str
    accountability: Accountability
    counterpart_role: str
    location: tuple[float, float] | None
    radius_m: float

    def is_of(self, verdict: Verdict) -> bool:
        """Returns whether a verdict is a violation of this identity."""
        return (
            verdict.outcome is Outcome.VIOLATED
            and verdict.oracle == self.oracle
            and verdict.ego == self.ego
            and accountability(verdict) is self.accountability
            and _role(verdict) == self.counterpart_role
            and self._is_near(verdict.location)
        )

    def find_in(self, verdicts: Iterable[Verdict]) -> Verdict | None:
        """Returns the earliest violation of this identity in the verdicts of a run."""
        return min(filter(self.is_of, verdicts), key=_time, default=None)

    def _is_near(self, location: tuple[float, float] | None) -> bool:
        if self.location is None or location is None:
            return self.location is location
        return math.dist(self.location, location) <= self.radius_m


def identity_of(verdict: Verdict, *, radius_m: float = DEFAULT_RADIUS_M) -> FailureIdentity:
    """Returns the identity of a violation."""
    return FailureIdentity(
        oracle=verdict.oracle,
        ego=verdict.ego,
        accountability=accountability(verdict),
        counterpart_role=_role(verdict),
        location=verdict.location,
        radius_m=radius_m,
    )


def gravest(
    verdicts: Iterable[Verdict],
    definition: FailureDefinition,
    agents: Mapping[str, str] | None = None,
    *,
    oracle: str = "",
) -> Verdict | None:
    """Returns the gravest failure of a run; ``None`` without any.

    Violations that an ego is at fault for come before others, then the more severe, collisions,
    those with stronger accountability, and the earlier ones.

    Args:
        verdicts: Verdicts of the run.
        definition: What counts as a failure of the run.
        agents: The ADS of each ego.
        oracle: The gravest violation of this oracle, whether it counts or not; "": of any that
            counts.
    """
    found = [
        verdict
        for verdict in verdicts
        if (
            verdict.outcome is Outcome.VIOLATED and verdict.oracle == oracle
            if oracle
            else definition.is_failure(verdict, agents)
        )
    ]
    return min(found, key=_gravity, default=None)


def _gravity(verdict: Verdict) -> tuple[bool, int, bool, int, float, str, str]:
    return (
        not verdict.at_fault,
        _SEVERITIES[verdict.severity],
        verdict.oracle != "collision",
        _ACCOUNTABILITIES[accountability(verdict)],
        _time(verdict),
        verdict.oracle,
        verdict.ego,
    )


def _time(verdict: Verdict) -> float:
    return math.inf if verdict.time is None else verdict.time


def _role(verdict: Verdict) -> str:
    return str(verdict.evidence.get("counterpart_role") or "")
