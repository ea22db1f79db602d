"""The collision test of the step loop: egos' boxes that overlap another actor's."""

from __future__ import annotations

import math
from enum import IntEnum

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.boxes import boxes_overlap
from drivora_service.observations.trace import LEVEL_GAP, Col, SizeCol


class ContactCol(IntEnum):
    """Columns of found contacts: rows in the world."""

    EGO = 0
    OTHER = 1


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
        states: (N, 9) world, columns ``Col``; egos are the first M rows.
        sizes: (N, 2), columns ``SizeCol``.
        present: (N,) whether the actor is in the world.
        active: (M,) whether the ego's part has not ended.
        seen: (M, N) pairs found before; changed in place.
        found: (k, 2) buffer for the pairs, columns ``ContactCol``.

    Returns:
        The number of filled rows of ``found``.
    """
    count = 0
    for i in range(active.shape[0]):
        if not active[i]:
            continue
        x, y = states[i, Col.X], states[i, Col.Y]
        radius = 0.5 * math.hypot(sizes[i, SizeCol.LENGTH], sizes[i, SizeCol.WIDTH])
        for j in range(states.shape[0]):
            if j == i or not present[j] or seen[i, j]:
                continue
            # Not less than the reach below, which takes longer to compute.
            furthest = (
                radius + 0.5 * (sizes[j, SizeCol.LENGTH] + sizes[j, SizeCol.WIDTH]) + _ROUNDING
            )
            if abs(states[j, Col.X] - x) > furthest or abs(states[j, Col.Y] - y) > furthest:
                continue
            reach = radius + 0.5 * math.hypot(sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH])
            if abs(states[j, Col.Z] - states[i, Col.Z]) > LEVEL_GAP:
                continue
            dx, dy = states[j, Col.X] - x, states[j, Col.Y] - y
            if dx * dx + dy * dy >= reach * reach:
                continue
            if (
                boxes_overlap(
                    x,
                    y,
                    states[i, Col.YAW],
                    sizes[i, SizeCol.LENGTH],
                    sizes[i, SizeCol.WIDTH],
                    states[j, Col.X],
                    states[j, Col.Y],
                    states[j, Col.YAW],
                    sizes[j, SizeCol.LENGTH],
                    sizes[j, SizeCol.WIDTH],
                )
                and count < found.shape[0]
            ):
                seen[i, j] = True
                found[count, ContactCol.EGO], found[count, ContactCol.OTHER] = i, j
                count += 1
    return count
