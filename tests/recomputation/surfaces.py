"""The drivable area, and the distance of a point outside it."""

from __future__ import annotations

from functools import cache

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from tests.recomputation.boxes import corners
from tests.recomputation.recording import Drive, Flags, Floats
from tests.recomputation.town import read_town

GAP = 0.5
"""Metres between two parts of a carriageway that belong together."""

FINE = 32
"""Pieces of a quarter of a circle, where lanes bend."""


@cache
def _surface(name: str) -> tuple[BaseGeometry, shapely.STRtree]:
    """Returns the area of a town, and a tree of the pieces of its border."""
    town = read_town(name)
    parts = [
        shapely.LineString(lane.line).buffer(0.5 * lane.width, cap_style="flat", quad_segs=FINE)
        for lane in town.lanes.values()
        if len(np.unique(lane.line, axis=0)) > 1
    ]
    reached = {lane.junction for lane in town.lanes.values()} & town.junctions.keys()
    parts += [shapely.Polygon(town.junctions[key]).buffer(0.0) for key in reached]
    area = shapely.unary_union(parts)
    wider = area.buffer(0.5 * GAP, join_style="mitre")
    area = shapely.union(area, wider.buffer(-0.5 * GAP, join_style="mitre"))
    rings = shapely.get_rings(shapely.get_parts(area))
    outlines = [shapely.get_coordinates(ring) for ring in rings]
    ends = [np.stack((points[:-1], points[1:]), axis=1) for points in outlines]
    shapely.prepare(area)
    return area, shapely.STRtree(np.asarray(shapely.linestrings(np.concatenate(ends))))


def outside(town: str, points: Floats) -> Floats:
    """Returns the (n,) metres by which (n, 2) points are outside the area, 0 inside."""
    area, border = _surface(town)
    distance = np.zeros(len(points))
    places = np.asarray(shapely.points(points))
    off = np.flatnonzero(~shapely.intersects(area, places))
    if len(off):
        (asked, _), found = border.query_nearest(
            places[off], return_distance=True, all_matches=False
        )
        distance[off[asked]] = found
    return distance


def corners_outside(town: str, drive: Drive) -> Floats:
    """Returns the (n,) metres by which the box's furthest corner is outside the area."""
    spots = corners(drive.x, drive.y, drive.yaw, drive.length, drive.width)
    gaps = outside(town, spots.reshape(-1, 2)).reshape(-1, 4)
    return np.asarray(gaps.max(axis=1, initial=0.0))


@cache
def _lane_areas(name: str) -> dict[str, shapely.Polygon]:
    return {
        key: shapely.LineString(lane.line).buffer(0.5 * lane.width, cap_style="flat")
        for key, lane in read_town(name).lanes.items()
        if len(np.unique(lane.line, axis=0)) > 1
    }


def lane_errors(town: str, drive: Drive) -> Floats:
    """Returns the (n,) metres by which the centre is off its recorded lane.

    Where no lane is recorded, the metres by which it is inside one.
    """
    lanes, areas = read_town(town).lanes, _lane_areas(town)
    centres = np.asarray(shapely.points(drive.x, drive.y))
    names = np.array(drive.lanes)
    errors = np.zeros(drive.count)
    for name in set(drive.lanes) - {""}:
        here = names == name
        away = shapely.distance(shapely.LineString(lanes[name].line), centres[here])
        errors[here] = np.maximum(away - 0.5 * lanes[name].width, 0.0)
    for k in np.flatnonzero(names == ""):
        for area in areas.values():
            if area.contains(centres[k]):
                errors[k] = max(errors[k], area.exterior.distance(centres[k]))
    return errors


def lane_headings(town: str, drive: Drive) -> Floats:
    """Returns the (n,) directions of the lane that the ego is on, beside it; NaN off all lanes."""
    found = np.full(drive.count, np.nan)
    names = np.array(drive.lanes)
    for name in set(drive.lanes) - {""}:
        here = np.flatnonzero(names == name)
        found[here] = _headings(read_town(town).lanes[name].line, drive.x[here], drive.y[here])
    return found


def lane_offsets(town: str, drive: Drive) -> Floats:
    """Returns the (n,) metres from the ego's centre to the line of its lane; NaN off all lanes."""
    found = np.full(drive.count, np.nan)
    names = np.array(drive.lanes)
    for name in set(drive.lanes) - {""}:
        here = np.flatnonzero(names == name)
        line = shapely.LineString(read_town(town).lanes[name].line)
        found[here] = shapely.distance(line, shapely.points(drive.x[here], drive.y[here]))
    return found


def against(town: str, drive: Drive) -> Flags:
    """Tells the (n,) rows in which the ego heads against the lane that it is on, on a road."""
    lanes = read_town(town).lanes
    on_road = np.array([bool(name) and not lanes[name].inside for name in drive.lanes])
    with np.errstate(invalid="ignore"):
        wrong = np.cos(drive.yaw - lane_headings(town, drive)) < 0.0
    return np.asarray(on_road & wrong, dtype=np.bool_)


def _headings(line: Floats, x: Floats, y: Floats) -> Floats:
    """Returns the heading of the piece of a line that is nearest to each of (n,) places."""
    ends = np.stack((line[:-1], line[1:]), axis=1)
    pieces: NDArray[np.object_] = np.asarray(shapely.linestrings(ends))
    away = shapely.distance(pieces[None, :], np.asarray(shapely.points(x, y))[:, None])
    steps = line[1:] - line[:-1]
    headings: Floats = np.arctan2(steps[:, 1], steps[:, 0])
    nearest: Floats = headings[np.argmin(away, axis=1)]
    return nearest


def outside_lanes(town: str, drive: Drive, margin: float) -> Flags:
    """Tells the (n,) rows in which the centre is outside all lanes, or heads against its lane."""
    off = np.array([name == "" for name in drive.lanes], dtype=np.bool_)
    centres = np.column_stack((drive.x, drive.y))
    off[off] = outside(town, centres[off]) > margin
    return off | against(town, drive)
