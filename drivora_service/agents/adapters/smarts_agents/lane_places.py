"""Lanes of vehicles, and places along them.

Frame: the network's plane, metres, radians counter-clockwise from east; left is positive.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from drivora_service.agents.adapters.path_lines import arc_of
from drivora_service.agents.remote.views import LaneView
from drivora_service.geometry.array_shapes import FloatArray

_ODD_HEADING = 0.8
"""Maximum angle between a vehicle and the lane that it follows, radians."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LanePlace:
    """A place on a lane: metres along it, and to the left of its middle."""

    lane: int
    s: float
    t: float


class LanePlaces:
    """Finds the lane under a vehicle."""

    def __init__(self, lanes: Mapping[int, LaneView]) -> None:
        """Args: lanes: Lanes by id."""
        views = list(lanes.values())
        self._ids = np.array([view.id for view in views for _ in view.line[1:]])
        self._starts = np.concatenate([np.empty((0, 2)), *(view.line[:-1] for view in views)])
        steps = [np.diff(view.line, axis=0) for view in views]
        self._steps = np.concatenate([np.empty((0, 2)), *steps])
        self._arcs = np.concatenate([np.empty(0), *(arc_of(view.line)[:-1] for view in views)])
        self._lengths = np.maximum(np.hypot(*self._steps.T), 1e-9)
        self._headings = np.arctan2(self._steps[:, 1], self._steps[:, 0])
        self._halves = np.array([0.5 * view.width for view in views for _ in view.line[1:]])

    def find(self, place: FloatArray, yaw: float) -> LanePlace | None:
        """Returns the lane that a vehicle at ``place`` follows, ``None`` if there is none."""
        away = place - self._starts
        share = np.clip((away * self._steps).sum(axis=1) / self._lengths**2, 0.0, 1.0)
        gaps = np.hypot(*(away - share[:, None] * self._steps).T)
        turns = np.abs(np.mod(self._headings - yaw + math.pi, math.tau) - math.pi)
        fits = (gaps < self._halves) & (turns < _ODD_HEADING)
        if not fits.any():
            return None
        # A junction's lanes overlap: the heading distinguishes them.
        best = int(np.argmin(np.where(fits, gaps + 3.0 * turns, np.inf)))
        (dx, dy), (ax, ay) = self._steps[best].tolist(), away[best].tolist()
        return LanePlace(
            lane=int(self._ids[best]),
            s=float(self._arcs[best] + share[best] * self._lengths[best]),
            t=math.copysign(float(gaps[best]), dx * ay - dy * ax),
        )


def lane_index(lanes: Mapping[int, LaneView], lane: int) -> int:
    """Returns the number of a lane, counted from the right; 0 within junctions."""
    index, current = 0, lanes[lane]
    while not current.in_junction and current.right is not None and current.right in lanes:
        index, current = index + 1, lanes[current.right]
    return index
