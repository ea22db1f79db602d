"""Steering along a line by pure pursuit, compiled.

Frame: the network's plane, metres, radians counter-clockwise from east.
"""

from __future__ import annotations

import math

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray

_LEAST_PREVIEW = 3.5
_PREVIEW_TIME = 0.6


@compiled
def point_at(line: FloatArray, arc: FloatArray, cursor: int, s: float) -> tuple[float, float]:
    """Returns the point at arc length ``s``; beyond the end, straight on."""
    i = cursor
    n = line.shape[0]
    while i < n - 2 and arc[i + 1] < s:
        i += 1
    while i > 0 and arc[i] > s:
        i -= 1
    t = (s - arc[i]) / max(arc[i + 1] - arc[i], 1e-9)
    return (
        line[i, 0] + t * (line[i + 1, 0] - line[i, 0]),
        line[i, 1] + t * (line[i + 1, 1] - line[i, 1]),
    )


@compiled
def preview(v: float, wheelbase: float) -> float:
    """Returns the preview distance ahead of the rear axle, metres."""
    return max(_LEAST_PREVIEW, 0.5 * wheelbase + _PREVIEW_TIME * v)


@compiled
def steer_at(tx: float, ty: float, x: float, y: float, yaw: float, wheelbase: float) -> float:
    """Returns the front-wheel angle that leads to a point, by pure pursuit (Coulter 1992).

    It steers the rear axle: with the centre, a car would cut its corners.

    Args:
        tx, ty: The point, metres.
        x, y, yaw: The car's centre and heading.
        wheelbase: Metres.
    """
    rear_x, rear_y = x - 0.5 * wheelbase * math.cos(yaw), y - 0.5 * wheelbase * math.sin(yaw)
    dx, dy = tx - rear_x, ty - rear_y
    angle = math.atan2(dy, dx) - yaw
    curvature = 2.0 * math.sin(angle) / max(math.hypot(dx, dy), 1.0)
    return math.atan(wheelbase * curvature)
