"""How far the ego got along its route."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import EgoCol


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Share of the route that was driven: 0 for an ego that never left its start."""

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "progress"

    def score(self, ego: EgoView) -> float | None:
        """Scores an ego."""
        done = ego.value(EgoCol.ROUTE_S) / ego.route.length
        if not np.isfinite(done).any():
            return None
        return float(np.clip(np.nanmax(done), 0.0, 1.0))
