"""Lanes that a box on the road reaches into, with the stretches along them.

Frame: the network's plane, metres, radians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, Int32Array
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.segment_index import CELL, SegmentCol, segment_index
from drivora_service.observations.trace import LEVEL_GAP

REACH = 0.2
"""Metres that a box may reach across a lane's edge without being in the lane."""

_MOST_LANES = 32
_MOST_CORNERS = 12


class Box(NamedTuple):
    """A box on the road: its centre, heading and size."""

    x: float
    y: float
    yaw: float
    length: float
    width: float


class _FoundCol(IntEnum):
    """Columns of stretches that ``_lanes_under`` finds, as of ``Overlap``."""

    LANE = 0
    BEGIN = 1
    END = 2
    HEADING = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlap:
    """A stretch of a lane under a box.

    Attributes:
        lane: Index of the lane.
        begin: Arc length on its centre line, metres.
        end: Arc length of the end, greater than ``begin``.
        heading: Direction of the lane there, radians.
    """

    lane: int
    begin: float
    end: float
    heading: float


def lanes_under(network: RoadNetwork, box: Box, height: float) -> tuple[Overlap, ...]:
    """Finds the drivable lanes into which a box reaches by more than ``REACH``.

    Args:
        network: The network.
        box: The box.
        height: Height in metres, which distinguishes the levels of a bridge.

    Returns:
        One stretch for each lane, in order of lane indices.
    """
    index = segment_index(network, True)
    found = np.empty((_MOST_LANES, len(_FoundCol)))
    count = _lanes_under(
        index.segments, index.lanes, index.origin, index.columns, index.rows, index.cell_starts,
        index.cell_items, index.half_widths, box, found,
    )  # fmt: skip
    overlaps = []
    for lane_index, begin, end, heading in sorted(found[:count].tolist()):
        lane = network.lanes[int(lane_index)]
        if abs(float(np.interp(begin, lane.arc, lane.heights)) - height) <= LEVEL_GAP:
            overlaps.append(Overlap(lane=int(lane_index), begin=begin, end=end, heading=heading))
    return tuple(overlaps)


@compiled
def _cut(
    corners: FloatArray, count: int, axis: int, sign: float, bound: float, out: FloatArray
) -> int:
    """Clips a convex polygon to the part where ``sign * coordinate <= sign * bound``."""
    kept = 0
    for i in range(count):
        j = (i + 1) % count
        here = sign * (corners[i, axis] - bound)
        there = sign * (corners[j, axis] - bound)
        if here <= 0.0:
            out[kept, 0], out[kept, 1] = corners[i, 0], corners[i, 1]
            kept += 1
        if (here < 0.0 < there) or (there < 0.0 < here):
            share = here / (here - there)
            out[kept, 0] = corners[i, 0] + share * (corners[j, 0] - corners[i, 0])
            out[kept, 1] = corners[i, 1] + share * (corners[j, 1] - corners[i, 1])
            kept += 1
    return kept


@compiled
def _lanes_under(
    segments: FloatArray,
    lanes: Int32Array,
    origin: FloatArray,
    columns: int,
    rows: int,
    cell_starts: Int32Array,
    cell_items: Int32Array,
    half_widths: FloatArray,
    box: Box,
    found: FloatArray,
) -> int:
    """Fills ``found``, columns ``_FoundCol``; returns the number of rows.

    The box is clipped in the frame of each segment of a centre line: first to the span of the
    segment, which gives how far the part beside it reaches across the lane's edges; then to the
    width of the lane, which gives the stretch along it.
    """
    x, y, yaw, length, width = box
    count = 0
    cos, sin = math.cos(yaw), math.sin(yaw)
    radius = 0.5 * math.hypot(length, width) + half_widths.max()
    c0 = min(max(int((x - radius - origin[0]) // CELL), 0), columns)
    c1 = min(int((x + radius - origin[0]) // CELL), columns - 1)
    r0 = min(max(int((y - radius - origin[1]) // CELL), 0), rows)
    r1 = min(int((y + radius - origin[1]) // CELL), rows - 1)
    corner, one, two = np.empty((4, 2)), np.empty((_MOST_CORNERS, 2)), np.empty((_MOST_CORNERS, 2))
    for row in range(r0, r1 + 1):
        for cell in range(row * columns + c0, row * columns + c1 + 1):
            for item in range(cell_starts[cell], cell_starts[cell + 1]):
                i = cell_items[item]
                half = half_widths[lanes[i]]
                ux, uy = segments[i, SegmentCol.COS], segments[i, SegmentCol.SIN]
                span, arc = segments[i, SegmentCol.LENGTH], segments[i, SegmentCol.ARC]
                dx, dy = x - segments[i, SegmentCol.X], y - segments[i, SegmentCol.Y]
                for k in range(4):
                    ahead = 0.5 * length if k < 2 else -0.5 * length
                    left = 0.5 * width if k in (0, 3) else -0.5 * width
                    cx, cy = dx + ahead * cos - left * sin, dy + ahead * sin + left * cos
                    corner[k, 0], corner[k, 1] = cx * ux + cy * uy, ux * cy - uy * cx
                corners = _cut(corner, 4, 0, -1.0, 0.0, one)
                corners = _cut(one, corners, 0, 1.0, span, two)
                if corners < 3:
                    continue
                low, high = two[:corners, 1].min(), two[:corners, 1].max()
                if min(high + half, half - low) <= REACH:
                    continue
                corners = _cut(two, corners, 1, -1.0, -half, one)
                corners = _cut(one, corners, 1, 1.0, half, two)
                if corners < 3:
                    continue
                begin = arc + two[:corners, 0].min()
                end = arc + two[:corners, 0].max()
                j = 0
                while j < count and found[j, _FoundCol.LANE] != lanes[i]:
                    j += 1
                if j < count:
                    found[j, _FoundCol.BEGIN] = min(found[j, _FoundCol.BEGIN], begin)
                    found[j, _FoundCol.END] = max(found[j, _FoundCol.END], end)
                elif count < found.shape[0]:
                    found[j, _FoundCol.LANE] = lanes[i]
                    found[j, _FoundCol.BEGIN], found[j, _FoundCol.END] = begin, end
                    found[j, _FoundCol.HEADING] = math.atan2(uy, ux)
                    count += 1
    return count
