"""How soon the ego and another would have collided."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.observations.proximity import HORIZON
from drivora_service.observations.run_view import EgoView


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeToCollision:
    """Least time to a collision at constant velocities; ``None`` if nobody else was there.

    Attributes:
        scale: Seconds that score 1, as does nobody being on a collision course; at most the horizon
            of the measurement.
    """

    scale: float = HORIZON

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "time_to_collision"

    def score(self, ego: EgoView) -> float | None:
        """Scores an ego."""
        if ego.proximity.min_gap is None:
            return None
        return min(float(ego.proximity.time_to_collision.min()) / self.scale, 1.0)
