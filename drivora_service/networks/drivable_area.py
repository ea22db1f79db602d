"""The area that vehicles may use, and the distance of points from it.

It is the union of the lanes open to cars, at their full width, with the outlines of the junctions
where they meet. Shoulders, parking lanes closed to passenger cars, sidewalks and crossings beside
the junction are outside. Gaps in a carriageway, up to a few decimetres between lanes and where a
bend's outside is beyond both of its lanes' ends, are inside.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.road_network import Lane, RoadNetwork

MAX_GAP = 0.5
"""Metres between two lanes, or a lane and a junction, that are closed as a gap."""

TOLERANCE = 0.01
"""Metres by which a lane's centre line may be moved by simplification."""

TILE = 40.0
"""Side of the tiles of the area in metres; small, so that a query uses a small polygon."""

Tree = shapely.STRtree


def drivable_area(network: RoadNetwork) -> BaseGeometry:
    """Returns the area as one polygon or several, metres."""
    return _area(network)[0]


def outside_distance(network: RoadNetwork, points: FloatArray) -> FloatArray:
    """Returns the distance of each of (n, 2) points from the drivable area.

    Returns:
        (n,) metres; 0 inside. NaN for a point that is not finite.
    """
    tiles = _area(network)[1]
    xy = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    distance = np.full(len(xy), np.nan)
    finite = np.isfinite(xy).all(axis=1)
    if not finite.any():
        return distance
    places = np.asarray(shapely.points(xy[finite]))
    gaps = np.full(len(places), np.inf)
    gaps[tiles.query(places, predicate="intersects")[0]] = 0.0
    outside = np.nonzero(gaps)[0]
    if len(outside):
        (asked, _), found = tiles.query_nearest(
            places[outside], return_distance=True, all_matches=False
        )
        gaps[outside[asked]] = found
    distance[finite] = gaps
    return distance


def near_area(network: RoadNetwork, points: FloatArray, distance: float) -> BoolArray:
    """Returns which of (n, 2) finite points are in the drivable area or within ``distance`` metres.

    This is much faster than the distances.
    """
    tiles = _area(network)[1]
    near = np.zeros(len(points), dtype=np.bool_)
    near[tiles.query(shapely.points(points), predicate="dwithin", distance=distance)[0]] = True
    return near


def meets_area(network: RoadNetwork, corners: FloatArray) -> BoolArray:
    """Returns which of n polygons, (n, k, 2) corners in metres, cover a part of the area."""
    tiles = _area(network)[1]
    meets = np.zeros(len(corners), dtype=np.bool_)
    meets[tiles.query(shapely.polygons(corners), predicate="intersects")[0]] = True
    return meets


@lru_cache(maxsize=128)
def _area(network: RoadNetwork) -> tuple[BaseGeometry, Tree]:
    lanes = [lane for lane in network.lanes if lane.drivable]
    parts = [_lane_area(lane) for lane in lanes]
    met = {lane.to_junction for lane in lanes} - {""}
    for junction in sorted(met & network.junction_shapes.keys()):
        outline = shapely.make_valid(shapely.Polygon(network.junction_shapes[junction]))
        # An outline that crosses itself becomes parts; one without area becomes lines.
        parts.extend(part for part in shapely.get_parts(outline) if part.area > 0.0)
    union = shapely.union_all(parts)
    half = 0.5 * MAX_GAP
    closed = union.buffer(half, join_style="mitre").buffer(-half, join_style="mitre")
    # Closing with mitred corners can cut off slivers; the union itself is inside in any case.
    area = shapely.union_all([closed, union])
    return area, Tree(_tiles(area))


def _lane_area(lane: Lane) -> BaseGeometry:
    # Imported lanes have a point every few decimetres; a few of them suffice.
    line = shapely.LineString(lane.shape).simplify(TOLERANCE)
    return line.buffer(0.5 * lane.width, cap_style="flat", join_style="round", quad_segs=4)


def _tiles(area: BaseGeometry) -> list[BaseGeometry]:
    """Cuts the area along a grid; the tiles share their borders."""
    min_x, min_y, max_x, max_y = area.bounds
    xs, ys = np.arange(min_x, max_x, TILE), np.arange(min_y, max_y, TILE)
    x, y = (axis.ravel() for axis in np.meshgrid(xs, ys))
    boxes = shapely.box(x, y, x + TILE, y + TILE)
    shapely.prepare(area)
    met = boxes[shapely.intersects(area, boxes)]
    pieces = shapely.intersection(met, area)
    tiles = [piece for piece in pieces if piece.area > 0.0]
    shapely.prepare(tiles)
    return tiles
