"""The relation of a walk along lanes to the routes of the egos."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.lane_walks import LaneWalk

_SPACING = 2.0
_ON_ROUTE = 1.2
"""Metres from the route's line up to which a lane is the route's own."""
_MEETING = 1.6
"""Metres up to which two paths count as crossing."""
_OPPOSITE = 8.0
"""Metres up to which the lane of the other direction is a neighbour."""
_BESIDE = 5.0
"""Metres up to which a lane of the same direction is a neighbour."""
_ALONG = 0.7
"""Cosine of the angle up to which two paths have the same direction."""
_LEAST_COMMON = 10.0
"""Least length on which two paths run along each other, metres."""
_FROM_BEHIND = 6.0
"""Metres from the route's beginning in which a joining path comes from behind its start."""


class Relation(StrEnum):
    """The relation of an NPC's path to an ego's route, the most relevant first."""

    CROSSING = "crossing"
    """Crosses the route at some angle."""
    MERGING = "merging"
    """Joins the route from another lane."""
    ONCOMING = "oncoming"
    """Comes in the opposite direction on the adjacent lane."""
    LEADING = "leading"
    """Starts on the route, ahead of the ego's start."""
    BESIDE = "beside"
    """Runs on a neighbouring lane of the same direction."""
    TRAILING = "trailing"
    """Comes from behind the route's start and follows it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _LaneView:
    """A lane seen from a route.

    Attributes:
        s: (n,) arc length of samples on the lane, metres.
        gap: (n,) metres to the route's line; inf if it is out of reach.
        cosine: (n,) cosine of the angle between the two directions.
        along: (n,) arc length of the nearest point of the route, metres.
    """

    s: FloatArray
    gap: FloatArray
    cosine: FloatArray
    along: FloatArray


class RouteSurroundings:
    """The lanes around one ego's route, up to ``reach`` metres; every lane is sampled once."""

    def __init__(self, network: RoadNetwork, route: DrivenPath, reach: float) -> None:
        self._network, self._route, self._reach = network, route, max(reach, _OPPOSITE)
        self._low = route.line.min(axis=0) - self._reach
        self._high = route.line.max(axis=0) + self._reach
        self._views: dict[int, _LaneView] = {}

    def stretch_within(self, lane: int) -> tuple[float, float] | None:
        """Returns the arc lengths of a lane between which it is in reach."""
        view = self._view(lane)
        near = np.flatnonzero(view.gap <= self._reach)
        return (float(view.s[near[0]]), float(view.s[near[-1]])) if len(near) else None

    def gap_at(self, lane: int, s: float) -> float:
        """Returns the metres from a place on a lane to the route; inf if it is out of reach."""
        view = self._view(lane)
        return float(view.gap[int(np.argmin(np.abs(view.s - s)))])

    def relation(self, walk: LaneWalk) -> Relation | None:
        """Returns the relation of a walk to the route; ``None`` if it does not come near."""
        gap, cosine, along = self._measure_walk(walk)
        same_way, own_length = cosine > _ALONG, _LEAST_COMMON / _SPACING
        own = (gap < _ON_ROUTE) & same_way
        if np.count_nonzero(own) >= own_length:
            first = int(np.argmax(own))
            if along[first] <= _FROM_BEHIND:
                return Relation.TRAILING
            return Relation.LEADING if first == 0 else Relation.MERGING
        if ((gap < _MEETING) & ~same_way).any():
            return Relation.CROSSING
        if np.count_nonzero((gap < _OPPOSITE) & (cosine < -_ALONG)) >= own_length:
            return Relation.ONCOMING
        if np.count_nonzero((gap < _BESIDE) & same_way) >= own_length:
            return Relation.BESIDE
        return None

    def _measure_walk(self, walk: LaneWalk) -> tuple[FloatArray, FloatArray, FloatArray]:
        gaps, cosines, alongs = [], [], []
        for position, lane in enumerate(walk.lanes):
            view = self._view(lane)
            kept = slice(None)
            if position in (0, len(walk.lanes) - 1):
                low = walk.start_s if position == 0 else 0.0
                high = walk.end_s if position == len(walk.lanes) - 1 else np.inf
                kept = slice(*np.searchsorted(view.s, (low, high)))
            gaps.append(view.gap[kept])
            cosines.append(view.cosine[kept])
            alongs.append(view.along[kept])
        return np.concatenate(gaps), np.concatenate(cosines), np.concatenate(alongs)

    def _view(self, lane: int) -> _LaneView:
        if lane not in self._views:
            self._views[lane] = self._look_at(lane)
        return self._views[lane]

    def _look_at(self, index: int) -> _LaneView:
        lane, route = self._network.lanes[index], self._route
        length = float(lane.arc[-1])
        s = np.linspace(0.0, length, max(int(np.ceil(length / _SPACING)) + 1, 2))
        x = np.interp(s, lane.arc, lane.shape[:, 0])
        y = np.interp(s, lane.arc, lane.shape[:, 1])
        heading = elementary.arctan2(np.gradient(y), np.gradient(x))
        gap, nearest = np.full(len(s), np.inf), np.zeros(len(s), dtype=np.int64)
        xy = np.column_stack((x, y))
        near = ((xy >= self._low) & (xy <= self._high)).all(axis=1)
        if near.any():
            gaps = np.hypot(x[near, None] - route.line[:, 0], y[near, None] - route.line[:, 1])
            nearest[near] = np.argmin(gaps, axis=1)
            gap[near] = gaps.min(axis=1)
        return _LaneView(
            s=s,
            gap=gap,
            cosine=elementary.cos(heading - route.yaw[nearest]),
            along=route.arc[nearest],
        )


def closest_relation(walk: LaneWalk, surroundings: Sequence[RouteSurroundings]) -> Relation | None:
    """Returns the most relevant of a walk's relations to several routes."""
    found = {around.relation(walk) for around in surroundings}
    return next((relation for relation in Relation if relation in found), None)


def spread_out(cells: NDArray[np.float64], count: int) -> tuple[int, ...]:
    """Chooses rows that differ: the first, then always the one least similar to the chosen.

    Args:
        cells: (n, m) 1 where candidate i passes cell j, else 0.
        count: Number of rows to choose.

    Returns:
        Indices in the order of choosing; without rows that are equal to a chosen one.
    """
    sizes = cells.sum(axis=1)
    chosen: list[int] = []
    likeness = np.zeros(len(cells))
    while len(chosen) < min(count, len(cells)):
        best = int(np.argmin(likeness))
        if likeness[best] >= 1.0:
            break
        chosen.append(best)
        common = cells @ cells[best]
        likeness = np.maximum(likeness, common / np.maximum(sizes + sizes[best] - common, 1.0))
        likeness[best] = np.inf
    return tuple(chosen)
