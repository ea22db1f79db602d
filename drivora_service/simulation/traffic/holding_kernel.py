"""The compiled choice of the actors that are held in a step; see ``holding``.

SI units, radians, box centres, but placements are of front bumpers.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.observations.trace import Col, SizeCol
from drivora_service.simulation.motion.step_kernels import PlacementCol
from drivora_service.simulation.traffic.lane_cores import (
    LATERAL,
    LaneBox,
    LaneCores,
    LinePoint,
)
from drivora_service.simulation.world import WorldFrames

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


class EntryCol(IntEnum):
    """Columns of ``Drivers.entries``: a pose, NaN where a row will not enter."""

    X = 0
    Y = 1
    YAW = 2


class Spot(IntEnum):
    """Columns of ``HeldRows.spots``."""

    X = 0
    Y = 1


class Drivers(NamedTuple):
    """What SUMO drives, or will.

    Attributes:
        drives: (N,) rows that SUMO drives, or will.
        entries: (N, 3) where rows will enter that SUMO drives, columns ``EntryCol``.
        on_way: (N, L) lanes of the way of each row that SUMO drives.
    """

    drives: BoolArray
    entries: FloatArray
    on_way: BoolArray


class HeldRows(NamedTuple):
    """What is remembered of each row from frame to frame.

    Attributes:
        lane: (N,) lane; -1 where not known. Forgotten where the row is not held.
        cursor: (N,) segment of that lane on which the row was found last.
        is_held: (N,) rows that were held in the frame before.
        spots: (N, 2) where held rows are in SUMO, metres, columns ``Spot``.
        next_ask: (N,) first step in which the lane may be asked for.
        asked: (N,) rows whose lane is needed.
    """

    lane: IntArray
    cursor: IntArray
    is_held: BoolArray
    spots: FloatArray
    next_ask: IntArray
    asked: IntArray


@compiled
def hold(
    step: int,
    reach: float,
    frames: WorldFrames,
    may: BoolArray,
    placements: FloatArray,
    lanes: LaneCores,
    drivers: Drivers,
    rows: HeldRows,
) -> int:
    """Marks the placements of the rows that are held in a frame.

    Args:
        step, frames, may, placements: As of ``Holding.choose``.
        reach: Metres from what SUMO drives up to which rows are placed.
        lanes: The lanes of the network.
        drivers: Entries are forgotten of rows that have entered.
        rows: Updated; rows whose lane is needed are filled in.

    Returns:
        The number of filled rows of ``asked``.
    """
    frame, present, sizes = frames.states[step - 1], frames.present[step - 1], frames.sizes
    lane, cursor, is_held, spots = rows.lane, rows.cursor, rows.is_held, rows.spots
    begin, end = lanes.begin, lanes.end
    count = 0
    for i in range(may.shape[0]):
        if drivers.drives[i] and present[i]:
            drivers.entries[i, EntryCol.X] = np.nan
    for j in range(may.shape[0]):
        was_held, known = is_held[j], lane[j]
        is_held[j], lane[j] = False, -1
        if (
            not (may[j] and present[j])
            or placements[j, PlacementCol.MOVED] == 0.0
            or (known < 0 and step < rows.next_ask[j])
        ):
            continue
        x, y = placements[j, PlacementCol.X], placements[j, PlacementCol.Y]
        near = reach if was_held else reach * _AGAIN
        if _is_near(x, y, near, frame, present, drivers):
            continue
        # SUMO still has a held row at its spot, and has it move from there when it is placed.
        if was_held and _is_near(spots[j, Spot.X], spots[j, Spot.Y], near, frame, present, drivers):
            continue
        if known >= 0 and _is_watched(known, near, frame, present, drivers, lanes):
            continue
        if known < 0:
            rows.asked[count] = j
            count += 1
            rows.next_ask[j] = step + _ASKED_AGAIN
            continue
        s = _along(x, y, known, lanes, cursor, j)
        # With a part of it on the lane before, it would be on that, too.
        if max(begin[known], sizes[j, SizeCol.LENGTH] + _BEHIND) <= s <= end[known]:
            is_held[j], lane[j] = True, known
            if not was_held:
                spots[j, Spot.X], spots[j, Spot.Y] = frame[j, Col.X], frame[j, Col.Y]
            placements[j, PlacementCol.MOVED] = HELD
    return count


@compiled
def _is_near(
    x: float,
    y: float,
    near: float,
    frame: FloatArray,
    present: BoolArray,
    drivers: Drivers,
) -> bool:
    """Returns whether a place is within ``near`` metres of what SUMO drives, or will."""
    drives, entries = drivers.drives, drivers.entries
    for i in range(drives.shape[0]):
        if not drives[i]:
            continue
        if present[i]:
            dx, dy = frame[i, Col.X] - x, frame[i, Col.Y] - y
            if dx * dx + dy * dy <= near * near:
                return True
        if not math.isnan(entries[i, EntryCol.X]):
            dx, dy = entries[i, EntryCol.X] - x, entries[i, EntryCol.Y] - y
            if dx * dx + dy * dy <= near * near:
                return True
    return False


@compiled
def _is_watched(
    lane: int,
    near: float,
    frame: FloatArray,
    present: BoolArray,
    drivers: Drivers,
    lanes: LaneCores,
) -> bool:
    """Returns whether what SUMO drives may see a vehicle anywhere on a lane.

    A driver is told of the next vehicle on its lane and on those that it looks into, wherever it is
    on them; and at a junction of when vehicles arrive there, wherever they are on the lane before.
    """
    drives, entries = drivers.drives, drivers.entries
    last = lanes.points[lanes.first[lane + 1] - 1]
    for i in range(drives.shape[0]):
        if not drives[i]:
            continue
        # The columns of an entry are the first ones of a state.
        for pose, counts in (
            (frame[i], present[i]),
            (entries[i], not math.isnan(entries[i, EntryCol.X])),
        ):
            if not counts:
                continue
            dx, dy = last[LinePoint.X] - pose[Col.X], last[LinePoint.Y] - pose[Col.Y]
            if math.hypot(dx, dy) <= _WAITING * near:
                return True
            if drivers.on_way[i, lane] and _sees(pose, lane, near, lanes):
                return True
    return False


@compiled
def _sees(pose: FloatArray, lane: int, near: float, lanes: LaneCores) -> bool:
    """Returns whether a pose is ``near`` metres from the begin of a lane, or on it or beside it."""
    points, first, box = lanes.points, lanes.first, lanes.boxes[lane]
    x, y = pose[Col.X], pose[Col.Y]
    begin = first[lane]
    if math.hypot(points[begin, LinePoint.X] - x, points[begin, LinePoint.Y] - y) <= near:
        return True
    if not (
        box[LaneBox.MIN_X] - _BESIDE <= x <= box[LaneBox.MAX_X] + _BESIDE
        and box[LaneBox.MIN_Y] - _BESIDE <= y <= box[LaneBox.MAX_Y] + _BESIDE
    ):
        return False
    cos, sin = math.cos(pose[Col.YAW]), math.sin(pose[Col.YAW])
    for i in range(begin, first[lane + 1] - 1):
        x0, y0 = points[i, LinePoint.X], points[i, LinePoint.Y]
        dx, dy = points[i + 1, LinePoint.X] - x0, points[i + 1, LinePoint.Y] - y0
        length = math.hypot(dx, dy)
        if dx * cos + dy * sin < _AGAINST * length:
            continue
        t = 0.0
        if length > 0.0:
            t = ((x - x0) * dx + (y - y0) * dy) / (length * length)
        t = min(max(t, 0.0), 1.0)
        if math.hypot(x0 + t * dx - x, y0 + t * dy - y) <= _BESIDE:
            return True
    return False


@compiled
def _along(x: float, y: float, lane: int, lanes: LaneCores, cursor: IntArray, j: int) -> float:
    """Returns the arc length of a place on a lane; NaN if it is not ``LATERAL`` near to it."""
    points, first = lanes.points, lanes.first
    last = first[lane + 1] - 1
    for i in range(first[lane] + cursor[j], last):
        x0, y0 = points[i, LinePoint.X], points[i, LinePoint.Y]
        dx, dy = points[i + 1, LinePoint.X] - x0, points[i + 1, LinePoint.Y] - y0
        squared = dx * dx + dy * dy
        t = 0.0
        if squared > 0.0:
            t = ((x - x0) * dx + (y - y0) * dy) / squared
        t = min(max(t, 0.0), 1.0)
        across = math.hypot(x0 + t * dx - x, y0 + t * dy - y)
        if across <= LATERAL:
            cursor[j] = i - first[lane]
            s0, s1 = points[i, LinePoint.ARC], points[i + 1, LinePoint.ARC]
            return float(s0 + t * (s1 - s0))
    return math.nan
