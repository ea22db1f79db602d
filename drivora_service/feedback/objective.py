"""What a search minimises."""

from __future__ import annotations

from typing import Protocol

from drivora_service.observations.run_view import EgoView


class Objective(Protocol):
    """A score of one ego's part of a run. Frozen dataclasses implement it.

    A smaller score is nearer to a failure; scores lie in 0..1. ``None`` is "not measurable": what
    was not there is never scored as 0, which would be the best of all.
    """

    @property
    def name(self) -> str:
        """Name in the catalogue, in snake case."""
        ...

    def score(self, ego: EgoView) -> float | None:
        """Scores an ego that has at least one row."""
        ...
