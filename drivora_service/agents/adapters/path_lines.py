"""Lines of points in the plane, metres."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray


def resample(line: FloatArray, spacing: float = 1.0) -> FloatArray:
    """Returns a line with points evenly spaced, about ``spacing`` metres apart."""
    arc = arc_of(line)
    places = np.linspace(0.0, arc[-1], max(2, int(arc[-1] / spacing) + 1))
    return np.column_stack([np.interp(places, arc, line[:, k]) for k in (0, 1)])


def arc_of(line: FloatArray) -> FloatArray:
    """Returns the arc length at each point, metres."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))


def normals(line: FloatArray) -> FloatArray:
    """Returns the (n, 2) unit vectors to the left of a line."""
    along = np.gradient(line, axis=0)
    across = np.column_stack((-along[:, 1], along[:, 0]))
    unit: FloatArray = across / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    return unit


def directions(yaws: FloatArray) -> FloatArray:
    """Returns the (n, 2) unit vectors of (n,) angles, radians."""
    return np.column_stack((np.cos(yaws), np.sin(yaws)))
