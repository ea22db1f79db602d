"""The part of the plane that a picture shows, and its size on paper."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col, Trace
from drivora_service.oracles.verdict import Verdict

_MARGIN_M = 12.0
_MARGIN_SHARE = 0.06
_SMALLEST_SIDE_M = 60.0
_MAP_WIDTH_IN = 8.6
_MAP_HEIGHTS_IN = (5.4, 8.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """A rectangle of the network's plane and its size on paper.

    Attributes:
        min_x: Metres, like the other three sides.
        width_in: Inches.
        height_in: Inches.
    """

    min_x: float
    min_y: float
    max_x: float
    max_y: float
    width_in: float
    height_in: float

    @property
    def metres_an_inch(self) -> float:
        """Scale of the picture."""
        return (self.max_x - self.min_x) / self.width_in

    def holds(self, x: float, y: float) -> bool:
        """Returns whether a point is in the rectangle."""
        return self.min_x <= x <= self.max_x and self.min_y <= y <= self.max_y

    def touches(self, points: FloatArray, margin: float = 10.0) -> bool:
        """Returns whether the box around (n, 2) points is within ``margin`` metres of the view."""
        low, high = points.min(axis=0), points.max(axis=0)
        return bool(
            high[0] >= self.min_x - margin
            and low[0] <= self.max_x + margin
            and high[1] >= self.min_y - margin
            and low[1] <= self.max_y + margin
        )


def view_of_run(trace: Trace, verdicts: Sequence[Verdict]) -> View:
    """Chooses the rectangle that holds the egos' trails, destinations and verdicts."""
    egos = trace.states[:, : trace.ego_count, [Col.X, Col.Y]].reshape(-1, 2)
    places = [
        egos[np.isfinite(egos).all(axis=1)],
        np.array([route.goal for route in trace.ego_routes]).reshape(-1, 2),
        np.array([v.location for v in verdicts if v.location is not None]).reshape(-1, 2),
    ]
    points = np.concatenate(places)
    low, high = points.min(axis=0), points.max(axis=0)
    centre = 0.5 * (low + high)
    size = np.maximum(high - low, _SMALLEST_SIDE_M)
    size = size * (1.0 + 2.0 * _MARGIN_SHARE) + 2.0 * _MARGIN_M
    aspect = float(size[1] / size[0])
    height_in = min(max(aspect * _MAP_WIDTH_IN, _MAP_HEIGHTS_IN[0]), _MAP_HEIGHTS_IN[1])
    scale = max(float(size[0]) / _MAP_WIDTH_IN, float(size[1]) / height_in)
    half_x, half_y = 0.5 * scale * _MAP_WIDTH_IN, 0.5 * scale * height_in
    return View(
        min_x=float(centre[0] - half_x),
        min_y=float(centre[1] - half_y),
        max_x=float(centre[0] + half_x),
        max_y=float(centre[1] + half_y),
        width_in=_MAP_WIDTH_IN,
        height_in=height_in,
    )
