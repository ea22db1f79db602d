"""The stretches of a network's lanes on which no other lane is as near to a vehicle as its own."""

from __future__ import annotations

from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.road_network import Lane, RoadNetwork

LATERAL = 0.8
"""Metres from the centre line of its lane up to which a vehicle counts as on its core."""
_SPACING = 1.0
"""Metres between the places of a lane that are compared with other lanes."""
_CLEAR = 2.0 * LATERAL + _SPACING
"""Metres from a place on a core to every other lane, at least: then a vehicle ``LATERAL`` from its
lane, half a spacing from the place, is still nearer to it than to any other."""
_MARGIN = 5.0
"""Metres before the end of a lane that belong to no core."""
_NEIGHBOURS = 8
"""Places within ``_CLEAR`` that are looked at: more than a lane has of its own."""


class LinePoint(IntEnum):
    """Columns of ``LaneCores.points``, metres."""

    X = 0
    Y = 1
    ARC = 2


class LaneBox(IntEnum):
    """Columns of ``LaneCores.boxes``, metres."""

    MIN_X = 0
    MAX_X = 1
    MIN_Y = 2
    MAX_Y = 3


class LaneCores(NamedTuple):
    """The cores of all lanes of a network.

    Attributes:
        points: (P, 3) the lanes' points, one lane after the other, columns ``LinePoint``.
        first: (L + 1,) the first row of each lane in ``points``.
        begin: (L,) arc length at which a lane's core begins, metres; infinite without a core.
        end: (L,) arc length at which it ends, metres.
        boxes: (L, 4), columns ``LaneBox``.
    """

    points: FloatArray
    first: IntArray
    begin: FloatArray
    end: FloatArray
    boxes: FloatArray


@lru_cache(maxsize=16)
def lane_cores(network: RoadNetwork) -> LaneCores:
    """Returns the cores of a network's lanes: of each the longest; none inside junctions."""
    # Imported here, as only runs with vehicles of SUMO need it.
    from scipy.spatial import cKDTree

    lanes = network.lanes
    first = np.cumsum([0, *(len(lane.arc) for lane in lanes)])
    points = np.concatenate([np.column_stack((lane.shape[:, :2], lane.arc)) for lane in lanes])
    begin = np.full(len(lanes), np.inf)
    end = np.full(len(lanes), -np.inf)
    cars = [lane for lane in lanes if lane.drivable]
    if cars:
        along = [_places(lane) for lane in cars]
        owners = np.repeat([lane.index for lane in cars], [len(places) for places in along])
        places = np.concatenate(along)
        distances, found = cKDTree(places[:, :2]).query(
            places[:, :2], k=_NEIGHBOURS, distance_upper_bound=_CLEAR
        )
        near = np.isfinite(distances)
        others = owners[np.where(near, found, 0)] != owners[:, None]
        # Where a lane has more places of its own than are looked at, it bends back to itself.
        is_clear = ~((near & others).any(axis=1) | near.all(axis=1))
        starts = np.cumsum([0, *map(len, along)])
        for lane, at, to in zip(cars, starts, starts[1:], strict=False):
            if not lane.is_internal:
                core = _longest(is_clear[at:to])
                if core is not None:
                    begin[lane.index] = places[at + core[0], LinePoint.ARC]
                    last = float(places[at + core[1] - 1, LinePoint.ARC])
                    end[lane.index] = min(last, float(lane.arc[-1]) - _MARGIN)
    spans = [(lane.shape.min(axis=0), lane.shape.max(axis=0)) for lane in lanes]
    boxes = np.array([(low[0], high[0], low[1], high[1]) for low, high in spans])
    return LaneCores(points, first, begin, end, boxes)


def _places(lane: Lane) -> FloatArray:
    """Returns (n, 3) x, y and arc length of places along a lane."""
    s = np.linspace(0.0, lane.arc[-1], max(int(np.ceil(lane.arc[-1] / _SPACING)), 1) + 1)
    x, y = (np.interp(s, lane.arc, lane.shape[:, k]) for k in range(2))
    return np.column_stack((x, y, s))


def _longest(flags: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> tuple[int, int] | None:
    """Returns first and end of the longest run of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    if not len(edges):
        return None
    lengths = edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return int(edges[2 * longest]), int(edges[2 * longest + 1])
