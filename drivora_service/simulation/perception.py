"""What an ego perceives of the others: within range, in sight, noisy, late, sometimes not at all.

The sensor is on the ego's roof. Who is hidden behind others is not perceived: of neither the centre
nor a corner of an actor's box does the line of sight to its top pass above or beside all others.
Buildings hide nobody, for road networks have none. Actors on another level of a bridge are not
shown: agents think in the plane. Range, noise, drop-out and latency come from the weather
(``scenario.weather``). In clear weather nothing is drawn, and nothing is changed but for the range
and the hidden.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from drivora_service.compilation import compiled
from drivora_service.observations.trace import LEVEL_GAP

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_ABOVE_ROOF = 0.2
"""Metres."""
_EDGE = 1e-9


class Sense(IntEnum):
    """Columns of how an ego perceives."""

    RANGE = 0
    """Metres."""
    POSITION_NOISE = 1
    """Standard deviation of x and y, metres."""
    SPEED_NOISE = 2
    """Standard deviation of vx and vy, m/s."""
    DROPOUT = 3
    """Probability that an actor is missed at a step."""
    LAG = 4
    """Steps by which what is perceived is old."""
    HIDES = 5
    """Whether actors hide one another."""


_RANGE, _LAG, _HIDES = int(Sense.RANGE), int(Sense.LAG), int(Sense.HIDES)
_POSITION_NOISE, _SPEED_NOISE = int(Sense.POSITION_NOISE), int(Sense.SPEED_NOISE)
_DROPOUT = int(Sense.DROPOUT)


@compiled
def perceive(
    ego: int,
    step: int,
    frames: FloatArray,
    presence: BoolArray,
    sizes: FloatArray,
    heights: FloatArray,
    kinds: IntArray,
    senses: FloatArray,
    draws: FloatArray,
    seen: FloatArray,
    seen_sizes: FloatArray,
    seen_numbers: IntArray,
) -> int:
    """Fills the arrays of what ``ego`` perceives.

    Args:
        ego: Row of the ego.
        step: Index of the frame.
        frames: (rows, N, 9) frames of the world.
        presence: (rows, N) whether each actor is in the world.
        sizes: (N, 2) length and width, metres.
        heights: (N,) metres.
        kinds: (N,) kind of each actor.
        senses: (6,) columns ``Sense``.
        draws: (N, 5) four standard normal and one uniform draw an actor; unused without noise.
        seen: (N, 9) filled.
        seen_sizes: (N, 2) filled.
        seen_numbers: (2, N) filled with the actors' kinds and rows.

    Returns:
        The number of actors perceived.
    """
    shown = max(step - int(senses[_LAG]), 0)
    states, present = frames[shown], presence[shown]
    position_noise, speed_noise = senses[_POSITION_NOISE], senses[_SPEED_NOISE]
    dropout = senses[_DROPOUT]
    count = 0
    x, y = states[ego, 0], states[ego, 1]
    noisy = position_noise > 0.0 or speed_noise > 0.0 or dropout > 0.0
    for j in range(states.shape[0]):
        if j == ego or not present[j]:
            continue
        if abs(states[j, 8] - states[ego, 8]) > LEVEL_GAP:
            continue
        if math.hypot(states[j, 0] - x, states[j, 1] - y) > senses[_RANGE]:
            continue
        if noisy and draws[j, 4] < dropout:
            continue
        if senses[_HIDES] > 0.0 and is_hidden(ego, j, states, present, sizes, heights):
            continue
        for k in range(states.shape[1]):
            seen[count, k] = states[j, k]
        if noisy:
            seen[count, 0] += position_noise * draws[j, 0]
            seen[count, 1] += position_noise * draws[j, 1]
            seen[count, 3] += speed_noise * draws[j, 2]
            seen[count, 4] += speed_noise * draws[j, 3]
        seen_sizes[count, 0] = sizes[j, 0]
        seen_sizes[count, 1] = sizes[j, 1]
        seen_numbers[0, count] = kinds[j]
        seen_numbers[1, count] = j
        count += 1
    return count


@compiled
def is_hidden(
    ego: int,
    other: int,
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    heights: FloatArray,
) -> bool:
    """Tells whether nothing of ``other`` is in sight of the sensor on the roof of ``ego``.

    Args:
        ego: Row of the ego.
        other: Row of the actor looked for.
        states: (N, 9) one frame.
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
    """Tells without looking closely: tall enough, on the same level, and near enough."""
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
    """Tells whether the line from the eye to a point passes through the box of actor ``k``."""
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
