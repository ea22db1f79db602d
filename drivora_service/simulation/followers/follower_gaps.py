"""The gap ahead of a follower: the first actor in the corridor along its path.

Actors are sorted by position once a step, so that each follower looks only at those near it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.sampled_lines import SPACING
from drivora_service.observations.trace import LEVEL_GAP, Col, SizeCol
from drivora_service.simulation.followers.follower_path import PathCol

_POINTS_APART = 1.01 * SPACING
_ROUNDING = 1e-3
"""Metres by which quick checks of distances are wider than the exact ones."""


class ActorOrder(NamedTuple):
    """The n present actors, sorted along an axis.

    Attributes:
        axis: ``Col.X`` or ``Col.Y``.
        radius: Covers every box, metres.
        positions: (n,) ascending positions on the axis, metres.
        rows: (n,) rows of the actors.
    """

    axis: int
    radius: float
    positions: FloatArray
    rows: IntArray


@compiled
def order_actors(states: FloatArray, sizes: FloatArray, present: BoolArray) -> ActorOrder:
    """Returns the present actors along the axis on which they are spread further."""
    radius = 0.0
    low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
    count = 0
    for j in range(states.shape[0]):
        if present[j]:
            count += 1
            radius = max(radius, 0.5 * (sizes[j, SizeCol.LENGTH] + sizes[j, SizeCol.WIDTH]))
            low_x, high_x = min(low_x, states[j, Col.X]), max(high_x, states[j, Col.X])
            low_y, high_y = min(low_y, states[j, Col.Y]), max(high_y, states[j, Col.Y])
    # Fewer actors share a position on the longer axis: fewer are looked at for each follower.
    axis = 0 if high_x - low_x >= high_y - low_y else 1
    positions, rows = np.empty(count), np.empty(count, dtype=np.int64)
    at = 0
    for j in range(states.shape[0]):
        if present[j]:
            positions[at], rows[at] = states[j, axis], j
            at += 1
    order = np.argsort(positions)
    return ActorOrder(axis, radius, positions[order], rows[order])


@compiled
def gap_ahead(
    row: int,
    way: FloatArray,
    cursor: int,
    s: float,
    reach: float,
    half_length: float,
    half_width: float,
    states: FloatArray,
    sizes: FloatArray,
    order: ActorOrder,
) -> tuple[float, float, int]:
    """Returns the free metres in the corridor ahead, and speed and row of the actor at its end.

    Args:
        row: Row of the follower.
        way: (n, 9) its path, columns ``PathCol``.
        cursor: Index of the path point at or before ``s``.
        s: Its arc length on the path, metres.
        reach: Metres to look ahead.
        half_length: Of the follower, metres.
        half_width: Of the follower, metres.
        states: (N, 9) states of the actors.
        sizes: (N, 2), columns ``SizeCol``.
        order: The actors, sorted.

    Returns:
        Metres, m/s along the path, and row; inf, 0 and -1 if the corridor is free.
    """
    axis, positions, rows = order.axis, order.positions, order.rows
    best, best_speed, best_row = np.inf, 0.0, -1
    x0, y0 = way[cursor, PathCol.X], way[cursor, PathCol.Y]
    along_axis, beside_axis = (x0, y0) if axis == 0 else (y0, x0)
    furthest = reach + half_length + order.radius + 2.0 + _ROUNDING
    first, last = 0, positions.shape[0]
    while first < last:
        middle = (first + last) // 2
        if positions[middle] < along_axis - furthest:
            first = middle + 1
        else:
            last = middle
    for k in range(first, positions.shape[0]):
        if positions[k] > along_axis + furthest:
            break
        j = rows[k]
        if j == row or abs(states[j, 1 - axis] - beside_axis) > furthest:
            continue
        if abs(states[j, Col.Z] - states[row, Col.Z]) > LEVEL_GAP:
            continue
        x, y = states[j, Col.X], states[j, Col.Y]
        size = 0.5 * math.hypot(sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH])
        if math.hypot(x - x0, y - y0) > reach + half_length + size + 2.0:
            continue
        # Path points further away than this cannot be beside the other's box.
        near = half_width + size + 1.5
        following = cursor
        while following < way.shape[0]:
            i = following
            following += 1
            at = way[i, PathCol.ARC] - s
            if at > reach + half_length + size:
                break
            if at < 0.0:
                continue
            dx, dy = x - way[i, PathCol.X], y - way[i, PathCol.Y]
            if dx * dx + dy * dy > near * near:
                # Points nearer to this one than the other's box is from it need no check.
                following += int(max(math.hypot(dx, dy) - near - _ROUNDING, 0.0) / _POINTS_APART)
                continue
            pcos, psin = way[i, PathCol.COS], way[i, PathCol.SIN]
            along = dx * pcos + dy * psin
            if abs(along) > 0.75:
                continue
            side = abs(-dx * psin + dy * pcos)
            cos, sin = math.cos(states[j, Col.YAW]), math.sin(states[j, Col.YAW])
            # Half extents of the other box along and across the path.
            c, d = abs(cos * pcos + sin * psin), abs(sin * pcos - cos * psin)
            across = 0.5 * (sizes[j, SizeCol.LENGTH] * d + sizes[j, SizeCol.WIDTH] * c)
            if side > half_width + across + 0.2:
                continue
            extent = 0.5 * (sizes[j, SizeCol.LENGTH] * c + sizes[j, SizeCol.WIDTH] * d)
            gap = at + along - half_length - extent
            if gap < best or (gap == best and j < best_row):
                best, best_row = gap, j
                best_speed = states[j, Col.VX] * pcos + states[j, Col.VY] * psin
            break
    return best, best_speed, best_row
