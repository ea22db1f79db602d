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
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.observations.sight import distances_to_boxes, is_hidden_by
from drivora_service.observations.trace import LEVEL_GAP, Col, SizeCol
from drivora_service.simulation.world import WorldFrames


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


class Draw(IntEnum):
    """Columns of an actor's random draws: standard normal, the last one uniform in [0, 1)."""

    X = 0
    Y = 1
    VX = 2
    VY = 3
    DROPOUT = 4


class Seen(NamedTuple):
    """Buffers for the actors that an ego perceives, a row for each.

    Attributes:
        states: (N, 9), columns ``Col``.
        sizes: (N, 2), columns ``SizeCol``.
        kinds: (N,) ``ObjectKind``.
        ids: (N,) rows of the actors in the world.
    """

    states: FloatArray
    sizes: FloatArray
    kinds: IntArray
    ids: IntArray


def empty_seen(count: int) -> Seen:
    """Returns buffers for as many actors."""
    return Seen(
        states=np.zeros((count, len(Col))),
        sizes=np.zeros((count, len(SizeCol))),
        kinds=np.zeros(count, dtype=np.int64),
        ids=np.zeros(count, dtype=np.int64),
    )


@compiled
def perceive(
    ego: int,
    step: int,
    frames: WorldFrames,
    heights: FloatArray,
    kinds: IntArray,
    senses: FloatArray,
    draws: FloatArray,
    seen: Seen,
    sights: IntArray,
) -> int:
    """Fills ``seen`` with the actors that ``ego`` perceives.

    Args:
        ego: Row of the ego.
        step: Index of the frame.
        frames: The frames of the world.
        heights: (N,) metres.
        kinds: (N,) ``ObjectKind``.
        senses: (6,) columns ``Sense``.
        draws: (N, 5), columns ``Draw``; unused without noise.
        seen: Filled.
        sights: (N,) ``Sight`` of every actor, filled.

    Returns:
        The number of actors perceived.
    """
    shown = max(step - int(senses[Sense.LAG]), 0)
    states, present, sizes = frames.states[shown], frames.present[shown], frames.sizes
    seen_states, seen_sizes, seen_kinds, seen_ids = seen.states, seen.sizes, seen.kinds, seen.ids
    position_noise, speed_noise = senses[Sense.POSITION_NOISE], senses[Sense.SPEED_NOISE]
    dropout = senses[Sense.DROPOUT]
    count = 0
    x, y = states[ego, Col.X], states[ego, Col.Y]
    noisy = position_noise > 0.0 or speed_noise > 0.0 or dropout > 0.0
    hides = senses[Sense.HIDES] > 0.0
    near = distances_to_boxes(ego, states, present, sizes)
    blockers = np.empty(states.shape[0] if hides else 0, dtype=np.int64)
    for j in range(states.shape[0]):
        if j == ego or not present[j]:
            sights[j] = Sight.ABSENT
            continue
        if abs(states[j, Col.Z] - states[ego, Col.Z]) > LEVEL_GAP:
            sights[j] = Sight.OTHER_LEVEL
            continue
        if math.hypot(states[j, Col.X] - x, states[j, Col.Y] - y) > senses[Sense.RANGE]:
            sights[j] = Sight.OUT_OF_RANGE
            continue
        if noisy and draws[j, Draw.DROPOUT] < dropout:
            sights[j] = Sight.DROPPED
            continue
        if hides and is_hidden_by(ego, j, near, blockers, states, sizes, heights):
            sights[j] = Sight.HIDDEN
            continue
        sights[j] = Sight.PERCEIVED
        for k in range(states.shape[1]):
            seen_states[count, k] = states[j, k]
        if noisy:
            seen_states[count, Col.X] += position_noise * draws[j, Draw.X]
            seen_states[count, Col.Y] += position_noise * draws[j, Draw.Y]
            seen_states[count, Col.VX] += speed_noise * draws[j, Draw.VX]
            seen_states[count, Col.VY] += speed_noise * draws[j, Draw.VY]
        seen_sizes[count, SizeCol.LENGTH] = sizes[j, SizeCol.LENGTH]
        seen_sizes[count, SizeCol.WIDTH] = sizes[j, SizeCol.WIDTH]
        seen_kinds[count] = kinds[j]
        seen_ids[count] = j
        count += 1
    return count
