"""Filling polygons in a bird's-eye raster.

A pixel belongs to a polygon if its centre does. In each row of pixels, an edge that crosses the
row's middle toggles "inside" from the first centre at or beyond the crossing on (even-odd rule,
half-open), so that polygons which share an edge leave no gap. Crossings are marked in a scratch
image, then each row is passed once between its first and its last mark.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import ByteArray, FloatArray, Int32Array, IntArray

FULL = 255
LINE_WIDTH = 0.15
"""Width of lines in metres; at least a pixel, so that they have no holes."""


class Frame(NamedTuple):
    """The image's place in the plane.

    Attributes:
        x: Of the ego's centre, metres.
        y: Metres.
        z: Height, metres.
        cos: Of its heading.
        sin: Of its heading.
        scale: Pixels a metre.
        row: Of the ego's centre; pixels from the upper edge.
        column: Pixels from the left edge.
    """

    x: float
    y: float
    z: float
    cos: float
    sin: float
    scale: float
    row: float
    column: float


class Scratch(NamedTuple):
    """Memory of a raster; between two polygons all marks are 0 and all spans empty.

    Attributes:
        marks: (height, width + 1) 1 where "inside" changes.
        spans: (height, 2) first and last column with a mark; (width + 1, -1) without one.
        corners: (4, 2) row and column of the corners of a quadrangle.
        area_turns: (n,) number of the image in which each area was drawn last.
        line_turns: (m,) the same of lines.
    """

    marks: ByteArray
    spans: Int32Array
    corners: FloatArray
    area_turns: IntArray
    line_turns: IntArray


@compiled
def row_at(frame: Frame, x: float, y: float) -> float:
    """Returns the row of a place, in pixels from the upper edge."""
    return frame.row - frame.scale * ((x - frame.x) * frame.cos + (y - frame.y) * frame.sin)


@compiled
def column_at(frame: Frame, x: float, y: float) -> float:
    """Returns the column of a place, in pixels from the left edge."""
    return frame.column - frame.scale * ((y - frame.y) * frame.cos - (x - frame.x) * frame.sin)


@compiled
def mark_edge(
    marks: ByteArray, spans: Int32Array, r0: float, c0: float, r1: float, c1: float
) -> None:
    """Marks where an edge between two places crosses the middles of rows.

    The result does not depend on the edge's direction.

    Args:
        marks: As in ``Scratch``.
        spans: As in ``Scratch``.
        r0: Row of one end, in pixels.
        c0: Its column.
        r1: Row of the other end.
        c1: Its column.
    """
    if r0 == r1:
        return
    if r0 > r1:
        r0, c0, r1, c1 = r1, c1, r0, c0
    height, width = marks.shape[0], marks.shape[1] - 1
    if r1 <= 0.0 or r0 >= height:
        return
    first, end = max(math.ceil(r0 - 0.5), 0), min(math.ceil(r1 - 0.5), height)
    slope = (c1 - c0) / (r1 - r0)
    for r in range(first, end):
        crossing = c0 + (r + 0.5 - r0) * slope
        # Bounded before it becomes a whole number, as far places may be anywhere.
        k = math.ceil(min(max(crossing - 0.5, 0.0), float(width)))
        marks[r, k] ^= 1
        if k < spans[r, 0]:
            spans[r, 0] = k
        if k > spans[r, 1]:
            spans[r, 1] = k


@compiled
def fill_marked(
    out: ByteArray,
    marks: ByteArray,
    spans: Int32Array,
    low: float,
    high: float,
    plane: int,
    limits: int,
    limit: int,
) -> None:
    """Fills what is inside of the marked edges, and removes the marks.

    Args:
        out: (channels, height, width).
        marks: As in ``Scratch``.
        spans: As in ``Scratch``.
        low: Least row of the edges' ends.
        high: Greatest row.
        plane: Channel that is set; -1: none.
        limits: Channel that is raised to ``limit``; -1: none.
        limit: Speed limit as a value of the channel.
    """
    height, width = marks.shape[0], marks.shape[1] - 1
    if high <= 0.0 or low >= height:
        return
    for r in range(max(math.ceil(low - 0.5), 0), min(math.ceil(high - 0.5), height)):
        inside = 0
        for c in range(spans[r, 0], min(spans[r, 1] + 1, width)):
            inside ^= marks[r, c]
            marks[r, c] = 0
            if inside:
                if plane >= 0:
                    out[plane, r, c] = FULL
                if limits >= 0 and out[limits, r, c] < limit:
                    out[limits, r, c] = limit
        marks[r, width] = 0
        spans[r, 0], spans[r, 1] = width + 1, -1


@compiled
def fill_corners(
    out: ByteArray, marks: ByteArray, spans: Int32Array, corners: FloatArray, plane: int
) -> None:
    """Sets the pixels of a quadrangle, (4, 2) rows and columns, in one channel."""
    low, high = corners[3, 0], corners[3, 0]
    # One place of call: the compiler copies what it calls.
    for k in range(4):
        r, c, before = corners[k, 0], corners[k, 1], (k + 3) % 4
        mark_edge(marks, spans, corners[before, 0], corners[before, 1], r, c)
        low, high = min(low, r), max(high, r)
    fill_marked(out, marks, spans, low, high, plane, -1, 0)


@compiled
def set_corner(corners: FloatArray, frame: Frame, k: int, x: float, y: float) -> None:
    """Sets the corner ``k`` of a quadrangle to a place in the plane, metres."""
    corners[k, 0] = row_at(frame, x, y)
    corners[k, 1] = column_at(frame, x, y)


@compiled
def set_line(corners: FloatArray, frame: Frame, lines: FloatArray, i: int) -> bool:
    """Sets the corners of a quadrangle to the borders of a line.

    Args:
        corners: (4, 2) filled.
        frame: The image's place.
        lines: (n, 4) x and y of both ends.
        i: Which of them.

    Returns:
        Whether it has a length.
    """
    r0, c0 = row_at(frame, lines[i, 0], lines[i, 1]), column_at(frame, lines[i, 0], lines[i, 1])
    r1, c1 = row_at(frame, lines[i, 2], lines[i, 3]), column_at(frame, lines[i, 2], lines[i, 3])
    length = math.hypot(r1 - r0, c1 - c0)
    if length == 0.0:
        return False
    half = max(0.5 * LINE_WIDTH * frame.scale, 0.5)
    dr, dc = -half * (c1 - c0) / length, half * (r1 - r0) / length
    corners[0, 0], corners[0, 1] = r0 + dr, c0 + dc
    corners[1, 0], corners[1, 1] = r1 + dr, c1 + dc
    corners[2, 0], corners[2, 1] = r1 - dr, c1 - dc
    corners[3, 0], corners[3, 1] = r0 - dr, c0 - dc
    return True
