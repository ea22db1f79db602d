"""What an ego perceives of the others: within range, noisy, sometimes missed.

Actors on another level of a bridge are not shown: agents think in the plane. Range, noise and
drop-out come from the weather (``scenario.weather``). In clear weather nothing is
drawn and nothing is changed but for the range.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drivora_service.compilation import compiled
from drivora_service.observations.trace import LEVEL_GAP

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@compiled
def perceive(
    ego: int,
    step: int,
    frames: FloatArray,
    presence: BoolArray,
    sizes: FloatArray,
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
        kinds: (N,) kind of each actor.
        senses: (4,) range in metres, standard deviations of x and y in metres and of vx and vy in
            m/s, and the probability that an actor is missed at a step.
        draws: (N, 5) four standard normal and one uniform draw an actor; unused without noise.
        seen: (N, 9) filled.
        seen_sizes: (N, 2) filled.
        seen_numbers: (2, N) filled with the actors' kinds and rows.

    Returns:
        The number of actors perceived.
    """
    states, present = frames[step], presence[step]
    reach, position_noise, speed_noise, dropout = senses[0], senses[1], senses[2], senses[3]
    count = 0
    x, y = states[ego, 0], states[ego, 1]
    noisy = position_noise > 0.0 or speed_noise > 0.0 or dropout > 0.0
    for j in range(states.shape[0]):
        if j == ego or not present[j]:
            continue
        if abs(states[j, 8] - states[ego, 8]) > LEVEL_GAP:
            continue
        if math.hypot(states[j, 0] - x, states[j, 1] - y) > reach:
            continue
        if noisy and draws[j, 4] < dropout:
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
