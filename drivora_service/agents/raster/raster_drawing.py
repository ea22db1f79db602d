"""Drawing the parts of a bird's-eye raster: the map, the route with its signals, and boxes."""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.agents.raster.polygon_filling import (
    FULL,
    Frame,
    Scratch,
    column_at,
    fill_line,
    fill_marked,
    fill_quad,
    mark_edge,
    row_at,
)
from drivora_service.agents.raster.raster_map import CELL, RasterMap
from drivora_service.agents.raster.raster_settings import Channel
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import ByteArray, FloatArray, IntArray
from drivora_service.observations.trace import LEVEL_GAP, Light

_ROUTE_REACH = 1.5
"""Metres of the route that are shown, before and behind the ego, for each metre between the ego and
the image's furthest corner: more is another part of the route that comes back here."""


class BoxCol(IntEnum):
    """Columns of boxes; metres and radians in the network's plane."""

    X = 0
    Y = 1
    YAW = 2
    LENGTH = 3
    WIDTH = 4
    KIND = 5
    """``BoxKind``."""


class BoxKind(IntEnum):
    """Kinds of boxes: those of perceived actors, and the ego."""

    VEHICLE = 0
    WALKER = 1
    OBSTACLE = 2
    EGO = 3


class Strip(NamedTuple):
    """The route as a strip of quadrangles.

    Attributes:
        left: (n, 2) left border, metres.
        right: (n, 2) right border, metres.
        arc: (n,) distance along the route, metres.
        heights: (n,) metres.
        signal_arcs: (k,) distances of the signals' stop lines along the route, metres.
        signal_lines: (k, 4) these lines, x and y of both ends.
        signal_heights: (k,) metres.
    """

    left: FloatArray
    right: FloatArray
    arc: FloatArray
    heights: FloatArray
    signal_arcs: FloatArray
    signal_lines: FloatArray
    signal_heights: FloatArray


@compiled
def is_level(z: float, low: float, high: float) -> bool:
    """Returns whether a range of heights is on the level of an ego at height ``z``."""
    return low - z <= LEVEL_GAP and z - high <= LEVEL_GAP


@compiled
def draw_map(
    out: ByteArray,
    planes: IntArray,
    frame: Frame,
    ground: RasterMap,
    scratch: Scratch,
    turn: int,
) -> None:
    """Draws areas and lines of a network.

    Args:
        out: (channels, height, width).
        planes: (16,) place of each ``Channel`` on the first axis, or -1.
        frame: The image's place.
        ground: Areas and lines.
        scratch: Memory.
        turn: Number of the image.
    """
    height, width = out.shape[1], out.shape[2]
    # The bounding box of the image in the plane, and the cells below it.
    ahead_0, ahead_1 = (frame.row - height) / frame.scale, frame.row / frame.scale
    left_0, left_1 = (frame.column - width) / frame.scale, frame.column / frame.scale
    west = min(ahead_0 * frame.cos, ahead_1 * frame.cos)
    east = max(ahead_0 * frame.cos, ahead_1 * frame.cos)
    south = min(ahead_0 * frame.sin, ahead_1 * frame.sin)
    north = max(ahead_0 * frame.sin, ahead_1 * frame.sin)
    west += min(-left_0 * frame.sin, -left_1 * frame.sin) + frame.x - ground.origin[0]
    east += max(-left_0 * frame.sin, -left_1 * frame.sin) + frame.x - ground.origin[0]
    south += min(left_0 * frame.cos, left_1 * frame.cos) + frame.y - ground.origin[1]
    north += max(left_0 * frame.cos, left_1 * frame.cos) + frame.y - ground.origin[1]
    # Lines are wider than their ends tell; a metre or a pixel more does for both.
    margin = max(1.0, 1.0 / frame.scale)
    column_0 = max(math.floor((west - margin) / CELL), 0)
    column_1 = min(math.floor((east + margin) / CELL), ground.columns - 1)
    row_0 = max(math.floor((south - margin) / CELL), 0)
    row_1 = min(math.floor((north + margin) / CELL), ground.rows - 1)

    drivable, limits = planes[Channel.DRIVABLE], planes[Channel.SPEED_LIMIT]
    has_lines = planes[Channel.CENTRE_LINES : Channel.GIVE_WAY_SIGNS + 1].max() >= 0
    for row in range(row_0, row_1 + 1):
        for column in range(column_0, column_1 + 1):
            cell = row * ground.columns + column
            if drivable >= 0 or limits >= 0:
                grid = ground.area_grid
                for i in range(grid.starts[cell], grid.starts[cell + 1]):
                    area = grid.items[i]
                    if scratch.area_turns[area] != turn:
                        scratch.area_turns[area] = turn
                        draw_area(out, scratch, frame, ground, area, drivable, limits)
            if has_lines:
                grid = ground.line_grid
                for i in range(grid.starts[cell], grid.starts[cell + 1]):
                    line = grid.items[i]
                    plane = planes[ground.line_channels[line]]
                    if plane < 0 or scratch.line_turns[line] == turn:
                        continue
                    scratch.line_turns[line] = turn
                    heights = ground.line_heights[line]
                    if is_level(frame.z, heights[0], heights[1]):
                        fill_line(out, scratch, frame, plane, ground.lines[line])


@compiled
def draw_area(
    out: ByteArray,
    scratch: Scratch,
    frame: Frame,
    ground: RasterMap,
    area: int,
    drivable: int,
    limits: int,
) -> None:
    """Draws one area if it is on the ego's level and may be in the image."""
    if not is_level(frame.z, ground.area_heights[area, 0], ground.area_heights[area, 1]):
        return
    x, y, radius = ground.circles[area, 0], ground.circles[area, 1], ground.circles[area, 2]
    reach = radius * frame.scale
    r, c = row_at(frame, x, y), column_at(frame, x, y)
    if r < -reach or c < -reach or r > out.shape[1] + reach or c > out.shape[2] + reach:
        return
    low, high = np.inf, -np.inf
    for e in range(ground.area_starts[area], ground.area_starts[area + 1]):
        edge = ground.edges[e]
        r0, c0 = row_at(frame, edge[0], edge[1]), column_at(frame, edge[0], edge[1])
        r1, c1 = row_at(frame, edge[2], edge[3]), column_at(frame, edge[2], edge[3])
        mark_edge(scratch, r0, c0, r1, c1)
        low, high = min(low, r0), max(high, r0)
    limit = int(ground.limits[area])
    fill_marked(out, scratch, low, high, drivable, limits if limit > 0 else -1, limit)


@compiled
def draw_route(
    out: ByteArray,
    planes: IntArray,
    frame: Frame,
    strip: Strip,
    scratch: Scratch,
    s: float,
    light: int,
    line_s: float,
) -> None:
    """Draws the route near the ego, and the line of its next signal.

    Args:
        out: (channels, height, width).
        planes: (16,) place of each ``Channel`` on the first axis, or -1.
        frame: The image's place.
        strip: The route.
        scratch: Memory.
        s: The ego's distance along the route, metres.
        light: State of the next signal, ``Light``.
        line_s: Distance of its stop line along the route, metres; inf without one.
    """
    plane = planes[Channel.ROUTE]
    if plane >= 0:
        height, width = out.shape[1], out.shape[2]
        reach = (
            _ROUTE_REACH
            / frame.scale
            * math.hypot(
                max(frame.row, height - frame.row), max(frame.column, width - frame.column)
            )
        )
        first = max(int(np.searchsorted(strip.arc, s - reach)) - 1, 0)
        end = min(int(np.searchsorted(strip.arc, s + reach)), len(strip.arc) - 1)
        for i in range(first, end):
            z0, z1 = strip.heights[i], strip.heights[i + 1]
            if not is_level(frame.z, min(z0, z1), max(z0, z1)):
                continue
            a, b, c, d = strip.left[i], strip.left[i + 1], strip.right[i + 1], strip.right[i]
            fill_quad(
                out, scratch, plane,
                row_at(frame, a[0], a[1]), column_at(frame, a[0], a[1]),
                row_at(frame, b[0], b[1]), column_at(frame, b[0], b[1]),
                row_at(frame, c[0], c[1]), column_at(frame, c[0], c[1]),
                row_at(frame, d[0], d[1]), column_at(frame, d[0], d[1]),
            )  # fmt: skip
    plane = -1
    if light == Light.RED:
        plane = planes[Channel.RED]
    elif light == Light.YELLOW:
        plane = planes[Channel.YELLOW]
    elif light == Light.GREEN:
        plane = planes[Channel.GREEN]
    if plane < 0 or not line_s < np.inf or not len(strip.signal_arcs):
        return
    nearest = np.argmin(np.abs(strip.signal_arcs - line_s))
    z = strip.signal_heights[nearest]
    if is_level(frame.z, z, z):
        fill_line(out, scratch, frame, plane, strip.signal_lines[nearest])


@compiled
def draw_boxes(
    out: ByteArray,
    planes: IntArray,
    frame: Frame,
    boxes: FloatArray,
    count: int,
    scratch: Scratch,
) -> None:
    """Draws actors as boxes; the pixel of a box's centre is set in any case.

    Args:
        out: (channels, height, width).
        planes: (4,) place of each ``BoxKind`` on the first axis, or -1.
        frame: The image's place.
        boxes: (N, 6), columns ``BoxCol``.
        count: Rows that are drawn.
        scratch: Memory.
    """
    for i in range(count):
        plane = planes[int(boxes[i, BoxCol.KIND])]
        if plane < 0:
            continue
        x, y = boxes[i, BoxCol.X], boxes[i, BoxCol.Y]
        cos, sin = math.cos(boxes[i, BoxCol.YAW]), math.sin(boxes[i, BoxCol.YAW])
        half_length, half_width = 0.5 * boxes[i, BoxCol.LENGTH], 0.5 * boxes[i, BoxCol.WIDTH]
        ax, ay, bx, by = half_length * cos, half_length * sin, -half_width * sin, half_width * cos
        fill_quad(
            out, scratch, plane,
            row_at(frame, x + ax + bx, y + ay + by), column_at(frame, x + ax + bx, y + ay + by),
            row_at(frame, x - ax + bx, y - ay + by), column_at(frame, x - ax + bx, y - ay + by),
            row_at(frame, x - ax - bx, y - ay - by), column_at(frame, x - ax - bx, y - ay - by),
            row_at(frame, x + ax - bx, y + ay - by), column_at(frame, x + ax - bx, y + ay - by),
        )  # fmt: skip
        r, c = row_at(frame, x, y), column_at(frame, x, y)
        if 0.0 <= r < out.shape[1] and 0.0 <= c < out.shape[2]:
            out[plane, int(r), int(c)] = FULL
