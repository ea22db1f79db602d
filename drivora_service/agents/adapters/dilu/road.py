"""The route as a frame: distance along it, lateral distance, and the lanes on both sides.

Frame: s metres along the smoothed line of the route, d metres beside it, positive to the left.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.adapters.reference import find_reference
from drivora_service.agents.remote.views import ContextView, LaneView
from drivora_service.geometry.array_shapes import FloatArray

_REACH = 120.0, 160.0
"""Range of the search for places behind and ahead, metres: beyond all relevant actors."""


class RouteFrame:
    """The frame of one route."""

    def __init__(self, context: ContextView) -> None:
        reference = find_reference(context.route, context.lanes)
        self.line, self.arc, self.speeds = reference.line, reference.arc, reference.speeds
        self._steps = np.diff(self.line, axis=0)
        self._squares = np.maximum((self._steps**2).sum(axis=1), 1e-9)
        self._headings = np.unwrap(np.arctan2(self._steps[:, 1], self._steps[:, 0]))
        self._lanes = context.lanes
        route = context.route
        nearest = [int(np.argmin(((route.line - p) ** 2).sum(axis=1))) for p in self.line]
        self._lane_ids = route.lanes[nearest]
        self._ends = _ends(self._lane_ids, self._lanes, self.arc)
        # The line is longer than the route, beyond whose end there are no places.
        self._end = float(self.arc[int(np.argmin(((self.line - route.line[-1]) ** 2).sum(axis=1)))])

    def project(self, points: FloatArray, near: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Returns s, d and the line's heading at the places nearest to (n, 2) points.

        Args:
            points: Metres, in the network's plane.
            near: s around which places are searched, since a route may pass a place twice.
        """
        first = self._index(near - _REACH[0])
        part = slice(first, self._index(near + _REACH[1]) + 1)
        steps = self._steps[part]
        away = points[:, None, :] - self.line[part][None, : len(steps)]
        share = np.clip((away * steps).sum(axis=2) / self._squares[part], 0.0, 1.0)
        off = away - share[:, :, None] * steps
        k = np.argmin((off**2).sum(axis=2), axis=1)
        rows = np.arange(len(points))
        off, share = off[rows, k], share[rows, k]
        k += first
        heading = self._headings[k]
        d = off[:, 1] * np.cos(heading) - off[:, 0] * np.sin(heading)
        s = self.arc[k] + share * (self.arc[k + 1] - self.arc[k])
        return s, d, heading

    def heading(self, s: float) -> float:
        """Returns the direction of the line, radians."""
        return float(self._headings[min(self._index(s), len(self._headings) - 1)])

    def point(self, s: float, d: float) -> tuple[float, float]:
        """Returns x and y."""
        x, y = (float(np.interp(s, self.arc, self.line[:, i])) for i in (0, 1))
        heading = self.heading(s)
        return x - d * math.sin(heading), y + d * math.cos(heading)

    def allowed_speed(self, s: float, ahead: float) -> float:
        """Returns the least speed that limit and bends allow within ``ahead`` metres, m/s."""
        places = np.linspace(s, s + max(ahead, 0.0), 4)
        return float(np.interp(places, self.arc, self.speeds).min())

    def offset(self, s: float, lanes: int) -> float | None:
        """Returns d of the lane ``lanes`` to the left, negative to the right.

        Returns:
            ``None`` if there is no such lane, or changing to it is not allowed.
        """
        lane = self._lane(s)
        if lane is None or (lane.in_junction and lanes):
            return None
        away = 0.0
        for _ in range(abs(lanes)):
            to = lane.left if lanes > 0 else lane.right
            may = lane.may_change_left if lanes > 0 else lane.may_change_right
            if to is None or not may or to not in self._lanes:
                return None
            beside = self._lanes[to]
            away += 0.5 * (lane.width + beside.width)
            lane = beside
        return math.copysign(away, lanes) if lanes else 0.0

    def room_beside(self, s: float, lanes: int) -> float:
        """Returns the metres for which the lane ``lanes`` to the left of the route is usable."""
        k = self._index(s)
        end = min(float(self._ends[k]), self._end)
        place = s
        while place < end and self.offset(place, lanes) is not None:
            place += 10.0
        return max(min(place, end) - s, 0.0)

    def _lane(self, s: float) -> LaneView | None:
        return self._lanes.get(int(self._lane_ids[self._index(s)]))

    def _index(self, s: float) -> int:
        return int(np.clip(np.searchsorted(self.arc, s, side="right") - 1, 0, len(self.arc) - 1))


def _ends(ids: NDArray[np.int64], lanes: Mapping[int, LaneView], arc: FloatArray) -> FloatArray:
    """Returns (n,) s of the next junction or lane change of the route."""
    ends = np.empty(len(ids))
    end = float(arc[-1])
    for k in range(len(ids) - 1, -1, -1):
        lane = lanes.get(int(ids[k]))
        following = int(ids[min(k + 1, len(ids) - 1)])
        if lane is None or lane.in_junction or following not in (lane.id, *lane.successors):
            end = float(arc[k])
        ends[k] = end
    return ends
