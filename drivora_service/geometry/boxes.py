"""Oriented boxes in pairs: overlap, distance, and time to contact.

A box is its centre (metres), heading (radians), length and width (metres). Compiled; arguments and
results are plain numbers.
"""

from __future__ import annotations

import math

from drivora_service.compilation import compiled


@compiled
def overlap_depth(
    dx: float,
    dy: float,
    yaw1: float,
    length1: float,
    width1: float,
    yaw2: float,
    length2: float,
    width2: float,
) -> float:
    """Returns the least overlap over the four separating axes: positive only if the boxes overlap.

    Args:
        dx: Metres from the first centre to the second, east.
        dy: Metres from the first centre to the second, north.
        yaw1: Heading of the first box.
        length1: Its length.
        width1: Its width.
        yaw2: Heading of the second box.
        length2: Its length.
        width2: Its width.
    """
    c1, s1, c2, s2 = math.cos(yaw1), math.sin(yaw1), math.cos(yaw2), math.sin(yaw2)
    c, s = abs(c1 * c2 + s1 * s2), abs(s1 * c2 - c1 * s2)
    hl1, hw1, hl2, hw2 = 0.5 * length1, 0.5 * width1, 0.5 * length2, 0.5 * width2
    depth = hl1 + hl2 * c + hw2 * s - abs(dx * c1 + dy * s1)
    depth = min(depth, hw1 + hl2 * s + hw2 * c - abs(-dx * s1 + dy * c1))
    depth = min(depth, hl2 + hl1 * c + hw1 * s - abs(dx * c2 + dy * s2))
    return min(depth, hw2 + hl1 * s + hw1 * c - abs(-dx * s2 + dy * c2))


@compiled
def boxes_overlap(
    x1: float,
    y1: float,
    yaw1: float,
    length1: float,
    width1: float,
    x2: float,
    y2: float,
    yaw2: float,
    length2: float,
    width2: float,
) -> bool:
    """Returns whether two oriented boxes overlap (separating axes; touching does not count)."""
    dx, dy = x2 - x1, y2 - y1
    c1, s1, c2, s2 = math.cos(yaw1), math.sin(yaw1), math.cos(yaw2), math.sin(yaw2)
    c, s = abs(c1 * c2 + s1 * s2), abs(s1 * c2 - c1 * s2)
    hl1, hw1, hl2, hw2 = 0.5 * length1, 0.5 * width1, 0.5 * length2, 0.5 * width2
    if abs(dx * c1 + dy * s1) >= hl1 + hl2 * c + hw2 * s:
        return False
    if abs(-dx * s1 + dy * c1) >= hw1 + hl2 * s + hw2 * c:
        return False
    if abs(dx * c2 + dy * s2) >= hl2 + hl1 * c + hw1 * s:
        return False
    return abs(-dx * s2 + dy * c2) < hw2 + hl1 * s + hw1 * c


@compiled
def _least_corner_distance(
    dx: float,
    dy: float,
    yaw1: float,
    length1: float,
    width1: float,
    yaw2: float,
    length2: float,
    width2: float,
) -> float:
    """Returns the squared distance of the first box to the nearest corner of the second."""
    c1, s1 = math.cos(yaw1), math.sin(yaw1)
    c2, s2 = math.cos(yaw2), math.sin(yaw2)
    least = math.inf
    for i in range(4):
        along = 0.5 * length2 if i < 2 else -0.5 * length2
        across = 0.5 * width2 if i % 2 == 0 else -0.5 * width2
        x = dx + along * c2 - across * s2
        y = dy + along * s2 + across * c2
        out_x = max(abs(x * c1 + y * s1) - 0.5 * length1, 0.0)
        out_y = max(abs(-x * s1 + y * c1) - 0.5 * width1, 0.0)
        least = min(least, out_x * out_x + out_y * out_y)
    return least


@compiled
def box_gap(
    dx: float,
    dy: float,
    yaw1: float,
    length1: float,
    width1: float,
    yaw2: float,
    length2: float,
    width2: float,
) -> float:
    """Returns the least distance between two boxes in metres, 0 if they touch or overlap.

    Of two separate convex shapes, one of the nearest points is a corner. Arguments as
    ``overlap_depth``.
    """
    if overlap_depth(dx, dy, yaw1, length1, width1, yaw2, length2, width2) >= 0.0:
        return 0.0
    return math.sqrt(
        min(
            _least_corner_distance(dx, dy, yaw1, length1, width1, yaw2, length2, width2),
            _least_corner_distance(-dx, -dy, yaw2, length2, width2, yaw1, length1, width1),
        )
    )


@compiled
def _axis_times(separation: float, speed: float, reach: float) -> tuple[float, float]:
    """Returns begin and end of the overlap of two intervals on an axis, seconds from now."""
    if abs(speed) < 1e-12:
        if abs(separation) >= reach:
            return math.inf, -math.inf
        return -math.inf, math.inf
    first = (-reach - separation) / speed
    second = (reach - separation) / speed
    return min(first, second), max(first, second)


@compiled
def time_to_contact(
    dx: float,
    dy: float,
    dvx: float,
    dvy: float,
    yaw1: float,
    length1: float,
    width1: float,
    yaw2: float,
    length2: float,
    width2: float,
) -> float:
    """Returns the seconds until two boxes overlap, at constant velocities and headings.

    Exact, by separating axes over time: they overlap while their projections on all four axes do.

    Args:
        dx: Metres from the first centre to the second, east.
        dy: Metres from the first centre to the second, north.
        dvx: Velocity of the second minus that of the first, m/s east.
        dvy: Velocity of the second minus that of the first, m/s north.
        yaw1: Heading of the first box.
        length1: Its length.
        width1: Its width.
        yaw2: Heading of the second box.
        length2: Its length.
        width2: Its width.

    Returns:
        0 if they overlap already, infinity if they never will.
    """
    c1, s1, c2, s2 = math.cos(yaw1), math.sin(yaw1), math.cos(yaw2), math.sin(yaw2)
    c, s = abs(c1 * c2 + s1 * s2), abs(s1 * c2 - c1 * s2)
    hl1, hw1, hl2, hw2 = 0.5 * length1, 0.5 * width1, 0.5 * length2, 0.5 * width2
    begin, end = _axis_times(dx * c1 + dy * s1, dvx * c1 + dvy * s1, hl1 + hl2 * c + hw2 * s)
    other = _axis_times(-dx * s1 + dy * c1, -dvx * s1 + dvy * c1, hw1 + hl2 * s + hw2 * c)
    begin, end = max(begin, other[0]), min(end, other[1])
    other = _axis_times(dx * c2 + dy * s2, dvx * c2 + dvy * s2, hl2 + hl1 * c + hw1 * s)
    begin, end = max(begin, other[0]), min(end, other[1])
    other = _axis_times(-dx * s2 + dy * c2, -dvx * s2 + dvy * c2, hw2 + hl1 * s + hw1 * c)
    begin, end = max(begin, other[0]), min(end, other[1])
    if begin >= end or end <= 0.0:
        return math.inf
    return max(begin, 0.0)
