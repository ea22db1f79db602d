"""The collision test of the step loop: egos' boxes that overlap another actor's."""

from __future__ import annotations

import math

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.boxes import boxes_overlap
from drivora_service.observations.trace import LEVEL_GAP

_ROUNDING = 1e-3
"""Metres by which the quick check of distances is wider than the exact one."""


@compiled
def find_contacts(
    states: FloatArray,
    sizes: FloatArray,
    present: BoolArray,
    active: BoolArray,
    seen: BoolArray,
    found: IntArray,
) -> int:
    """Finds pairs (ego, other) that overlap and were not found before.

    Args:
        states: (N, 9) world; egos are the first M rows.
        sizes: (N, 2) length and width, metres.
        present: (N,) whether the actor is in the world.
        active: (M,) whether the ego's part has not ended.
        seen: (M, N) pairs found before; changed in place.
        found: (k, 2) buffer for the pairs.

    Returns:
        The number of filled rows of ``found``.
    """
    count = 0
    for i in range(active.shape[0]):
        if not active[i]:
            continue
        x, y = states[i, 0], states[i, 1]
        radius = 0.5 * math.hypot(sizes[i, 0], sizes[i, 1])
        for j in range(states.shape[0]):
            if j == i or not present[j] or seen[i, j]:
                continue
            # Not less than the reach below, which takes longer to compute.
            furthest = radius + 0.5 * (sizes[j, 0] + sizes[j, 1]) + _ROUNDING
            if abs(states[j, 0] - x) > furthest or abs(states[j, 1] - y) > furthest:
                continue
            reach = radius + 0.5 * math.hypot(sizes[j, 0], sizes[j, 1])
            if abs(states[j, 8] - states[i, 8]) > LEVEL_GAP:
                continue
            dx, dy = states[j, 0] - x, states[j, 1] - y
            if dx * dx + dy * dy >= reach * reach:
                continue
            if (
                boxes_overlap(
                    x,
                    y,
                    states[i, 2],
                    sizes[i, 0],
                    sizes[i, 1],
                    states[j, 0],
                    states[j, 1],
                    states[j, 2],
                    sizes[j, 0],
                    sizes[j, 1],
                )
                and count < found.shape[0]
            ):
                seen[i, j] = True
                found[count, 0], found[count, 1] = i, j
                count += 1
    return count
