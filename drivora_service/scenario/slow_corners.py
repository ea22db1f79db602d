"""The corners of a replayed vehicle's way that slow it down.

Its way is made of straight lines through its waypoints. A corner of two lines has no radius, so the
vehicle crawls through the gentlest bend of waypoints that lie far apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.geometry.sampled_lines import distinct_points, sample_line

_SAME_SPEED = 1e-9
"""Share by which a speed may be less than asked without being slower."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SlowCorner:
    """A waypoint at which a vehicle is slower than its waypoints ask.

    Attributes:
        number: Number of the waypoint, from 0.
        turn: Radians by which the straight lines turn there, not negative.
        asked: m/s.
        speed: m/s that the lateral acceleration allows.
    """

    number: int
    turn: float
    asked: float
    speed: float


def find_slow_corners(
    points: FloatArray, speeds: FloatArray, waits: BoolArray, side: float
) -> list[SlowCorner]:
    """Returns the corners of the straight lines at which the vehicle is slower than asked.

    The speed to the corner is that of its waypoint, the speed behind it that of the next one.

    Args:
        points: (w, 2) waypoints, metres.
        speeds: (w,) m/s.
        waits: (w,) whether the vehicle stands at the waypoint.
        side: Lateral acceleration that it uses, m/s².
    """
    marks = arc_lengths(points)
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
        speed = _speed_at(sampled.bend, at, side)
        if speed < asked * (1.0 - _SAME_SPEED):
            turn = abs(wrap_angle(float(headings[number] - headings[number - 1])))
            found.append(SlowCorner(number=number, turn=turn, asked=asked, speed=speed))
    return found


def _speed_at(bends: FloatArray, at: int, side: float) -> float:
    """Returns the least speed at a point and those beside it, m/s."""
    bend = float(bends[max(at - 1, 0) : at + 2].max())
    return math.sqrt(side / max(bend, 1e-4))
