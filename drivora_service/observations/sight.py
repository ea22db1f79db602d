"""Occlusion of actors: the line of sight from an ego's roof past the boxes of others.

An actor is hidden if the lines of sight to the top of its box, at its centre and at each corner,
all pass through other actors. Buildings hide no actors, since road networks have none.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.observations.trace import LEVEL_GAP, Col, SizeCol

_ABOVE_ROOF = 0.2
"""Metres."""
_EDGE = 1e-9
_ASKED = ((0.0, 0.0), (0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5))
"""The points of a box whose lines of sight are checked: its centre and its corners, as shares of
its length along the heading and of its width to the left."""
_CLEAR = 1e-3
"""Metres by which the quick check of lines of sight is wider than the exact one."""


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
        states: (N, 9) states of one frame, columns ``Col``.
        present: (N,) whether each actor is in the world.
        sizes: (N, 2), columns ``SizeCol``.
        heights: (N,) metres.
    """
    near = distances_to_boxes(ego, states, present, sizes)
    blockers = np.empty(states.shape[0], dtype=np.int64)
    return is_hidden_by(ego, other, near, blockers, states, sizes, heights)


@compiled
def distances_to_boxes(
    ego: int, states: FloatArray, present: BoolArray, sizes: FloatArray
) -> FloatArray:
    """Returns the (N,) metres from an ego's centre to the circles around the boxes of others.

    Infinite for actors that cannot hide others from it: the absent, those on another level, and
    the ego itself.
    """
    near = np.full(states.shape[0], np.inf)
    for k in range(states.shape[0]):
        if k == ego or not present[k]:
            continue
        if abs(states[k, Col.Z] - states[ego, Col.Z]) > LEVEL_GAP:
            continue
        half = 0.5 * math.hypot(sizes[k, SizeCol.LENGTH], sizes[k, SizeCol.WIDTH])
        gap = math.hypot(
            states[k, Col.X] - states[ego, Col.X], states[k, Col.Y] - states[ego, Col.Y]
        )
        near[k] = gap - half
    return near


@compiled
def is_hidden_by(
    ego: int,
    other: int,
    near: FloatArray,
    blockers: IntArray,
    states: FloatArray,
    sizes: FloatArray,
    heights: FloatArray,
) -> bool:
    """Returns whether ``other`` is hidden, as ``is_hidden``, from known distances.

    Args:
        ego: Row of the ego.
        other: Row of the actor to check.
        near: (N,) as of ``distances_to_boxes``.
        blockers: (N,) scratch space.
        states: (N, 9) states of one frame, columns ``Col``.
        sizes: (N, 2), columns ``SizeCol``.
        heights: (N,) metres.
    """
    eye = heights[ego] + _ABOVE_ROOF
    lowest = min(eye, heights[other])
    x, y = states[other, Col.X], states[other, Col.Y]
    length, width = sizes[other, SizeCol.LENGTH], sizes[other, SizeCol.WIDTH]
    dx, dy = x - states[ego, Col.X], y - states[ego, Col.Y]
    away = math.hypot(dx, dy)
    reach = away + 0.5 * math.hypot(length, width)
    count = 0
    for k in range(near.shape[0]):
        if k == other or heights[k] <= lowest or not near[k] < reach:
            continue
        if _is_beside(ego, other, k, dx, dy, away, states, sizes):
            continue
        blockers[count] = k
        count += 1
    if count == 0:
        return False
    cos, sin = math.cos(states[other, Col.YAW]), math.sin(states[other, Col.YAW])
    for along, across in _ASKED:
        forward, left = along * length, across * width
        px = x + forward * cos - left * sin
        py = y + forward * sin + left * cos
        in_sight = True
        for b in range(count):
            if _cuts(px, py, heights[other], eye, ego, blockers[b], states, sizes, heights):
                in_sight = False
                break
        if in_sight:
            return False
    return True


@compiled
def _is_beside(
    ego: int,
    other: int,
    k: int,
    dx: float,
    dy: float,
    away: float,
    states: FloatArray,
    sizes: FloatArray,
) -> bool:
    """Returns whether actor ``k`` is certainly beside or behind all lines of sight to ``other``.

    They end in the circle around its box, ``away`` metres from the ego in direction (dx, dy).
    """
    to_x, to_y = states[k, Col.X] - states[ego, Col.X], states[k, Col.Y] - states[ego, Col.Y]
    # Half the sum of length and width is more than the radius of the circle around a box.
    one, two = sizes[k], sizes[other]
    spans = one[SizeCol.LENGTH] + one[SizeCol.WIDTH] + two[SizeCol.LENGTH] + two[SizeCol.WIDTH]
    both = 0.5 * spans + _CLEAR
    if abs(dx * to_y - dy * to_x) > both * away:
        return True
    return bool(dx * to_x + dy * to_y < -both * away)


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
    x, y = states[k, Col.X], states[k, Col.Y]
    cos, sin = math.cos(states[k, Col.YAW]), math.sin(states[k, Col.YAW])
    dx, dy = states[ego, Col.X] - x, states[ego, Col.Y] - y
    from_x, from_y = dx * cos + dy * sin, dy * cos - dx * sin
    dx, dy = px - x, py - y
    to_x, to_y = dx * cos + dy * sin, dy * cos - dx * sin
    enter, leave = 0.0, 1.0
    for axis in range(2):
        begin, end = (from_x, to_x) if axis == SizeCol.LENGTH else (from_y, to_y)
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
