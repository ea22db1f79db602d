"""An ego's perception of other actors: range, occlusion, noise, latency and drop-out.

The sensor is on the ego's roof. Hidden actors are not perceived: those for which the lines of sight
to the top of the box, at its centre and at each corner, all pass through other actors. Buildings
hide no actors, since road networks have none. Actors on another level of a bridge are not
perceived: agents work in the plane. Range, noise, drop-out and latency come from the weather
(``scenario.weather``). In clear weather no random numbers are drawn, and only range and occlusion
have an effect.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.observations.sight import distances_to_boxes, is_hidden_by
from drivora_service.observations.trace import LEVEL_GAP


class Sense(IntEnum):
    """Columns of an ego's perception parameters."""

    RANGE = 0
    """Metres."""
    POSITION_NOISE = 1
    """Standard deviation of x and y, metres."""
    SPEED_NOISE = 2
    """Standard deviation of vx and vy, m/s."""
    DROPOUT = 3
    """Probability that an actor is missed at a step."""
    LAG = 4
    """Latency in steps."""
    HIDES = 5
    """Whether actors hide each other."""


class Sight(IntEnum):
    """What an ego's perception makes of an actor at a step."""

    ABSENT = 0
    """It is not in the world of the perceived frame, or is the ego itself."""
    PERCEIVED = 1
    OTHER_LEVEL = 2
    """It is on another level of a bridge."""
    OUT_OF_RANGE = 3
    DROPPED = 4
    """Missed by chance."""
    HIDDEN = 5
    """Other actors hide it."""


_ABSENT, _PERCEIVED, _OTHER_LEVEL = int(Sight.ABSENT), int(Sight.PERCEIVED), int(Sight.OTHER_LEVEL)
_OUT_OF_RANGE, _DROPPED = int(Sight.OUT_OF_RANGE), int(Sight.DROPPED)
_HIDDEN = int(Sight.HIDDEN)
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
    sights: IntArray,
) -> int:
    """Fills the arrays with the actors that ``ego`` perceives.

    Args:
        ego: Row of the ego.
        step: Index of the frame.
        frames: (rows, N, 9) frames of the world.
        presence: (rows, N) whether each actor is in the world.
        sizes: (N, 2) length and width, metres.
        heights: (N,) metres.
        kinds: (N,) kind of each actor.
        senses: (6,) columns ``Sense``.
        draws: (N, 5) four standard normal and one uniform draw for each actor; unused without
            noise.
        seen: (N, 9) states, filled.
        seen_sizes: (N, 2) sizes, filled.
        seen_numbers: (2, N) kinds and rows of the actors, filled.
        sights: (N,) ``Sight`` of every actor, filled.

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
    hides = senses[_HIDES] > 0.0
    near = distances_to_boxes(ego, states, present, sizes)
    blockers = np.empty(states.shape[0] if hides else 0, dtype=np.int64)
    for j in range(states.shape[0]):
        if j == ego or not present[j]:
            sights[j] = _ABSENT
            continue
        if abs(states[j, 8] - states[ego, 8]) > LEVEL_GAP:
            sights[j] = _OTHER_LEVEL
            continue
        if math.hypot(states[j, 0] - x, states[j, 1] - y) > senses[_RANGE]:
            sights[j] = _OUT_OF_RANGE
            continue
        if noisy and draws[j, 4] < dropout:
            sights[j] = _DROPPED
            continue
        if hides and is_hidden_by(ego, j, near, blockers, states, sizes, heights):
            sights[j] = _HIDDEN
            continue
        sights[j] = _PERCEIVED
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
