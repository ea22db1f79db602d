"""The constant part of rasters: a network's areas and lines in a grid.

Computed once for each network and process; what a raster draws at a step are the items of the few
cells below the image, so that a large town costs no more than a small one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from drivora_service.agents.raster.raster_settings import LIMIT_STEP, Channel
from drivora_service.geometry.array_shapes import (
    ByteArray,
    FloatArray,
    IntArray,
)
from drivora_service.geometry.lines import arc_lengths, offset_line
from drivora_service.networks.line_controls import LineControl, line_controls
from drivora_service.networks.markings import Marking, lane_markings
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.stop_lines import stop_lines

CELL = 32.0
"""Side of a cell of the grid, metres."""
PIECE = 20.0
"""Maximum length of a piece of a lane, metres: short, since a piece has one range of heights."""
TOLERANCE = 0.01
"""Metres by which a line may be moved by simplification, as for the area that is judged."""

_LINE_CHANNELS = {
    LineControl.SIGNAL: Channel.SIGNAL_LINES,
    LineControl.STOP: Channel.STOP_SIGNS,
    LineControl.ALL_WAY_STOP: Channel.STOP_SIGNS,
    LineControl.YIELD: Channel.GIVE_WAY_SIGNS,
}


class Grid(NamedTuple):
    """The items in each cell, row by row of cells.

    Attributes:
        starts: (cells + 1,) begin of each cell's items in ``items``.
        items: Numbers of items; an item is in every cell that its bounding box meets.
    """

    starts: IntArray
    items: IntArray


class RasterMap(NamedTuple):
    """Areas and lines of a network; metres in the network's plane.

    Attributes:
        edges: (E, 4) edges of the areas' outlines, x and y of both ends.
        area_starts: (n + 1,) begin of each area's edges.
        circles: (n, 3) x, y and radius of a circle around each area.
        area_heights: (n, 2) lowest and highest height of each area.
        limits: (n,) value in the channel of speed limits; 0 of junctions, which have none.
        area_grid: Areas in each cell.
        lines: (m, 4) straight lines, x and y of both ends.
        line_heights: (m, 2) lowest and highest height of each line.
        line_channels: (m,) ``Channel`` of each line.
        line_grid: Lines in each cell.
        origin: (2,) lower left corner of the grid.
        columns: Cells from west to east.
        rows: Cells from south to north.
    """

    edges: FloatArray
    area_starts: IntArray
    circles: FloatArray
    area_heights: FloatArray
    limits: ByteArray
    area_grid: Grid
    lines: FloatArray
    line_heights: FloatArray
    line_channels: IntArray
    line_grid: Grid
    origin: FloatArray
    columns: int
    rows: int


@lru_cache(maxsize=32)
def raster_map(network: RoadNetwork) -> RasterMap:
    """Returns the areas and lines of a network, computed on the first call for this object."""
    lanes = [lane for lane in network.lanes if lane.drivable]
    pieces, heights, owners = _pieces(lanes)
    areas = shapely.buffer(
        pieces,
        np.array([0.5 * lanes[owner].width for owner in owners]),
        cap_style="flat",
        join_style="round",
        quad_segs=4,
    )
    limits = np.array([_limit(lanes[owner].speed_limit) for owner in owners], dtype=np.uint8)
    junctions, junction_heights = _junctions(network, lanes)
    areas = np.concatenate((areas, junctions))
    area_heights = np.concatenate((heights, junction_heights))
    limits = np.concatenate((limits, np.zeros(len(junctions), dtype=np.uint8)))
    edges, area_starts = _outlines(areas)
    lines, line_heights, line_channels = _lines(network, lanes)

    boxes = shapely.bounds(areas)
    ends = np.stack((lines[:, :2], lines[:, 2:]))
    line_boxes = np.concatenate((ends.min(axis=0), ends.max(axis=0)), axis=1)
    everything = np.concatenate((boxes, line_boxes))
    origin = everything[:, :2].min(axis=0) - 1.0
    columns, rows = (int(cells) + 1 for cells in (everything[:, 2:].max(axis=0) - origin) // CELL)
    sizes = boxes[:, 2:] - boxes[:, :2]
    return RasterMap(
        edges=edges,
        area_starts=area_starts,
        circles=np.column_stack(
            (0.5 * (boxes[:, :2] + boxes[:, 2:]), 0.5 * np.hypot(sizes[:, 0], sizes[:, 1]))
        ),
        area_heights=area_heights,
        limits=limits,
        area_grid=_grid(boxes, origin, columns, rows),
        lines=lines,
        line_heights=line_heights,
        line_channels=line_channels,
        line_grid=_grid(line_boxes, origin, columns, rows),
        origin=origin,
        columns=columns,
        rows=rows,
    )


def _limit(speed: float) -> int:
    # A lane with any limit must differ from no lane.
    return min(max(round(speed / LIMIT_STEP), 1), 255)


def _pieces(lanes: Sequence[Lane]) -> tuple[NDArray[np.object_], FloatArray, list[int]]:
    """Cuts lanes into pieces.

    Returns:
        The (n,) centre lines of the pieces, their (n, 2) lowest and highest heights, and the row of
        each one's lane.
    """
    pieces: list[FloatArray] = []
    heights: list[tuple[float, float]] = []
    owners: list[int] = []
    for row, lane in enumerate(lanes):
        line, levels = _simplified(lane.shape, lane.heights, PIECE)
        arc = arc_lengths(line)
        count = max(int(np.ceil(arc[-1] / PIECE - 1e-9)), 1)
        cuts = np.searchsorted(arc, np.linspace(0.0, arc[-1], count + 1) - 1e-6)
        # Unique: a cut beside a corner was left out, and the next one may be found in its place.
        for first, last in pairwise(np.unique(cuts).tolist()):
            part = levels[first : last + 1]
            pieces.append(line[first : last + 1])
            heights.append((float(part.min()), float(part.max())))
            owners.append(row)
    found = np.array([shapely.LineString(piece) for piece in pieces], dtype=np.object_)
    return found, np.array(heights).reshape(-1, 2), owners


def _simplified(
    shape: FloatArray, heights: FloatArray, longest: float
) -> tuple[FloatArray, FloatArray]:
    """Returns a line with the points that its form needs, and those that divide it evenly.

    Imported lanes have a point every few decimetres.

    Args:
        shape: (n, 2) metres.
        heights: (n,) metres.
        longest: Metres between two of the points that divide the line, at most.

    Returns:
        The (m, 2) points and their (m,) heights.
    """
    corners = shapely.get_coordinates(shapely.LineString(shape).simplify(TOLERANCE))
    arc = arc_lengths(corners)
    count = max(int(np.ceil(arc[-1] / longest - 1e-9)), 1)
    between = np.linspace(0.0, arc[-1], count + 1)[1:-1]
    # Not beside a corner: two points at one place have no direction.
    gaps = np.abs(between[:, None] - arc[None]).min(axis=1)
    places = np.sort(np.concatenate((arc, between[gaps > 1e-3])))
    points = np.column_stack([np.interp(places, arc, corners[:, axis]) for axis in (0, 1)])
    own = arc_lengths(shape)
    return points, np.interp(places * (own[-1] / max(arc[-1], 1e-9)), own, heights)


def _junctions(
    network: RoadNetwork, lanes: Iterable[Lane]
) -> tuple[NDArray[np.object_], FloatArray]:
    """Returns the outlines of junctions where cars drive, and their lowest and highest heights."""
    ends: dict[str, list[float]] = {}
    for lane in lanes:
        if lane.to_junction in network.junction_shapes:
            ends.setdefault(lane.to_junction, []).append(float(lane.heights[-1]))
    areas: list[shapely.Polygon] = []
    heights: list[tuple[float, float]] = []
    for junction in sorted(ends):
        outline = shapely.make_valid(shapely.Polygon(network.junction_shapes[junction]))
        # An outline that crosses itself becomes parts; one without area becomes lines.
        for part in shapely.get_parts(outline).tolist():
            if part.area > 0.0:
                areas.append(part)
                heights.append((min(ends[junction]), max(ends[junction])))
    return np.array(areas, dtype=np.object_), np.array(heights).reshape(-1, 2)


def _outlines(areas: NDArray[np.object_]) -> tuple[FloatArray, IntArray]:
    """Returns the edges of all areas, holes included, and the begin of each area's edges."""
    parts, owners = shapely.get_parts(areas, return_index=True)
    rings, part_of = shapely.get_rings(parts, return_index=True)
    points, ring_of = shapely.get_coordinates(rings, return_index=True)
    inside = ring_of[:-1] == ring_of[1:]
    edges = np.concatenate((points[:-1], points[1:]), axis=1)[inside]
    area_of = owners[part_of[ring_of[:-1][inside]]]
    return edges, np.searchsorted(area_of, np.arange(len(areas) + 1))


def _lines(network: RoadNetwork, lanes: Iterable[Lane]) -> tuple[FloatArray, FloatArray, IntArray]:
    """Returns the lines (x and y of both ends), their heights, and the channel of each."""
    markings = lane_markings(network)
    ends: list[FloatArray] = []
    heights: list[FloatArray] = []
    channels: list[IntArray] = []

    def add(channel: Channel, shape: FloatArray, levels: FloatArray) -> None:
        line, own = _simplified(shape, levels, CELL)
        ends.append(np.concatenate((line[:-1], line[1:]), axis=1))
        heights.append(np.stack((np.minimum(own[:-1], own[1:]), np.maximum(own[:-1], own[1:])), 1))
        channels.append(np.full(len(line) - 1, int(channel), dtype=np.int64))

    for lane in lanes:
        add(Channel.CENTRE_LINES, lane.shape, lane.heights)
        for marking, side in zip(markings[lane.index], (0.5, -0.5), strict=True):
            if marking is not Marking.NONE:
                is_broken = marking is Marking.BROKEN
                channel = Channel.BROKEN_LINES if is_broken else Channel.SOLID_LINES
                add(channel, offset_line(lane.shape, side * lane.width), lane.heights)
    stops = stop_lines(network)
    for row, control in enumerate(line_controls(network)):
        if control in _LINE_CHANNELS:
            line = stop_line(network.lanes[int(stops.lanes[row])]).reshape(2, 2)
            add(_LINE_CHANNELS[control], line, np.full(2, stops.heights[row]))
    return np.concatenate(ends), np.concatenate(heights), np.concatenate(channels)


def stop_line(lane: Lane) -> FloatArray:
    """Returns the line across a lane's end: (4,) x and y of both ends, metres."""
    step = lane.shape[-1] - lane.shape[-2]
    across = 0.5 * lane.width * np.array([-step[1], step[0]]) / np.hypot(step[0], step[1])
    return np.concatenate((lane.shape[-1] + across, lane.shape[-1] - across))


def _grid(boxes: FloatArray, origin: FloatArray, columns: int, rows: int) -> Grid:
    """Sorts items into the cells that their (n, 4) bounding boxes meet."""
    first = ((boxes[:, :2] - origin) // CELL).astype(np.int64)
    last = ((boxes[:, 2:] - origin) // CELL).astype(np.int64)
    sizes = last - first + 1
    counts = sizes[:, 0] * sizes[:, 1]
    item = np.repeat(np.arange(len(boxes)), counts)
    nth = np.arange(len(item)) - np.repeat(np.cumsum(counts) - counts, counts)
    column = first[item, 0] + nth % sizes[item, 0]
    row = first[item, 1] + nth // sizes[item, 0]
    cell = row * columns + column
    order = np.lexsort((item, cell))
    return Grid(
        starts=np.searchsorted(cell[order], np.arange(columns * rows + 1)),
        items=item[order],
    )
