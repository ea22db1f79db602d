"""Plane geometry that every room shares: angles, arc length, oriented boxes.

Angles are radians, counter-clockwise from east.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def wrap_angle(angle: float) -> float:
    """Brings an angle into [-pi, pi)."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def arc_lengths(line: FloatArray) -> FloatArray:
    """Gives the (n,) arc length of each point of an (n, 2) polyline, metres."""
    steps = np.hypot(np.diff(line[:, 0]), np.diff(line[:, 1]))
    return np.concatenate(([0.0], np.cumsum(steps)))


def box_corners(
    x: FloatArray, y: FloatArray, yaw: FloatArray, length: float, width: float
) -> FloatArray:
    """Gives the (n, 4, 2) corners of boxes, front left first, counter-clockwise."""
    ahead = np.stack((np.cos(yaw), np.sin(yaw)), axis=-1)[:, None, :] * (0.5 * length)
    left = np.stack((-np.sin(yaw), np.cos(yaw)), axis=-1)[:, None, :] * (0.5 * width)
    signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    centres = np.stack((x, y), axis=-1)[:, None, :]
    return centres + signs[None, :, :1] * ahead + signs[None, :, 1:] * left
