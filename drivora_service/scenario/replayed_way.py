"""The way of a replayed vehicle: straight lines through its waypoints, with rounded bends.

A corner of straight lines has no radius, so that a vehicle would have to crawl through the gentlest
bend of waypoints that lie far apart. Where it would be slower there than its waypoints ask, and the
lines turn by little, an arc takes the place of the corner: as wide as the speed needs, from at most
the middle of each line. So the way leaves the lines by no more than a road through the waypoints
does. Other corners stay as they are, and so does a way on which nothing slows the vehicle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.geometry.sampled_lines import (
    SPACING,
    distinct_points,
    measure_line,
    sample_line,
)

GENTLE = math.radians(30.0)
"""Angle between two lines up to which a corner is a bend, which is rounded."""

MOST_CUT = 2.0
"""Metres by which an arc may miss its waypoint, at most: half a lane."""

_MARGIN = 1.02
"""Factor by which an arc is wider than needed, since it is made of straight pieces."""

_SAME_SPEED = 1e-9
"""Share by which a speed may be less than asked without being slower."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SlowCorner:
    """A waypoint at which a vehicle is slower than its waypoints ask.

    Attributes:
        number: Number of the waypoint, from 0.
        turn: Radians by which the straight lines turn there, not negative.
        asked: m/s.
        speed: m/s that the lateral acceleration allows, arcs considered.
    """

    number: int
    turn: float
    asked: float
    speed: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReplayedWay:
    """A way through waypoints.

    Attributes:
        line: (n, 2) metres.
        marks: (w,) arc length of each waypoint, or of the middle of its arc, metres.
        is_sampled: Whether the points are close to each other: a way with arcs.
        slow_corners: Where the vehicle is slower than asked, in order.
    """

    line: FloatArray
    marks: FloatArray
    is_sampled: bool
    slow_corners: tuple[SlowCorner, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Arc:
    """An arc in place of a corner: its radius, and the metres of each line that it takes."""

    radius: float
    tangent: float


def lay_way(points: FloatArray, speeds: FloatArray, waits: BoolArray, side: float) -> ReplayedWay:
    """Returns the way through waypoints.

    Args:
        points: (w, 2) waypoints, metres.
        speeds: (w,) m/s.
        waits: (w,) whether the vehicle stands at the waypoint: it does so at that very place.
        side: Lateral acceleration that it uses, m/s².
    """
    marks = arc_lengths(points)
    plain = ReplayedWay(line=points, marks=marks, is_sampled=False, slow_corners=())
    slow = _find_slow_corners(points, speeds, waits, marks, side)
    if not slow:
        return plain
    lengths = np.diff(marks)
    arcs = {}
    for corner in slow:
        arc = _fit_arc(corner, lengths, side)
        if arc is not None:
            arcs[corner.number] = arc
    if not arcs:
        return ReplayedWay(line=points, marks=marks, is_sampled=False, slow_corners=tuple(slow))
    line, places = _join(points, arcs)
    bends = measure_line(line, arc_lengths(line)).bend
    still_slow = []
    for corner in slow:
        first, last = places[corner.number]
        speed = _speed_in(bends, first, last, side)
        if speed < corner.asked * (1.0 - _SAME_SPEED):
            still_slow.append(
                SlowCorner(number=corner.number, turn=corner.turn, asked=corner.asked, speed=speed)
            )
    middles = [(first + last) // 2 for first, last in places]
    return ReplayedWay(
        line=line,
        marks=arc_lengths(line)[middles],
        is_sampled=True,
        slow_corners=tuple(still_slow),
    )


def _find_slow_corners(
    points: FloatArray, speeds: FloatArray, waits: BoolArray, marks: FloatArray, side: float
) -> list[SlowCorner]:
    """Returns the corners of the straight lines at which the vehicle is slower than asked.

    The speed to the corner is that of its waypoint, the speed behind it that of the next one.
    """
    line, arc = distinct_points(points)
    if len(line) < 3:
        return []
    sampled = sample_line(line, arc)
    steps = np.diff(points, axis=0)
    headings = elementary.arctan2(steps[:, 1], steps[:, 0])
    found = []
    for number in range(1, len(points) - 1):
        asked = float(min(speeds[number], speeds[number + 1]))
        if waits[number]:
            continue
        at = int(np.argmin(np.abs(sampled.arc - marks[number])))
        speed = _speed_in(sampled.bend, at, at, side)
        if speed < asked * (1.0 - _SAME_SPEED):
            turn = abs(wrap_angle(float(headings[number] - headings[number - 1])))
            found.append(SlowCorner(number=number, turn=turn, asked=asked, speed=speed))
    return found


def _speed_in(bends: FloatArray, first: int, last: int, side: float) -> float:
    """Returns the least speed from a point to another, with those beside them, m/s."""
    bend = float(bends[max(first - 1, 0) : last + 2].max())
    return math.sqrt(side / max(bend, 1e-4))


def _fit_arc(corner: SlowCorner, lengths: FloatArray, side: float) -> _Arc | None:
    """Returns the arc that takes the place of a corner; ``None`` if the corner stays."""
    if not 0.0 < corner.turn <= GENTLE:
        return None
    slope = math.tan(0.5 * corner.turn)
    room = 0.5 * float(min(lengths[corner.number - 1], lengths[corner.number]))
    wide = MOST_CUT / (1.0 / math.cos(0.5 * corner.turn) - 1.0)
    radius = min(_MARGIN * corner.asked**2 / side, room / slope, wide)
    if math.sqrt(side * radius / _MARGIN) <= corner.speed:
        return None
    return _Arc(radius=radius, tangent=radius * slope)


def _join(points: FloatArray, arcs: dict[int, _Arc]) -> tuple[FloatArray, list[tuple[int, int]]]:
    """Returns a line with arcs, and the first and last point of each waypoint on it."""
    pieces: list[FloatArray] = [points[:1]]
    places = [(0, 0)]
    count, here = 1, points[0]
    for number in range(1, len(points)):
        arc, corner = arcs.get(number), points[number]
        begin = corner if arc is None else _toward(corner, points[number - 1], arc.tangent)
        straight = _straight(here, begin)
        pieces.append(straight)
        count += len(straight)
        first = count - 1
        here = begin
        if arc is not None:
            bent = _bent(begin, points[number - 1], corner, points[number + 1], arc)
            pieces.append(bent)
            count += len(bent)
            here = bent[-1]
        places.append((first, count - 1))
    return np.concatenate(pieces), places


def _toward(start: FloatArray, end: FloatArray, distance: float) -> FloatArray:
    step = end - start
    moved: FloatArray = start + step * (distance / float(np.hypot(*step)))
    return moved


def _straight(start: FloatArray, end: FloatArray) -> FloatArray:
    """Returns the points of a straight piece behind its start; none if it has no length."""
    length = float(np.hypot(*(end - start)))
    count = math.ceil(length / SPACING) if length > 1e-6 else 0
    shares = np.arange(1, count + 1, dtype=np.float64)[:, None] / max(count, 1)
    points: FloatArray = start + shares * (end - start)
    return points


def _bent(
    begin: FloatArray, before: FloatArray, corner: FloatArray, behind: FloatArray, arc: _Arc
) -> FloatArray:
    """Returns the points of an arc behind its begin, an even number, so that one is the middle."""
    along = (corner - before) / float(np.hypot(*(corner - before)))
    onward = (behind - corner) / float(np.hypot(*(behind - corner)))
    left = np.array([-along[1], along[0]])
    cross = float(along[0] * onward[1] - along[1] * onward[0])
    turn = 2.0 * math.atan(arc.tangent / arc.radius)
    pieces = 2 * max(2, math.ceil(0.5 * arc.radius * turn / SPACING))
    angles = turn * np.arange(1, pieces + 1, dtype=np.float64) / pieces
    ahead = arc.radius * elementary.sin(angles)
    aside = math.copysign(arc.radius, cross) * (1.0 - elementary.cos(angles))
    points: FloatArray = begin + ahead[:, None] * along + aside[:, None] * left
    return points
