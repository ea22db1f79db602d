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
from drivora_service.observations.trace import Col

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
        area_turns: (n,) number of the image in which each area was drawn last.
        line_turns: (m,) the same of lines.
    """

    marks: ByteArray
    spans: Int32Array
    area_turns: IntArray
    line_turns: IntArray


@compiled
def frame_of(ego: FloatArray, scale: float, row: float, column: float) -> Frame:
    """Returns the frame of an image around an ego.

    Args:
        ego: (9,) the ego's state, columns ``Col``.
        scale: Pixels a metre.
        row: Of the ego's centre in the image.
        column: Of the ego's centre in the image.
    """
    return Frame(
        ego[Col.X], ego[Col.Y], ego[Col.Z], math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW]),
        scale, row, column,
    )  # fmt: skip


@compiled
def row_at(frame: Frame, x: float, y: float) -> float:
    """Returns the row of a place, in pixels from the upper edge."""
    return frame.row - frame.scale * ((x - frame.x) * frame.cos + (y - frame.y) * frame.sin)


@compiled
def column_at(frame: Frame, x: float, y: float) -> float:
    """Returns the column of a place, in pixels from the left edge."""
    return frame.column - frame.scale * ((y - frame.y) * frame.cos - (x - frame.x) * frame.sin)


@compiled
def mark_edge(scratch: Scratch, r0: float, c0: float, r1: float, c1: float) -> None:
    """Marks where an edge between two places crosses the middles of rows.

    The result does not depend on the edge's direction.
    """
    if r0 == r1:
        return
    if r0 > r1:
        r0, c0, r1, c1 = r1, c1, r0, c0
    marks, spans = scratch.marks, scratch.spans
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
    out: ByteArray, scratch: Scratch, low: float, high: float, plane: int, limits: int, limit: int
) -> None:
    """Fills what is inside of the marked edges, and removes the marks.

    Args:
        out: (channels, height, width).
        scratch: With the marks.
        low: Least row of the edges' ends.
        high: Greatest row.
        plane: Channel that is set; -1: none.
        limits: Channel that is raised to ``limit``; -1: none.
        limit: Speed limit as a value of the channel.
    """
    marks, spans = scratch.marks, scratch.spans
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
def fill_quad(
    out: ByteArray,
    scratch: Scratch,
    plane: int,
    r0: float,
    c0: float,
    r1: float,
    c1: float,
    r2: float,
    c2: float,
    r3: float,
    c3: float,
) -> None:
    """Sets the pixels of a quadrangle in one channel."""
    mark_edge(scratch, r0, c0, r1, c1)
    mark_edge(scratch, r1, c1, r2, c2)
    mark_edge(scratch, r2, c2, r3, c3)
    mark_edge(scratch, r3, c3, r0, c0)
    low, high = min(min(r0, r1), min(r2, r3)), max(max(r0, r1), max(r2, r3))
    fill_marked(out, scratch, low, high, plane, -1, 0)


@compiled
def fill_line(out: ByteArray, scratch: Scratch, frame: Frame, plane: int, ends: FloatArray) -> None:
    """Sets the pixels of a line, (4,) x and y of both ends, in one channel."""
    r0, c0 = row_at(frame, ends[0], ends[1]), column_at(frame, ends[0], ends[1])
    r1, c1 = row_at(frame, ends[2], ends[3]), column_at(frame, ends[2], ends[3])
    length = math.hypot(r1 - r0, c1 - c0)
    if length == 0.0:
        return
    half = max(0.5 * LINE_WIDTH * frame.scale, 0.5)
    dr, dc = -half * (c1 - c0) / length, half * (r1 - r0) / length
    fill_quad(
        out, scratch, plane,
        r0 + dr, c0 + dc, r1 + dr, c1 + dc, r1 - dr, c1 - dc, r0 - dr, c0 - dc,
    )  # fmt: skip
