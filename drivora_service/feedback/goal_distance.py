"""How far from its destination the ego ended."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalDistance:
    """One less the distance between the ego's end and its goal, over the length of its route.

    As all objectives it is smaller the nearer the ego was to a failure, which here is not to
    arrive: an ego that ends at its goal scores 1, one that ends a route's length away 0. The scale
    is the route, so that the score tells ends apart wherever they are.
    """

    @property
    def name(self) -> str:
        """Name in the catalogue."""
        return "goal_distance"

    def score(self, ego: EgoView) -> float | None:
        """Scores an ego."""
        if not ego.route.length > 0.0:
            return None
        goal_x, goal_y = ego.route.goal
        away = np.hypot(ego.states[-1, Col.X] - goal_x, ego.states[-1, Col.Y] - goal_y)
        return 1.0 - min(float(away) / ego.route.length, 1.0)
