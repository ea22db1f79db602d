"""Projection of places on lanes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.compilation import compiled, worth_loading
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray, Int32Array
from drivora_service.networks import few_places
from drivora_service.networks.few_places import (
    HEADING_WEIGHT,
    HYSTERESIS,
    LANE_PLACE_COLUMNS,
    OVERSHOOT,
    LanePlaceCol,
)
from drivora_service.networks.road_network import LanePosition, RoadNetwork
from drivora_service.networks.segment_index import (
    CELL,
    LaneEnd,
    SegmentCol,
    SegmentIndex,
    segment_index,
)


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
    """Returns the lanes near a place, the place on each, and its cost in metres.

    Shapes: (n,), (n, 3) with columns ``LanePlaceCol``, and (n,).
    """
    index = segment_index(network, drivable)
    if worth_loading(_near, 1):
        lanes, places = _near(index, float(x), float(y), float(max_distance))
    else:
        lanes, places = few_places.lanes_near(index, float(x), float(y), float(max_distance))
    cost = np.abs(places[:, LanePlaceCol.LATERAL])
    if heading is not None:
        turn = places[:, LanePlaceCol.HEADING] - heading
        cost = cost + HEADING_WEIGHT * (1.0 - elementary.cos(turn))
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
        lanes, places = _project(index, points, wanted)
    else:
        lanes, places = few_places.project(index, points, wanted)
    return LaneProjections(
        lane=lanes,
        s=places[:, LanePlaceCol.S].copy(),
        lateral=places[:, LanePlaceCol.LATERAL].copy(),
        heading=places[:, LanePlaceCol.HEADING].copy(),
    )


@compiled
def _distance(segments: FloatArray, i: int, x: float, y: float) -> tuple[float, float, float]:
    """Returns the squared distance from a segment, the foot point and its unclamped place on it."""
    segment = segments[i]
    ux, uy = segment[SegmentCol.COS], segment[SegmentCol.SIN]
    dx, dy = x - segment[SegmentCol.X], y - segment[SegmentCol.Y]
    along = dx * ux + dy * uy
    t = min(max(along, 0.0), segment[SegmentCol.LENGTH])
    dx -= t * ux
    dy -= t * uy
    return dx * dx + dy * dy, t, along


@compiled
def _place(segments: FloatArray, i: int, t: float, x: float, y: float, out: FloatArray) -> None:
    """Writes the place of a foot point, columns ``LanePlaceCol``."""
    segment = segments[i]
    ux, uy = segment[SegmentCol.COS], segment[SegmentCol.SIN]
    dx, dy = x - segment[SegmentCol.X], y - segment[SegmentCol.Y]
    side = ux * dy - uy * dx
    distance = np.hypot(dx - t * ux, dy - t * uy)
    out[LanePlaceCol.S] = segment[SegmentCol.ARC] + t
    out[LanePlaceCol.LATERAL] = distance if side >= 0.0 else -distance
    out[LanePlaceCol.HEADING] = math.atan2(uy, ux)


@compiled
def _cells(low: float, high: float, count: int) -> tuple[int, int]:
    """Returns the first and the last of ``count`` cells that a range of metres touches."""
    return max(int(np.floor(low / CELL)), 0), min(int(np.floor(high / CELL)), count - 1)


@compiled
def _near(index: SegmentIndex, x: float, y: float, radius: float) -> tuple[Int32Array, FloatArray]:
    """Returns the lanes within ``radius``, and the place on each, columns ``LanePlaceCol``."""
    segments, lanes, origin = index.segments, index.lanes, index.origin
    cell_starts, cell_items, columns = index.cell_starts, index.cell_items, index.columns
    lane_count = len(index.half_widths)
    found = np.empty(lane_count, np.int32)
    segment = np.empty(lane_count, np.int64)
    squared = np.empty(lane_count)
    foot = np.empty(lane_count)
    count = 0
    c0, c1 = _cells(x - radius - origin[0], x + radius - origin[0], columns)
    r0, r1 = _cells(y - radius - origin[1], y + radius - origin[1], index.rows)
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
    places = np.empty((count, LANE_PLACE_COLUMNS))
    for j in range(count):
        _place(segments, segment[j], foot[j], x, y, places[j])
    return found[:count].copy(), places


@compiled
def _project(
    index: SegmentIndex, points: FloatArray, headings: FloatArray
) -> tuple[Int32Array, FloatArray]:
    """Returns the lane of each point, and the place on it, columns ``LanePlaceCol``."""
    segments, lanes, origin = index.segments, index.lanes, index.origin
    cell_starts, cell_items, columns = index.cell_starts, index.cell_items, index.columns
    ends, half_widths = index.ends, index.half_widths
    lane_count = len(half_widths)
    chosen = np.full(len(points), -1, np.int32)
    places = np.full((len(points), LANE_PLACE_COLUMNS), np.nan)
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
        r0, r1 = _cells(y - radius - origin[1], y + radius - origin[1], index.rows)
        for row in range(r0, r1 + 1):
            for cell in range(row * columns + c0, row * columns + c1 + 1):
                for k in range(cell_starts[cell], cell_starts[cell + 1]):
                    i = cell_items[k]
                    half = half_widths[lanes[i]]
                    d2, t, along = _distance(segments, i, x, y)
                    if d2 > half * half:
                        continue
                    if ends[i] & LaneEnd.FIRST and along < -OVERSHOOT:
                        continue
                    length = segments[i, SegmentCol.LENGTH]
                    if ends[i] & LaneEnd.LAST and along > length + OVERSHOOT:
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
                ux, uy = segments[i, SegmentCol.COS], segments[i, SegmentCol.SIN]
                agreement = math.cos(headings[p]) * ux + math.sin(headings[p]) * uy
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
