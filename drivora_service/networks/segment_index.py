"""The centre lines of a network's lanes as short segments in a grid, for spatial search."""

from __future__ import annotations

from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import FloatArray, Int32Array
from drivora_service.networks.road_network import Lane, RoadNetwork

CELL = 10.0
"""Side of a cell and maximum length of a segment, metres, so that a segment is in few cells."""


class SegmentCol(IntEnum):
    """Columns of segments; metres."""

    X = 0
    """Of its start."""
    Y = 1
    COS = 2
    """Of its direction."""
    SIN = 3
    LENGTH = 4
    ARC = 5
    """Arc length of its start on its lane."""


class LaneEnd(IntEnum):
    """Bits of ``SegmentIndex.ends``."""

    FIRST = 1
    """The segment is the first of its lane."""
    LAST = 2
    """It is the last of its lane."""


class SegmentIndex(NamedTuple):
    """Segments, and the segments in each cell.

    Attributes:
        segments: (m, 6), columns ``SegmentCol``.
        lanes: (m,) index of each segment's lane.
        ends: (m,) bits of ``LaneEnd``.
        half_widths: (lanes,) metres, by lane index.
        origin: (2,) lower left corner of the grid, metres.
        columns: Cells from west to east.
        rows: Cells from south to north.
        cell_starts: (cells + 1,) begin of each cell's segments in ``cell_items``.
        cell_items: Segment numbers, cell by cell, row by row.
    """

    segments: FloatArray
    lanes: Int32Array
    ends: NDArray[np.uint8]
    half_widths: FloatArray
    origin: FloatArray
    columns: int
    rows: int
    cell_starts: Int32Array
    cell_items: Int32Array


@lru_cache(maxsize=128)
def segment_index(network: RoadNetwork, drivable_only: bool) -> SegmentIndex:
    """Returns the index of a network's lanes, built on the first call for this network object."""
    chosen = [lane for lane in network.lanes if lane.drivable or not drivable_only]
    parts = [_lane_segments(lane) for lane in chosen]
    counts = [len(part) for part in parts]
    segments = np.concatenate(parts)
    last = np.cumsum(counts) - 1
    ends = np.zeros(len(segments), dtype=np.uint8)
    ends[last - counts + 1] |= np.uint8(LaneEnd.FIRST)
    ends[last] |= np.uint8(LaneEnd.LAST)

    starts = segments[:, [SegmentCol.X, SegmentCol.Y]]
    directions = segments[:, [SegmentCol.COS, SegmentCol.SIN]]
    stops = starts + directions * segments[:, [SegmentCol.LENGTH]]
    low, high = np.minimum(starts, stops), np.maximum(starts, stops)
    origin = low.min(axis=0) - 1.0
    first = ((low - origin) // CELL).astype(np.int64)
    final = ((high - origin) // CELL).astype(np.int64)
    columns, rows = (int(v) + 1 for v in final.max(axis=0))
    cells: list[NDArray[np.int64]] = []
    members: list[NDArray[np.int64]] = []
    # A segment is no longer than a cell: its box touches at most two columns and two rows.
    for step_x in (0, 1):
        for step_y in (0, 1):
            touched = np.nonzero(
                (first[:, 0] + step_x <= final[:, 0]) & (first[:, 1] + step_y <= final[:, 1])
            )[0]
            column, row = first[touched, 0] + step_x, first[touched, 1] + step_y
            cells.append(row * columns + column)
            members.append(touched)
    cell, member = np.concatenate(cells), np.concatenate(members)
    order = np.lexsort((member, cell))
    return SegmentIndex(
        segments=segments,
        lanes=np.repeat(np.array([lane.index for lane in chosen]), counts).astype(np.int32),
        ends=ends,
        half_widths=np.array([0.5 * lane.width for lane in network.lanes]),
        origin=origin,
        columns=columns,
        rows=rows,
        cell_starts=np.searchsorted(cell[order], np.arange(columns * rows + 1)).astype(np.int32),
        cell_items=member[order].astype(np.int32),
    )


def _lane_segments(lane: Lane) -> FloatArray:
    """Returns the (m, 6) segments of a lane, none longer than a cell."""
    steps = np.diff(lane.shape, axis=0)
    lengths = np.diff(lane.arc)
    pieces = np.maximum(np.ceil(lengths / CELL).astype(np.int64), 1)
    row = np.repeat(np.arange(len(steps)), pieces)
    nth = np.arange(len(row)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    length = lengths[row] / pieces[row]
    direction = steps[row] / lengths[row, None]
    offset = nth * length
    start = lane.shape[row] + direction * offset[:, None]
    return np.column_stack((start, direction, length, lane.arc[row] + offset))
