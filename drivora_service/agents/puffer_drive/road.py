"""The road in the form of the driving policy's training: short pieces of lanes, lines and edges."""

from __future__ import annotations

from enum import IntEnum
from functools import lru_cache

import numpy as np
import shapely

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.drivable_area import drivable_area
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute


class RoadCol(IntEnum):
    """Columns of pieces of road."""

    X = 0
    Y = 1
    """Of its middle, metres."""
    DIRECTION_X = 2
    DIRECTION_Y = 3
    """Of unit length."""
    HALF_LENGTH = 4
    """Metres."""
    KIND = 5
    """``LANE``, ``LINE`` or ``EDGE``."""


LANE, LINE, EDGE = 0.0, 1.0, 2.0
"""Kinds of pieces: along the middle of a lane, the line at its left, the edge of the road."""

_LONGEST = 8.0
"""Maximum length of a piece, metres."""
_TOLERANCE = 0.2
"""Metres by which a line may be simplified."""
_ON_EDGE = 0.6
"""Metres; a line that is nearer to an edge than this is that edge."""
_BESIDE_ROUTE = 120.0
"""Metres beside the route up to which pieces are kept: the range of view and a margin."""


@lru_cache(maxsize=32)
def road_pieces(network: RoadNetwork) -> FloatArray:
    """Returns the (n, 6) pieces of a network's roads, columns ``RoadCol``."""
    edges = shapely.boundary(drivable_area(network))
    lanes = [lane for lane in network.lanes if lane.drivable]
    lines = [_left_border(lane) for lane in lanes if not lane.is_internal]
    pieces = [_cut([shapely.LineString(lane.shape) for lane in lanes], LANE)]
    pieces.append(_cut(list(shapely.get_parts(edges)), EDGE))
    if lines:
        marked = _cut(lines, LINE)
        places = shapely.points(marked[:, :2])
        shapely.prepare(edges)
        pieces.append(marked[~shapely.dwithin(edges, places, _ON_EDGE)])
    return np.concatenate(pieces)


def pieces_along(network: RoadNetwork, route: LaneRoute) -> FloatArray:
    """Returns the pieces that are visible from a route; see :func:`road_pieces`."""
    pieces = road_pieces(network)
    way = shapely.LineString(route.line)
    shapely.prepare(way)
    near: FloatArray = pieces[shapely.dwithin(way, shapely.points(pieces[:, :2]), _BESIDE_ROUTE)]
    return near


def _left_border(lane: Lane) -> shapely.LineString:
    step = np.gradient(lane.shape, axis=0)
    step /= np.maximum(np.hypot(step[:, :1], step[:, 1:]), 1e-9)
    normal = np.column_stack((-step[:, 1], step[:, 0]))
    return shapely.LineString(lane.shape + 0.5 * lane.width * normal)


def _cut(lines: list[shapely.LineString], kind: float) -> FloatArray:
    fine = shapely.segmentize(shapely.simplify(lines, _TOLERANCE), _LONGEST)
    points, line = shapely.get_coordinates(fine, return_index=True)
    joined = line[1:] == line[:-1]
    start, end = points[:-1][joined], points[1:][joined]
    half = 0.5 * (end - start)
    length = np.hypot(half[:, 0], half[:, 1])
    keep = length > 1e-6
    half, length = half[keep], length[keep]
    return np.column_stack(
        (start[keep] + half, half / length[:, None], length, np.full(len(length), kind))
    )
