"""Projection of a few places on lanes without machine code.

Each function returns exactly what its kernel in :mod:`~drivora_service.networks.projection` does,
thirty times slower, but at once, where the compiler would take a second to load.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, Int32Array
from drivora_service.networks.segment_index import CELL, LaneEnd, SegmentCol, SegmentIndex

HEADING_WEIGHT = 3.0
"""Metres by which a lane at a right angle to the desired heading counts as further away."""

HYSTERESIS = 0.3
"""Metres by which another lane must be nearer than the lane of the preceding point."""

OVERSHOOT = 1.0
"""Metres beyond a lane's ends that count as on it: where two lanes meet at an angle, the
outside of the bend is beyond both."""


class LanePlaceCol(IntEnum):
    """Columns of places on lanes."""

    S = 0
    """Arc length, metres."""
    LATERAL = 1
    """Metres from the centre line, positive to the left."""
    HEADING = 2
    """Of the lane, radians."""


LANE_PLACE_COLUMNS = len(LanePlaceCol)


class _Foot(NamedTuple):
    """The point of a lane that is nearest to a place.

    Attributes:
        squared: Square of its distance, m².
        segment: Number of its segment.
        along: Metres along the segment.
    """

    squared: float
    segment: int
    along: float


def lanes_near(
    index: SegmentIndex, x: float, y: float, radius: float
) -> tuple[Int32Array, FloatArray]:
    """Returns the lanes within ``radius``, and the place on each, columns ``LanePlaceCol``."""
    feet: dict[int, _Foot] = {}
    for i, lane, squared, along, length in _segments(index, x, y, radius):
        if squared > radius * radius:
            continue
        if lane not in feet or squared < feet[lane].squared:
            feet[lane] = _Foot(squared, i, min(max(along, 0.0), length))
    places = [_place(index, i, t, x, y) for _, i, t in feet.values()]
    found = np.array(places, dtype=np.float64).reshape(-1, LANE_PLACE_COLUMNS)
    return np.array([*feet], dtype=np.int32), found


def project(
    index: SegmentIndex, points: FloatArray, headings: FloatArray
) -> tuple[Int32Array, FloatArray]:
    """Returns the lane of each point, and the place on it, columns ``LanePlaceCol``."""
    chosen = np.full(len(points), -1, np.int32)
    places = np.full((len(points), LANE_PLACE_COLUMNS), np.nan)
    before = -1
    for p, ((x, y), heading) in enumerate(zip(points.tolist(), headings.tolist(), strict=True)):
        feet = _feet_within_width(index, x, y)
        best, best_cost = -1, math.inf
        for lane, (squared, i, _) in feet.items():
            cost = math.sqrt(squared)
            if not math.isnan(heading):
                ux = float(index.segments[i, SegmentCol.COS])
                uy = float(index.segments[i, SegmentCol.SIN])
                agreement = math.cos(heading) * ux + math.sin(heading) * uy
                cost += HEADING_WEIGHT * (1.0 - agreement)
            if lane == before:
                cost -= HYSTERESIS
            if cost < best_cost or (cost == best_cost and lane < best):
                best, best_cost = lane, cost
        before = best
        if best >= 0:
            chosen[p] = best
            _, i, t = feet[best]
            places[p] = _place(index, i, t, x, y)
    return chosen, places


def _feet_within_width(index: SegmentIndex, x: float, y: float) -> dict[int, _Foot]:
    """Returns the foot point on each lane that is no further away than half its width."""
    feet: dict[int, _Foot] = {}
    for i, lane, squared, along, length in _segments(index, x, y, float(index.half_widths.max())):
        half, ends = float(index.half_widths[lane]), int(index.ends[i])
        if squared > half * half:
            continue
        if ends & LaneEnd.FIRST and along < -OVERSHOOT:
            continue
        if ends & LaneEnd.LAST and along > length + OVERSHOOT:
            continue
        if lane not in feet or squared < feet[lane].squared:
            feet[lane] = _Foot(squared, i, min(max(along, 0.0), length))
    return feet


def _segments(
    index: SegmentIndex, x: float, y: float, radius: float
) -> Iterator[tuple[int, int, float, float, float]]:
    """Yields the segments around a place in the order of the kernels.

    Yields:
        Number, lane, squared distance, unclamped place of the foot point along it, length.
    """
    left, low = (float(value) for value in index.origin)
    c0, c1 = _cells(x - radius - left, x + radius - left, index.columns)
    r0, r1 = _cells(y - radius - low, y + radius - low, index.rows)
    if c0 > c1:
        return
    parts = []
    for row in range(r0, r1 + 1):
        first = index.cell_starts[row * index.columns + c0]
        parts.append(index.cell_items[first : index.cell_starts[row * index.columns + c1 + 1]])
    if not parts:
        return
    items = np.concatenate(parts)
    start_x, start_y, ux, uy, lengths, _ = index.segments[items].T
    dx, dy = x - start_x, y - start_y
    along = dx * ux + dy * uy
    t = np.minimum(np.maximum(along, 0.0), lengths)
    dx -= t * ux
    dy -= t * uy
    squared = dx * dx + dy * dy
    near = np.flatnonzero(squared <= radius * radius)
    chosen = items[near]
    yield from zip(
        chosen.tolist(),
        index.lanes[chosen].tolist(),
        squared[near].tolist(),
        along[near].tolist(),
        lengths[near].tolist(),
        strict=True,
    )


def _cells(low: float, high: float, count: int) -> tuple[int, int]:
    """Returns the first and the last of ``count`` cells that a range of metres touches."""
    return max(math.floor(low / CELL), 0), min(math.floor(high / CELL), count - 1)


def _place(index: SegmentIndex, i: int, t: float, x: float, y: float) -> tuple[float, float, float]:
    """Returns the place of a foot point, columns ``LanePlaceCol``."""
    start_x, start_y, ux, uy, _, arc = index.segments[i].tolist()
    dx, dy = x - start_x, y - start_y
    side = ux * dy - uy * dx
    # Not math.hypot, which rounds otherwise than the C library, which kernels use.
    distance = float(np.hypot(dx - t * ux, dy - t * uy))
    return arc + t, distance if side >= 0.0 else -distance, math.atan2(uy, ux)
