"""What a campaign lets a tester minimise in place of its own objectives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from drivora_service.feedback.objective_choice import (
    WEIGHTED_SUM,
    ObjectiveChoice,
    share_of,
)


class Guidance(StrEnum):
    """Which chosen objectives a tester can be directed by."""

    NONE = "none"
    """It goes by no objectives: chosen ones are measured and stored only."""
    OWN = "own"
    """It goes by those of its own feedback, and cannot be given others."""
    ONE = "one"
    """It minimises one objective."""
    SEVERAL = "several"
    """It minimises one or more, each for itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Aim:
    """An objective that a campaign has chosen for a tester.

    Attributes:
        name: Its name among the objectives of a measurement.
        target: Value at and below which it is reached; ``None``: none is known.
        scale: Distance from the target that counts one half in :meth:`share`.
    """

    name: str
    target: float | None = None
    scale: float = 1.0

    def share(self, value: float) -> float:
        """Maps a value to 0..1, for testers whose formulas need a range.

        0 is the target, and what is beyond it is below; without a target 0 is never reached.
        """
        share = share_of(value, target=self.target, scale=self.scale)
        return share if self.target is not None else (1.0 + share) / 2.0

    def is_reached(self, value: float) -> bool:
        """Returns whether a value is at the target or beyond it."""
        return self.target is not None and value <= self.target


def aims_of(choices: Sequence[ObjectiveChoice]) -> tuple[Aim, ...]:
    """Returns what a tester minimises if a campaign has chosen objectives: itself, or their sum."""
    if any(one.weight is not None for one in choices):
        return (Aim(name=WEIGHTED_SUM),)
    return tuple(Aim(name=one.name, target=one.target, scale=one.scale) for one in choices)
