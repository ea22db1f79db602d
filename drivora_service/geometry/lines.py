"""Polylines in the plane."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray


def arc_lengths(line: FloatArray) -> FloatArray:
    """Returns the (n,) arc length of each point of an (n, 2) polyline, metres."""
    steps = np.hypot(np.diff(line[:, 0]), np.diff(line[:, 1]))
    return np.concatenate(([0.0], np.cumsum(steps)))


def offset_line(shape: FloatArray, distance: float) -> FloatArray:
    """Shifts an (n, 2) polyline by ``distance`` metres to the left of its direction."""
    steps = np.diff(shape, axis=0)
    steps = steps / np.maximum(np.hypot(steps[:, 0], steps[:, 1]), 1e-9)[:, None]
    normals = np.stack((-steps[:, 1], steps[:, 0]), axis=1)
    at_points = np.concatenate((normals[:1], 0.5 * (normals[:-1] + normals[1:]), normals[-1:]))
    at_points = at_points / np.maximum(np.hypot(at_points[:, 0], at_points[:, 1]), 0.5)[:, None]
    return shape + distance * at_points
