"""Which stop lines an ego drove over, and what its signal showed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from tests.recomputation.recording import Drive, Floats, Recording
from tests.recomputation.routes import Progress
from tests.recomputation.town import Movement, RoadLane, Town, lane_length, read_town

FRONT_WIDTH = 1.2
"""Width of a stop line over that of its lane within which the front crosses it (Leaderboard)."""

TAIL_WIDTH = 3.0
"""The same for the tail."""

SEEN = 15.0
"""Metres before a line of the route within which the front must have been (Leaderboard)."""

BESIDE = 8.0
"""Metres beside the route up to which an ego passes the lines of its route."""

SAME = 5.0
"""Metres of way within which two lines passed are one."""

ALIKE = 0.5
"""Metres by which an ego may be further from one way through a junction than from another, and may
have driven either."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Passed:
    """A stop line with a signal that an ego drove over along its lane.

    Attributes:
        lane: The lane that ends there.
        step: First step with the tail beyond the line.
        red: Whether the signal of the ego's way was red then; ``None`` where the ways that it may
            have taken have different signals.
    """

    lane: str
    step: int
    red: bool | None


def lines_passed(run: Recording, drive: Drive, progress: Progress) -> list[Passed]:
    """Returns every stop line with a signal which the ego's tail crossed, in order of time.

    The lines of its route are crossed as well where it passes them beside its lane.
    """
    town = read_town(run.head["network"])
    path = shapely.box(drive.x.min(), drive.y.min(), drive.x.max(), drive.y.max())
    near = [
        lane
        for lane in town.lanes.values()
        if not lane.inside and any(movement.light for movement in lane.movements)
        if path.distance(shapely.Point(lane.line[-1])) < 20.0
    ]
    found = []
    for lane in near:
        fronts = crossings(drive, lane, 0.5 * drive.length, FRONT_WIDTH)
        tails = crossings(drive, lane, -0.5 * drive.length, TAIL_WIDTH)
        for nth, front in enumerate(fronts):
            until = fronts[nth + 1] if nth + 1 < len(fronts) else drive.count
            tail = [row for row in tails if front <= row < until]
            if tail:
                centres = np.column_stack((drive.x, drive.y))[front:]
                ways = ways_taken(town, lane, centres)
                found.append((tail[0], lane, _is_red(run, ways, drive.first + tail[0])))
    driven = np.cumsum(drive.moved)
    for lane in near:
        row = _beside(drive, progress, lane)
        if row is not None and all(abs(driven[row] - driven[k]) > SAME for k, *_ in found):
            end = shapely.Point(lane.line[-1])
            behind = drive.arc > shapely.LineString(drive.line).project(end)
            ways = ways_taken(town, lane, drive.line[behind])
            # The signal of the route is the one ahead as long as the tail has not passed its line.
            found.append((row, lane, _is_red(run, ways, drive.first + row - 1)))
    return [
        Passed(lane=lane.id, step=drive.first + row, red=red)
        for row, lane, red in sorted(found, key=lambda one: one[0])
    ]


def _is_red(run: Recording, ways: list[Movement], step: int) -> bool | None:
    reds = {bool(w.light) and run.signal(w.light, w.link)[step] in "ru" for w in ways}
    return reds.pop() if len(reds) == 1 else None


def _beside(drive: Drive, progress: Progress, lane: RoadLane) -> int | None:
    """Returns the row in which the tail has passed, beside the lane, a stop line of the route."""
    end, before = lane.line[-1], lane.line[-2]
    route = shapely.LineString(drive.line)
    s = float(route.project(shapely.Point(end)))
    heading = route.interpolate(s + 0.1).coords[0], route.interpolate(s - 0.1).coords[0]
    along = np.subtract(*heading) @ (end - before)
    if route.distance(shapely.Point(end)) > 0.5 * lane.width or along <= 0.0:
        return None
    front, tail = progress.along + 0.5 * drive.length - s, progress.along - 0.5 * drive.length - s
    if not np.any((front <= 0.0) & (front >= -SEEN)):
        return None
    rows = np.flatnonzero((tail[:-1] <= 0.0) & (tail[1:] > 0.0)) + 1
    return int(rows[0]) if len(rows) and progress.beside[rows[0]] <= BESIDE else None


def crossings(drive: Drive, lane: RoadLane, ahead: float, width: float) -> list[int]:
    """Returns the rows with a point of the ego's axis beyond a stop line, and before it a row ago.

    The stop line is a segment across the end of the lane; the point moves in a straight line from
    row to row.
    """
    end = complex(*lane.line[-1])
    along = end - complex(*lane.line[-2])
    along /= abs(along)
    half = 0.5 * width * lane.width
    line = shapely.LineString([_xy(end + 1j * half * along), _xy(end - 1j * half * along)])
    axis = np.exp(1j * drive.yaw)
    point = np.asarray(drive.x + 1j * drive.y + ahead * axis, dtype=np.complex128)
    near = np.flatnonzero(np.abs(point[1:] - end) < half + 5.0)
    steps = shapely.linestrings(
        np.stack((_plane(point[near]), _plane(point[near + 1])), axis=1).reshape(-1, 2, 2)
    )
    met = near[shapely.intersects(steps, line)] + 1
    place = ((point - end) * np.conj(along)).real
    heads_on = (axis * np.conj(along)).real > 0.0
    return [int(k) for k in met if place[k - 1] <= 0.0 < place[k] and heads_on[k]]


def _xy(point: complex) -> tuple[float, float]:
    return point.real, point.imag


def _plane(points: NDArray[np.complex128]) -> Floats:
    return np.stack((points.real, points.imag), axis=-1)


def ways_taken(town: Town, lane: RoadLane, centres: Floats) -> list[Movement]:
    """Returns the movements from a lane along which a path from its end may go.

    It goes along the one whose way through the junction it keeps nearest to.
    """
    driven = np.r_[0.0, np.cumsum(np.hypot(*np.diff(centres, axis=0).T))]
    distances = []
    for movement in lane.movements:
        way = _way(town, lane, movement)
        kept = centres[driven <= way.length - lane_length(lane)]
        distances.append(float(shapely.distance(way, shapely.points(kept)).max()))
    least = min(distances)
    return [
        movement
        for movement, distance in zip(lane.movements, distances, strict=True)
        if distance <= least + ALIKE
    ]


def _way(town: Town, lane: RoadLane, movement: Movement) -> shapely.LineString:
    """Returns the centre line of a lane, of the way through the junction, and 10 m behind it."""
    points = [lane.line]
    inside = movement.via
    while inside:
        points.append(town.lanes[inside].line)
        inside = next((m.via for m in town.lanes[inside].movements), "")
    behind = shapely.LineString(town.lanes[movement.to].line)
    points.append(shapely.get_coordinates(substring(behind, 0.0, 10.0)))
    return shapely.LineString(np.concatenate(points))
