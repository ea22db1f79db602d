"""The compiled choice of the actors that are held in a step; see ``holding``.

SI units, radians, box centres, but placements are of front bumpers.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.simulation.traffic.lane_cores import LATERAL

HELD = -1.0
"""What stands in the placement of a held row, in place of whether it moved."""
_AGAIN = 1.15
"""The share of the reach from which on an actor is held that was not."""
_BEHIND = 2.0
"""Metres of a lane behind a vehicle that is held."""
_WAITING = 0.6
"""The share of the reach up to which a driver at a junction may heed the vehicles that arrive."""
_BESIDE = 8.0
"""Metres from the centre line of a lane within which a vehicle may be on it or on one beside it."""
_AGAINST = -0.5
"""Cosine of the angle to a lane below which a vehicle drives on one of the other direction."""
_ASKED_AGAIN = 5
"""Steps after which it is asked again which lane a far actor is on."""


@compiled
def hold(
    step: int,
    reach: float,
    frame: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    drives: BoolArray,
    may: BoolArray,
    placements: FloatArray,
    points: FloatArray,
    first: IntArray,
    begin: FloatArray,
    end: FloatArray,
    boxes: FloatArray,
    entries: FloatArray,
    on_way: BoolArray,
    lane: IntArray,
    cursor: IntArray,
    is_held: BoolArray,
    spots: FloatArray,
    next_ask: IntArray,
    asked: IntArray,
) -> int:
    """Marks the placements of the rows that are held in a frame.

    Args:
        step, frame, present, sizes, drives, may, placements: As of ``Holding.choose``.
        reach: Metres from what SUMO drives up to which rows are placed.
        points, first, begin, end, boxes: As of ``LaneCores``.
        entries: (N, 3) x, y and heading with which rows will enter that SUMO drives; NaN where
            none will.
        on_way: (N, L) lanes of the way of each row that SUMO drives.
        lane: (N,) lane of each row; -1 where not known. Forgotten where it is not held.
        cursor: (N,) segment of that lane on which it was found last.
        is_held: (N,) rows that were held in the frame before; updated.
        spots: (N, 2) where held rows are in SUMO, metres; updated.
        next_ask: (N,) first step in which the lane may be asked for.
        asked: (N,) filled: rows whose lane is needed.

    Returns:
        The number of filled rows of ``asked``.
    """
    count = 0
    rows = may.shape[0]
    for i in range(rows):
        if drives[i] and present[i]:
            entries[i, 0] = np.nan
    for j in range(rows):
        was_held, known = is_held[j], lane[j]
        is_held[j], lane[j] = False, -1
        if (
            not (may[j] and present[j])
            or placements[j, 3] == 0.0
            or (known < 0 and step < next_ask[j])
        ):
            continue
        x, y = placements[j, 0], placements[j, 1]
        near = reach if was_held else reach * _AGAIN
        if _is_near(x, y, near, frame, present, drives, entries):
            continue
        if was_held and _is_near(spots[j, 0], spots[j, 1], near, frame, present, drives, entries):
            continue
        if known >= 0 and _is_watched(
            known, near, frame, present, drives, entries, on_way, points, first, boxes
        ):
            continue
        if known < 0:
            asked[count] = j
            count += 1
            next_ask[j] = step + _ASKED_AGAIN
            continue
        s = _along(x, y, known, points, first, cursor, j)
        # With a part of it on the lane before, it would be on that, too.
        if max(begin[known], sizes[j, 0] + _BEHIND) <= s <= end[known]:
            is_held[j], lane[j] = True, known
            if not was_held:
                spots[j, 0], spots[j, 1] = frame[j, 0], frame[j, 1]
            placements[j, 3] = HELD
    return count


@compiled
def _is_near(
    x: float,
    y: float,
    near: float,
    frame: FloatArray,
    present: BoolArray,
    drives: BoolArray,
    entries: FloatArray,
) -> bool:
    """Returns whether a place is within ``near`` metres of what SUMO drives, or will."""
    for i in range(drives.shape[0]):
        if not drives[i]:
            continue
        if present[i]:
            dx, dy = frame[i, 0] - x, frame[i, 1] - y
            if dx * dx + dy * dy <= near * near:
                return True
        if not math.isnan(entries[i, 0]):
            dx, dy = entries[i, 0] - x, entries[i, 1] - y
            if dx * dx + dy * dy <= near * near:
                return True
    return False


@compiled
def _is_watched(
    lane: int,
    near: float,
    frame: FloatArray,
    present: BoolArray,
    drives: BoolArray,
    entries: FloatArray,
    on_way: BoolArray,
    points: FloatArray,
    first: IntArray,
    boxes: FloatArray,
) -> bool:
    """Returns whether what SUMO drives may see a vehicle anywhere on a lane.

    A driver is told of the next vehicle on its lane and on those that it looks into, wherever it is
    on them; and at a junction of when vehicles arrive there, wherever they are on the lane before.
    """
    end = first[lane + 1] - 1
    for i in range(drives.shape[0]):
        if not drives[i]:
            continue
        for pose, counts in ((frame[i], present[i]), (entries[i], not math.isnan(entries[i, 0]))):
            if not counts:
                continue
            if math.hypot(points[end, 0] - pose[0], points[end, 1] - pose[1]) <= _WAITING * near:
                return True
            if on_way[i, lane] and _sees(pose, lane, near, points, first, boxes):
                return True
    return False


@compiled
def _sees(
    pose: FloatArray,
    lane: int,
    near: float,
    points: FloatArray,
    first: IntArray,
    boxes: FloatArray,
) -> bool:
    """Returns whether a pose is ``near`` metres from the begin of a lane, or on it or beside it."""
    x, y = pose[0], pose[1]
    begin = first[lane]
    if math.hypot(points[begin, 0] - x, points[begin, 1] - y) <= near:
        return True
    if not (
        boxes[lane, 0] - _BESIDE <= x <= boxes[lane, 1] + _BESIDE
        and boxes[lane, 2] - _BESIDE <= y <= boxes[lane, 3] + _BESIDE
    ):
        return False
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    for i in range(begin, first[lane + 1] - 1):
        dx, dy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
        length = math.hypot(dx, dy)
        if dx * cos + dy * sin < _AGAINST * length:
            continue
        t = 0.0
        if length > 0.0:
            t = ((x - points[i, 0]) * dx + (y - points[i, 1]) * dy) / (length * length)
        t = min(max(t, 0.0), 1.0)
        if math.hypot(points[i, 0] + t * dx - x, points[i, 1] + t * dy - y) <= _BESIDE:
            return True
    return False


@compiled
def _along(
    x: float,
    y: float,
    lane: int,
    points: FloatArray,
    first: IntArray,
    cursor: IntArray,
    j: int,
) -> float:
    """Returns the arc length of a place on a lane; NaN if it is not ``LATERAL`` near to it."""
    last = first[lane + 1] - 1
    for i in range(first[lane] + cursor[j], last):
        dx, dy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
        squared = dx * dx + dy * dy
        t = 0.0
        if squared > 0.0:
            t = ((x - points[i, 0]) * dx + (y - points[i, 1]) * dy) / squared
        t = min(max(t, 0.0), 1.0)
        across = math.hypot(points[i, 0] + t * dx - x, points[i, 1] + t * dy - y)
        if across <= LATERAL:
            cursor[j] = i - first[lane]
            return float(points[i, 2] + t * (points[i + 1, 2] - points[i, 2]))
    return math.nan
