"""How near the ego came to anybody."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.observations.run_view import EgoView


@dataclass(frozen=True, slots=True, kw_only=True)
class MinGap:
    """Least distance between the ego's box and another; ``None`` if nobody else was there.

    Attributes:
        scale: Metres that score 1, and all that is more.
    """

    scale: float = 10.0

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "min_gap"

    def score(self, ego: EgoView) -> float | None:
        """Scores an ego."""
        gap = ego.proximity.min_gap
        return None if gap is None else min(gap / self.scale, 1.0)
