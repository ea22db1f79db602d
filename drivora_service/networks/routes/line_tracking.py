"""Projection of a moving point on a line, searched near its last position."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray


@compiled
def track_line(
    line: FloatArray, arc: FloatArray, cursor: int, behind: int, ahead: int, x: float, y: float
) -> tuple[int, float, float]:
    """Projects a point on the part of a line around ``cursor``.

    A search of the whole line would jump if a line passes the same place twice.

    Args:
        line: (n, 2) metres, n >= 2.
        arc: (n,) arc length, metres.
        cursor: Index of the segment of the last step.
        behind: Number of segments to search before it.
        ahead: Number of segments to search after it.
        x: Metres.
        y: Metres.

    Returns:
        Index of the nearest segment, arc length of the foot point in metres, and the signed
        distance from the line in metres, positive to the left.
    """
    first = max(cursor - behind, 0)
    last = min(cursor + ahead, line.shape[0] - 2)
    best, best_i, best_t = np.inf, first, 0.0
    for i in range(first, last + 1):
        ax, ay = line[i, 0], line[i, 1]
        bx, by = line[i + 1, 0] - ax, line[i + 1, 1] - ay
        span = bx * bx + by * by
        t = ((x - ax) * bx + (y - ay) * by) / span if span > 0.0 else 0.0
        t = min(max(t, 0.0), 1.0)
        dx, dy = x - ax - t * bx, y - ay - t * by
        distance = dx * dx + dy * dy
        if distance < best:
            best, best_i, best_t = distance, i, t
    bx = line[best_i + 1, 0] - line[best_i, 0]
    by = line[best_i + 1, 1] - line[best_i, 1]
    cross = bx * (y - line[best_i, 1]) - by * (x - line[best_i, 0])
    s = arc[best_i] + best_t * (arc[best_i + 1] - arc[best_i])
    return best_i, s, math.copysign(math.sqrt(best), cross)
