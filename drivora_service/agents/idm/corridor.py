"""Actors in the way ahead, and actors beside; compiled.

Frame: the network's plane, metres, radians counter-clockwise from east; arc lengths are those of
the lane run that the agent follows.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray

SIDE_ROOM = 0.35
TIGHT_ROOM = 0.08
"""Metres that suffice to creep past a standing actor."""
_WALKER_HORIZON = 3.5


@compiled
def gap_on_line(
    line: FloatArray,
    arc: FloatArray,
    cursor: int,
    s: float,
    reach: float,
    half_length: float,
    half_width: float,
    side_room: float,
    v: float,
    objects: FloatArray,
    sizes: FloatArray,
    kinds: IntArray,
    count: int,
) -> tuple[float, float, int]:
    """Finds the actor at the end of the free corridor: gap in metres, speed along it, index.

    The corridor is ``side_room`` metres wider on each side than the vehicle.
    """
    best, best_speed, best_j = np.inf, 0.0, -1
    for j in range(count):
        x, y = objects[j, 0], objects[j, 1]
        radius = 0.5 * math.hypot(sizes[j, 0], sizes[j, 1])
        px, py = line[cursor, 0], line[cursor, 1]
        if math.hypot(x - px, y - py) > reach + radius + half_length:
            continue
        near, near_i = np.inf, -1
        cos, sin = math.cos(objects[j, 2]), math.sin(objects[j, 2])
        ahead_hit, ahead_speed = np.inf, 0.0
        for i in range(cursor, line.shape[0] - 1):
            at = arc[i] - s
            if at > reach + radius:
                break
            dx, dy = x - line[i, 0], y - line[i, 1]
            d2 = dx * dx + dy * dy
            if d2 < near:
                near, near_i = d2, i
            if d2 > (radius + half_width + 2.5) ** 2:
                continue
            ux, uy = line[i + 1, 0] - line[i, 0], line[i + 1, 1] - line[i, 1]
            span = math.sqrt(ux * ux + uy * uy)
            if span < 1e-9:
                continue
            ux, uy = ux / span, uy / span
            along, side = dx * ux + dy * uy, -dx * uy + dy * ux
            c, d = abs(cos * ux + sin * uy), abs(sin * ux - cos * uy)
            extent = 0.5 * (sizes[j, 0] * c + sizes[j, 1] * d)
            across = 0.5 * (sizes[j, 0] * d + sizes[j, 1] * c)
            if abs(along) > 1.0 or abs(side) > half_width + across + side_room:
                continue
            gap = at + along - half_length - extent
            if at + along < -half_length:
                continue
            if gap < ahead_hit:
                ahead_hit = gap
                ahead_speed = objects[j, 3] * ux + objects[j, 4] * uy
        if near_i >= 0 and ahead_hit == np.inf:
            # Not in the corridor yet: a walker that approaches it, or a vehicle that cuts in.
            i = near_i
            ux, uy = line[i + 1, 0] - line[i, 0], line[i + 1, 1] - line[i, 1]
            span = math.sqrt(ux * ux + uy * uy)
            if span > 1e-9:
                ux, uy = ux / span, uy / span
                dx, dy = x - line[i, 0], y - line[i, 1]
                side = -dx * uy + dy * ux
                towards = -(-objects[j, 3] * uy + objects[j, 4] * ux) * math.copysign(1.0, side)
                d = abs(sin * ux - cos * uy)
                c = abs(cos * ux + sin * uy)
                across = 0.5 * (sizes[j, 0] * d + sizes[j, 1] * c) + half_width + side_room
                at = arc[i] - s - half_length - radius
                horizon = _WALKER_HORIZON if kinds[j] == 1 else 1.2
                if towards > 0.3 and at > -half_length:
                    t_in = (abs(side) - across) / towards
                    t_out = (abs(side) + across) / towards
                    t_here = max(at, 0.0) / max(v, 1.0)
                    if t_in < horizon and t_in < t_here + 1.5 and t_out > t_here - 1.0:
                        ahead_hit = at
                        ahead_speed = objects[j, 3] * ux + objects[j, 4] * uy
        if ahead_hit < best:
            best, best_speed, best_j = ahead_hit, ahead_speed, j
    return best, best_speed, best_j


@compiled
def lane_is_free(
    line: FloatArray,
    arc: FloatArray,
    cursor: int,
    s: float,
    v: float,
    half_length: float,
    objects: FloatArray,
    sizes: FloatArray,
    count: int,
) -> bool:
    """Returns whether an adjacent lane has room: no actor near, none closing in."""
    for j in range(count):
        x, y = objects[j, 0], objects[j, 1]
        if math.hypot(x - line[cursor, 0], y - line[cursor, 1]) > 80.0:
            continue
        best, best_i = 4.0, -1
        for i in range(max(cursor - 70, 0), min(cursor + 70, line.shape[0] - 1)):
            d2 = (x - line[i, 0]) ** 2 + (y - line[i, 1]) ** 2
            if d2 < best:
                best, best_i = d2, i
        if best_i < 0:
            continue
        ux, uy = line[best_i + 1, 0] - line[best_i, 0], line[best_i + 1, 1] - line[best_i, 1]
        span = max(math.sqrt(ux * ux + uy * uy), 1e-9)
        speed = (objects[j, 3] * ux + objects[j, 4] * uy) / span
        distance = arc[best_i] - s
        room = abs(distance) - half_length - 0.5 * sizes[j, 0]
        if distance >= 0.0:
            if room < 3.0 + 0.3 * v + max(v - speed, 0.0) * 2.0:
                return False
        elif room < 5.0 + 0.3 * speed + max(speed - v, 0.0) * 3.5:
            return False
    return True
