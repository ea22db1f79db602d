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
    fill_corners,
    fill_marked,
    mark_edge,
    row_at,
    set_corner,
    set_line,
)
from drivora_service.agents.raster.raster_map import CELL, RasterMap
from drivora_service.agents.raster.raster_settings import Channel
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import ByteArray, FloatArray, Int32Array, IntArray
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
        quads: (n - 1, 4, 2) corners of the quadrangles between two points, metres.
        arc: (n,) distance along the route, metres.
        heights: (n - 1, 2) lowest and highest height between two points, metres.
        signal_arcs: (k,) distances of the signals' stop lines along the route, metres.
        signal_lines: (k, 4) these lines, x and y of both ends.
        signal_heights: (k, 2) lowest and highest height of each line, metres.
    """

    quads: FloatArray
    arc: FloatArray
    heights: FloatArray
    signal_arcs: FloatArray
    signal_lines: FloatArray
    signal_heights: FloatArray


@compiled
def is_level(z: float, heights: FloatArray, i: int) -> bool:
    """Returns whether an item is on the level of an ego at height ``z``.

    Args:
        z: Metres.
        heights: (n, 2) lowest and highest height of items, metres.
        i: Which of them.
    """
    low: float = heights[i, 0]
    high: float = heights[i, 1]
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
    marks, spans, corners = scratch.marks, scratch.spans, scratch.corners
    area_turns, line_turns = scratch.area_turns, scratch.line_turns
    areas, lines = ground.area_grid, ground.line_grid
    for row in range(row_0, row_1 + 1):
        for column in range(column_0, column_1 + 1):
            cell = row * ground.columns + column
            for i in range(areas.starts[cell], areas.starts[cell + 1]):
                area = areas.items[i]
                if area_turns[area] == turn or not (drivable >= 0 or limits >= 0):
                    continue
                area_turns[area] = turn
                # What is on the ego's level and may be in the image.
                reach = ground.circles[area, 2] * frame.scale
                r = row_at(frame, ground.circles[area, 0], ground.circles[area, 1])
                c = column_at(frame, ground.circles[area, 0], ground.circles[area, 1])
                is_beside = r < -reach or c < -reach or r > height + reach or c > width + reach
                if is_beside or not is_level(frame.z, ground.area_heights, area):
                    continue
                first, end = ground.area_starts[area], ground.area_starts[area + 1]
                limit = int(ground.limits[area])
                fill_area(
                    out, marks, spans, frame, ground.edges, first, end, drivable,
                    limits if limit > 0 else -1, limit,
                )  # fmt: skip
            for i in range(lines.starts[cell], lines.starts[cell + 1]):
                line = lines.items[i]
                plane = planes[ground.line_channels[line]]
                if plane < 0 or line_turns[line] == turn:
                    continue
                line_turns[line] = turn
                if not is_level(frame.z, ground.line_heights, line):
                    continue
                if set_line(corners, frame, ground.lines, line):
                    fill_corners(out, marks, spans, corners, plane)


@compiled
def fill_area(
    out: ByteArray,
    marks: ByteArray,
    spans: Int32Array,
    frame: Frame,
    edges: FloatArray,
    first: int,
    end: int,
    drivable: int,
    limits: int,
    limit: int,
) -> None:
    """Sets the pixels inside of some edges; see ``fill_marked``."""
    low, high = np.inf, -np.inf
    for e in range(first, end):
        r0, c0 = row_at(frame, edges[e, 0], edges[e, 1]), column_at(frame, edges[e, 0], edges[e, 1])
        r1, c1 = row_at(frame, edges[e, 2], edges[e, 3]), column_at(frame, edges[e, 2], edges[e, 3])
        mark_edge(marks, spans, r0, c0, r1, c1)
        low, high = min(low, r0), max(high, r0)
    fill_marked(out, marks, spans, low, high, drivable, limits, limit)


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
    marks, spans, corners = scratch.marks, scratch.spans, scratch.corners
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
        first = max(first_beyond(strip.arc, s - reach) - 1, 0)
        end = min(first_beyond(strip.arc, s + reach), len(strip.arc) - 1)
        for i in range(first, end):
            if is_level(frame.z, strip.heights, i):
                for k in range(4):
                    set_corner(corners, frame, k, strip.quads[i, k, 0], strip.quads[i, k, 1])
                fill_corners(out, marks, spans, corners, plane)
    plane = -1
    if light == Light.RED:
        plane = planes[Channel.RED]
    elif light == Light.YELLOW:
        plane = planes[Channel.YELLOW]
    elif light == Light.GREEN:
        plane = planes[Channel.GREEN]
    if plane < 0 or not line_s < np.inf or not len(strip.signal_arcs):
        return
    nearest = 0
    for i in range(1, len(strip.signal_arcs)):
        if abs(strip.signal_arcs[i] - line_s) < abs(strip.signal_arcs[nearest] - line_s):
            nearest = i
    if is_level(frame.z, strip.signal_heights, nearest):
        set_line(corners, frame, strip.signal_lines, nearest)
        fill_corners(out, marks, spans, corners, plane)


@compiled
def first_beyond(arc: FloatArray, s: float) -> int:
    """Returns the index of the first of ascending numbers that is at least ``s``."""
    low, high = 0, len(arc)
    while low < high:
        middle = (low + high) // 2
        if arc[middle] < s:
            low = middle + 1
        else:
            high = middle
    return low


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
    marks, spans, corners = scratch.marks, scratch.spans, scratch.corners
    for i in range(count):
        plane = planes[int(boxes[i, BoxCol.KIND])]
        if plane < 0:
            continue
        x, y = boxes[i, BoxCol.X], boxes[i, BoxCol.Y]
        cos, sin = math.cos(boxes[i, BoxCol.YAW]), math.sin(boxes[i, BoxCol.YAW])
        half_length, half_width = 0.5 * boxes[i, BoxCol.LENGTH], 0.5 * boxes[i, BoxCol.WIDTH]
        ax, ay, bx, by = half_length * cos, half_length * sin, -half_width * sin, half_width * cos
        set_corner(corners, frame, 0, x + ax + bx, y + ay + by)
        set_corner(corners, frame, 1, x - ax + bx, y - ay + by)
        set_corner(corners, frame, 2, x - ax - bx, y - ay - by)
        set_corner(corners, frame, 3, x + ax - bx, y + ay - by)
        fill_corners(out, marks, spans, corners, plane)
        r, c = row_at(frame, x, y), column_at(frame, x, y)
        if 0.0 <= r < out.shape[1] and 0.0 <= c < out.shape[2]:
            out[plane, int(r), int(c)] = FULL
