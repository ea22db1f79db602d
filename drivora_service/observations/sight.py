"""Occlusion of actors: the line of sight from an ego's roof past the boxes of others.

An actor is hidden if the lines of sight to the top of its box, at its centre and at each corner,
all pass through other actors. Buildings hide no actors, since road networks have none.
"""

from __future__ import annotations

import math

from drivora_service.compilation import compiled
from drivora_service.geometry.arrays import BoolArray, FloatArray
from drivora_service.observations.trace import LEVEL_GAP

_ABOVE_ROOF = 0.2
"""Metres."""
_EDGE = 1e-9


@compiled
def is_hidden(
    ego: int,
    other: int,
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    heights: FloatArray,
) -> bool:
    """Returns whether ``other`` is hidden from the sensor on the roof of ``ego``.

    Args:
        ego: Row of the ego.
        other: Row of the actor to check.
        states: (N, 9) states of one frame.
        present: (N,) whether each actor is in the world.
        sizes: (N, 2) length and width, metres.
        heights: (N,) metres.
    """
    eye = heights[ego] + _ABOVE_ROOF
    lowest = min(eye, heights[other])
    reach = math.hypot(states[other, 0] - states[ego, 0], states[other, 1] - states[ego, 1])
    reach += 0.5 * math.hypot(sizes[other, 0], sizes[other, 1])
    nobody_between = True
    for k in range(states.shape[0]):
        if _may_hide(ego, other, k, lowest, reach, states, present, sizes, heights):
            nobody_between = False
            break
    if nobody_between:
        return False
    for point in range(5):
        along = 0.0 if point == 0 else (0.5 if point < 3 else -0.5)
        across = 0.0 if point == 0 else (0.5 if point % 2 else -0.5)
        cos, sin = math.cos(states[other, 2]), math.sin(states[other, 2])
        forward, left = along * sizes[other, 0], across * sizes[other, 1]
        px = states[other, 0] + forward * cos - left * sin
        py = states[other, 1] + forward * sin + left * cos
        in_sight = True
        for k in range(states.shape[0]):
            if not _may_hide(ego, other, k, lowest, reach, states, present, sizes, heights):
                continue
            if _cuts(px, py, heights[other], eye, ego, k, states, sizes, heights):
                in_sight = False
                break
        if in_sight:
            return False
    return True


@compiled
def _may_hide(
    ego: int,
    other: int,
    k: int,
    lowest: float,
    reach: float,
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    heights: FloatArray,
) -> bool:
    """Returns the result of a quick check: tall enough, on the same level, and near enough."""
    if k in (ego, other) or not present[k] or heights[k] <= lowest:
        return False
    if abs(states[k, 8] - states[ego, 8]) > LEVEL_GAP:
        return False
    half = 0.5 * math.hypot(sizes[k, 0], sizes[k, 1])
    gap = math.hypot(states[k, 0] - states[ego, 0], states[k, 1] - states[ego, 1])
    return gap - half < reach


@compiled
def _cuts(
    px: float,
    py: float,
    top: float,
    eye: float,
    ego: int,
    k: int,
    states: FloatArray,
    sizes: FloatArray,
    heights: FloatArray,
) -> bool:
    """Returns whether the line from the eye to a point passes through the box of actor ``k``."""
    cos, sin = math.cos(states[k, 2]), math.sin(states[k, 2])
    dx, dy = states[ego, 0] - states[k, 0], states[ego, 1] - states[k, 1]
    from_x, from_y = dx * cos + dy * sin, dy * cos - dx * sin
    dx, dy = px - states[k, 0], py - states[k, 1]
    to_x, to_y = dx * cos + dy * sin, dy * cos - dx * sin
    enter, leave = 0.0, 1.0
    for axis in range(2):
        begin, end = (from_x, to_x) if axis == 0 else (from_y, to_y)
        half, step = 0.5 * sizes[k, axis], end - begin
        if abs(step) < _EDGE:
            if abs(begin) >= half:
                return False
            continue
        one, two = (-half - begin) / step, (half - begin) / step
        enter, leave = max(enter, min(one, two)), min(leave, max(one, two))
    if leave - enter < _EDGE:
        return False
    # The line rises or falls evenly, so it is lowest where it enters the box or leaves it.
    lowest = min(eye + enter * (top - eye), eye + leave * (top - eye))
    return bool(lowest < heights[k])
