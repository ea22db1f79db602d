"""The line along which planners in the Frenet frame sample, with the road beside it.

Frame: the network's plane, metres, radians counter-clockwise from east; left is positive.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.adapters.path_lines import arc_of, normals, resample
from drivora_service.agents.adapters.route_lanes import beside_one_another
from drivora_service.agents.remote.views import LaneView, RouteView
from drivora_service.geometry.array_shapes import FloatArray

_SPACING = 1.0
_SMOOTHING = 1.5
"""Standard deviation of the smoothing of lanes, metres, since planners need a curvature."""

_BEFORE, _BEHIND = 15.0, 90.0
"""Metres of straight extension at both ends, for plans that begin or end beyond."""

_SIDE_ACCELERATION = 2.5
_BRAKING = 1.5
"""m/s²: lateral in bends, and braking before them."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reference:
    """A route's line, smooth and longer than the route.

    Attributes:
        line: (n, 2) metres.
        arc: (n,) metres from its start.
        speeds: (n,) m/s, by the limits and by its bends.
        left: (n,) distance of the left border of the usable lanes there, metres.
        right: (n,) distance of the right border, metres, positive.
    """

    line: FloatArray
    arc: FloatArray
    speeds: FloatArray
    left: FloatArray
    right: FloatArray


def find_reference(route: RouteView, lanes: Mapping[int, LaneView]) -> Reference:
    """Makes the reference of a route.

    Beside a lane of the route its neighbours in the same direction are usable, but not within
    junctions.
    """
    line = resample(_smooth(_extend_ends(resample(route.line, _SPACING))), _SPACING)
    arc = arc_of(line)
    nearest = np.array([int(np.argmin(((route.line - p) ** 2).sum(axis=1))) for p in line])
    left, right = _room(lanes, route.lanes[nearest], line)
    speeds = np.minimum(route.speed_limits[nearest], _bend_speeds(line))
    for i in range(len(speeds) - 2, -1, -1):
        speeds[i] = min(
            speeds[i], math.sqrt(speeds[i + 1] ** 2 + 2.0 * _BRAKING * (arc[i + 1] - arc[i]))
        )
    return Reference(line=line, arc=arc, speeds=speeds, left=left, right=right)


def _extend_ends(line: FloatArray) -> FloatArray:
    first = (line[0] - line[1]) / max(float(np.hypot(*(line[0] - line[1]))), 1e-9)
    last = (line[-1] - line[-2]) / max(float(np.hypot(*(line[-1] - line[-2]))), 1e-9)
    before = np.arange(_BEFORE, 0.5, -_SPACING)[:, None]
    behind = np.arange(_SPACING, _BEHIND + 0.5, _SPACING)[:, None]
    return np.concatenate((line[0] + before * first, line, line[-1] + behind * last))


def _smooth(line: FloatArray) -> FloatArray:
    reach = math.ceil(3.0 * _SMOOTHING / _SPACING)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) * _SPACING / _SMOOTHING) ** 2)
    weights /= weights.sum()
    inner = np.column_stack([np.convolve(line[:, k], weights, "valid") for k in (0, 1)])
    return np.concatenate((line[:reach], inner, line[-reach:]))


def _bend_speeds(line: FloatArray) -> FloatArray:
    along = np.gradient(line, axis=0)
    heading = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
    curvature = np.abs(np.gradient(heading)) / np.maximum(np.hypot(*along.T), 1e-6)
    speeds: FloatArray = np.sqrt(_SIDE_ACCELERATION / np.maximum(curvature, 1e-4))
    return speeds


def _room(
    lanes: Mapping[int, LaneView], point_lanes: NDArray[np.int64], line: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Returns (n,) metres to the left and the right border of the lanes side by side."""
    left, right = np.empty(len(line)), np.empty(len(line))
    across = normals(line)
    for lane in np.unique(point_lanes).tolist():
        view = lanes[lane]
        centre = resample(view.line, 0.5)
        on_the_left, on_the_right = _widths_beside(lanes, lane)
        for i in np.flatnonzero(point_lanes == lane).tolist():
            foot = centre[int(np.argmin(((centre - line[i]) ** 2).sum(axis=1)))]
            beside = float((foot - line[i]) @ across[i])
            left[i] = 0.5 * view.width + beside + on_the_left
            right[i] = 0.5 * view.width - beside + on_the_right
    return left, right


def _widths_beside(lanes: Mapping[int, LaneView], lane: int) -> tuple[float, float]:
    """Returns the widths of all lanes to the left, and of all to the right."""
    everything = beside_one_another(lanes, lane)
    leftmost = everything[1:]
    current = lanes[lane].left
    on_the_left = 0.0
    while current in leftmost:
        on_the_left += lanes[current].width
        current = lanes[current].left
    return on_the_left, sum(lanes[k].width for k in leftmost) - on_the_left
