"""Polylines in the plane."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.arrays import FloatArray


def arc_lengths(line: FloatArray) -> FloatArray:
    """Returns the (n,) arc length of each point of an (n, 2) polyline, metres."""
    steps = np.hypot(np.diff(line[:, 0]), np.diff(line[:, 1]))
    return np.concatenate(([0.0], np.cumsum(steps)))
