"""Speed profiles that are feasible with limited braking."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.products import moving_mean

SIDE_ACCELERATION = 2.2
"""Lateral acceleration in bends on a dry road, m/s²."""

PLANNED_BRAKING = 1.8
"""Braking for bends and lower limits on a dry road, m/s²."""

LEAST_SPEED = 2.0
"""Speed in the tightest bends, m/s."""

_SMOOTHING = 5
"""Points of a line over which its curvature is averaged."""


def free_speeds(
    line: FloatArray, arc: FloatArray, limits: FloatArray, friction: float
) -> FloatArray:
    """Returns the speed to drive at each point of a line where no other actor is in the way.

    Args:
        line: (n, 2) metres.
        arc: (n,) arc length of each point, metres.
        limits: (n,) greatest speed at each point, m/s.
        friction: Tyre-road friction coefficient, 0..1.

    Returns:
        (n,) m/s.
    """
    step = np.diff(line, axis=0)
    heading = np.unwrap(elementary.arctan2(step[:, 1], step[:, 0]))
    span = np.maximum(np.hypot(step[:, 0], step[:, 1]), 0.2)
    turn = np.abs(np.diff(heading))
    bend = np.zeros(len(line))
    bend[1:-1] = turn / (0.5 * (span[:-1] + span[1:]))
    if len(bend) >= _SMOOTHING:
        padding = np.zeros(_SMOOTHING // 2)
        bend = moving_mean(np.concatenate((padding, bend, padding)), _SMOOTHING)
    side = SIDE_ACCELERATION * friction
    speed = np.minimum(limits, np.sqrt(side / np.maximum(bend, 1e-4)))
    speed = np.maximum(speed, LEAST_SPEED)
    slow_down_in_time(speed, arc, PLANNED_BRAKING * friction)
    return speed


@compiled
def slow_down_in_time(wanted: FloatArray, arc: FloatArray, deceleration: float) -> None:
    """Lowers desired speeds (n,) in place, so that braking at ``deceleration`` suffices."""
    for i in range(wanted.shape[0] - 2, -1, -1):
        reach = math.sqrt(wanted[i + 1] ** 2 + 2.0 * deceleration * (arc[i + 1] - arc[i]))
        wanted[i] = min(wanted[i], reach)


@compiled
def slow_down_within(wanted: FloatArray, arc: FloatArray, decelerations: FloatArray) -> None:
    """Lowers desired speeds (n,) in place, so that braking at the (n,) ``decelerations`` suffices.

    That of a point is available up to the next one.
    """
    for i in range(wanted.shape[0] - 2, -1, -1):
        reach = math.sqrt(wanted[i + 1] ** 2 + 2.0 * decelerations[i] * (arc[i + 1] - arc[i]))
        wanted[i] = min(wanted[i], reach)
