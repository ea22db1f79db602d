"""Projection of places on lanes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.compilation import compiled, worth_loading
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray, Int32Array
from drivora_service.networks import few_places
from drivora_service.networks.few_places import HEADING_WEIGHT, HYSTERESIS, OVERSHOOT
from drivora_service.networks.road_network import LanePosition, RoadNetwork
from drivora_service.networks.segment_index import CELL, SegmentIndex, segment_index


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaneProjections:
    """Positions of points on their lanes.

    Attributes:
        lane: (n,) index of the lane, -1 off all lanes.
        s: (n,) arc length of the foot point, metres; NaN off all lanes.
        lateral: (n,) signed distance from the centre line in metres, positive to the left; NaN off
            all lanes.
        heading: (n,) direction of the lane at the foot point in radians; NaN off all lanes.
    """

    lane: Int32Array
    s: FloatArray
    lateral: FloatArray
    heading: FloatArray


def nearest_lane_position(
    network: RoadNetwork,
    x: float,
    y: float,
    *,
    max_distance: float = 20.0,
    heading: float | None = None,
    drivable: bool = True,
) -> LanePosition | None:
    """Returns the position on the nearest lane; see :func:`lane_positions_near`.

    Returns:
        None if no lane is within ``max_distance``.
    """
    lanes, places, cost = _near_lanes(network, x, y, max_distance, heading, drivable)
    if not len(lanes):
        return None
    nearest = np.lexsort((lanes, cost))[0]
    s, lateral, direction = places[nearest].tolist()
    return LanePosition(lane=int(lanes[nearest]), s=s, lateral=lateral, heading=direction)


def lane_positions_near(
    network: RoadNetwork,
    x: float,
    y: float,
    *,
    max_distance: float = 20.0,
    heading: float | None = None,
    drivable: bool = True,
) -> tuple[LanePosition, ...]:
    """Returns the position on every lane near a place, nearest first.

    Args:
        network: The network.
        x: Metres.
        y: Metres.
        max_distance: Metres from the centre line, which counts as a segment with two ends.
        heading: Desired direction in radians: a lane in another direction counts as further away
            (by 3 m at a right angle, by 6 m in the opposite direction).
        drivable: Only lanes that are open to cars; False: lanes of every kind.
    """
    lanes, places, cost = _near_lanes(network, x, y, max_distance, heading, drivable)
    # Whole arrays become Python's numbers at once, ten times faster than one by one.
    found = sorted(zip(cost.tolist(), lanes.tolist(), places.tolist(), strict=True))
    return tuple(
        [
            LanePosition(lane=lane, s=s, lateral=lateral, heading=direction)
            for _, lane, (s, lateral, direction) in found
        ]
    )


def _near_lanes(
    network: RoadNetwork,
    x: float,
    y: float,
    max_distance: float,
    heading: float | None,
    drivable: bool,
) -> tuple[Int32Array, FloatArray, FloatArray]:
    """Returns the lanes (n,) near a place, the place (n, 3) on each, and its cost (n,), metres."""
    index = segment_index(network, drivable)
    if worth_loading(_near, 1):
        lanes, places = _near(*_arrays(index), float(x), float(y), float(max_distance))
    else:
        lanes, places = few_places.lanes_near(index, float(x), float(y), float(max_distance))
    cost = np.abs(places[:, 1])
    if heading is not None:
        cost = cost + HEADING_WEIGHT * (1.0 - elementary.cos(places[:, 2] - heading))
    return lanes, places, cost


def project_points(
    network: RoadNetwork, xy: FloatArray, headings: FloatArray | None = None
) -> LaneProjections:
    """Returns the drivable lane that each point of a trajectory is on.

    A point is on a lane up to half its width from the centre line. Of several lanes the nearest
    with a similar heading is taken, preferably the lane of the preceding point.

    Args:
        network: The network.
        xy: (n, 2) metres, in the order in which they were passed.
        headings: (n,) radians; None: lanes in all directions are equal.
    """
    index = segment_index(network, True)
    points = np.ascontiguousarray(xy, dtype=np.float64).reshape(-1, 2)
    wanted = np.full(len(points), np.nan) if headings is None else headings
    wanted = np.ascontiguousarray(wanted, dtype=np.float64)
    if worth_loading(_project, len(points)):
        lanes, places = _project(*_arrays(index), index.ends, index.half_widths, points, wanted)
    else:
        lanes, places = few_places.project(index, points, wanted)
    return LaneProjections(
        lane=lanes, s=places[:, 0].copy(), lateral=places[:, 1].copy(), heading=places[:, 2].copy()
    )


_Arrays = tuple[FloatArray, Int32Array, FloatArray, int, int, Int32Array, Int32Array, int]


def _arrays(index: SegmentIndex) -> _Arrays:
    return (
        index.segments,
        index.lanes,
        index.origin,
        index.columns,
        index.rows,
        index.cell_starts,
        index.cell_items,
        len(index.half_widths),
    )


@compiled
def _distance(segments: FloatArray, i: int, x: float, y: float) -> tuple[float, float, float]:
    """Returns the squared distance from a segment, the foot point and its unclamped place on it."""
    dx, dy = x - segments[i, 0], y - segments[i, 1]
    along = dx * segments[i, 2] + dy * segments[i, 3]
    t = min(max(along, 0.0), segments[i, 4])
    dx -= t * segments[i, 2]
    dy -= t * segments[i, 3]
    return dx * dx + dy * dy, t, along


@compiled
def _place(segments: FloatArray, i: int, t: float, x: float, y: float, out: FloatArray) -> None:
    """Writes arc length, signed distance and heading of a foot point."""
    dx, dy = x - segments[i, 0], y - segments[i, 1]
    ux, uy = segments[i, 2], segments[i, 3]
    side = ux * dy - uy * dx
    distance = np.hypot(dx - t * ux, dy - t * uy)
    out[0] = segments[i, 5] + t
    out[1] = distance if side >= 0.0 else -distance
    out[2] = math.atan2(uy, ux)


@compiled
def _cells(low: float, high: float, count: int) -> tuple[int, int]:
    """Returns the first and the last of ``count`` cells that a range of metres touches."""
    return max(int(np.floor(low / CELL)), 0), min(int(np.floor(high / CELL)), count - 1)


@compiled
def _near(
    segments: FloatArray,
    lanes: Int32Array,
    origin: FloatArray,
    columns: int,
    rows: int,
    cell_starts: Int32Array,
    cell_items: Int32Array,
    lane_count: int,
    x: float,
    y: float,
    radius: float,
) -> tuple[Int32Array, FloatArray]:
    """Returns the lanes within ``radius`` and the place on each: arc length, lateral, heading."""
    found = np.empty(lane_count, np.int32)
    segment = np.empty(lane_count, np.int64)
    squared = np.empty(lane_count)
    foot = np.empty(lane_count)
    count = 0
    c0, c1 = _cells(x - radius - origin[0], x + radius - origin[0], columns)
    r0, r1 = _cells(y - radius - origin[1], y + radius - origin[1], rows)
    for row in range(r0, r1 + 1):
        for cell in range(row * columns + c0, row * columns + c1 + 1):
            for k in range(cell_starts[cell], cell_starts[cell + 1]):
                i = cell_items[k]
                d2, t, _ = _distance(segments, i, x, y)
                if d2 > radius * radius:
                    continue
                j = 0
                while j < count and found[j] != lanes[i]:
                    j += 1
                if j == count:
                    count += 1
                elif d2 >= squared[j]:
                    continue
                found[j], segment[j], squared[j], foot[j] = lanes[i], i, d2, t
    places = np.empty((count, 3))
    for j in range(count):
        _place(segments, segment[j], foot[j], x, y, places[j])
    return found[:count].copy(), places


@compiled
def _project(
    segments: FloatArray,
    lanes: Int32Array,
    origin: FloatArray,
    columns: int,
    rows: int,
    cell_starts: Int32Array,
    cell_items: Int32Array,
    lane_count: int,
    ends: NDArray[np.uint8],
    half_widths: FloatArray,
    points: FloatArray,
    headings: FloatArray,
) -> tuple[Int32Array, FloatArray]:
    """Returns the lane of each point and the place on it: arc length, lateral, heading."""
    chosen = np.full(len(points), -1, np.int32)
    places = np.full((len(points), 3), np.nan)
    found = np.empty(lane_count, np.int32)
    segment = np.empty(lane_count, np.int64)
    squared = np.empty(lane_count)
    foot = np.empty(lane_count)
    radius = half_widths.max()
    before = -1
    for p in range(len(points)):
        x, y = points[p, 0], points[p, 1]
        count = 0
        c0, c1 = _cells(x - radius - origin[0], x + radius - origin[0], columns)
        r0, r1 = _cells(y - radius - origin[1], y + radius - origin[1], rows)
        for row in range(r0, r1 + 1):
            for cell in range(row * columns + c0, row * columns + c1 + 1):
                for k in range(cell_starts[cell], cell_starts[cell + 1]):
                    i = cell_items[k]
                    half = half_widths[lanes[i]]
                    d2, t, along = _distance(segments, i, x, y)
                    if d2 > half * half:
                        continue
                    if ends[i] & 1 and along < -OVERSHOOT:
                        continue
                    if ends[i] & 2 and along > segments[i, 4] + OVERSHOOT:
                        continue
                    j = 0
                    while j < count and found[j] != lanes[i]:
                        j += 1
                    if j == count:
                        count += 1
                    elif d2 >= squared[j]:
                        continue
                    found[j], segment[j], squared[j], foot[j] = lanes[i], i, d2, t
        best, best_cost = -1, np.inf
        for j in range(count):
            i = segment[j]
            cost = np.sqrt(squared[j])
            if not np.isnan(headings[p]):
                agreement = (
                    math.cos(headings[p]) * segments[i, 2] + math.sin(headings[p]) * segments[i, 3]
                )
                cost += HEADING_WEIGHT * (1.0 - agreement)
            if found[j] == before:
                cost -= HYSTERESIS
            if cost < best_cost or (cost == best_cost and found[j] < found[best]):
                best, best_cost = j, cost
        before = -1
        if best >= 0:
            before = found[best]
            chosen[p] = before
            _place(segments, segment[best], foot[best], x, y, places[p])
    return chosen, places
