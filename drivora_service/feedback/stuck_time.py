"""How long the ego stood still."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.observations.run_view import EgoView
from drivora_service.oracles.blocked import Blocked, standing_clock


@dataclass(frozen=True, slots=True, kw_only=True)
class StuckTime:
    """One less the longest standstill over the time after which an ego counts as blocked.

    The longer the ego stood without a signal to wait for, the smaller the score.

    Attributes:
        scale: Seconds that score 0.
    """

    scale: float = Blocked().duration

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "stuck_time"

    def score(self, ego: EgoView) -> float | None:
        """Scores an ego."""
        return 1.0 - min(float(standing_clock(ego).max()) / self.scale, 1.0)
