"""The time from an ego's leaving a place to another actor's being there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Col


class _Box(NamedTuple):
    """Length and width of an actor, metres."""

    length: float
    width: float


def least_lag(ego: EgoView, other: int, first: int, leaves: int, last: int) -> float:
    """Returns the least seconds from the ego's being at a place to the other's being there."""
    actor = ego.trace.actors[other]
    rows = slice(ego.first, ego.first + ego.count)
    steps = _least_rows(
        ego.states,
        np.ascontiguousarray(ego.trace.states[rows, other]),
        np.ascontiguousarray(ego.trace.present[rows, other]),
        _Box(ego.actor.length, ego.actor.width),
        _Box(actor.length, actor.width),
        first,
        leaves,
        last,
    )
    return math.inf if steps < 0 else steps * ego.step_length


@compiled
def _least_rows(
    ego: FloatArray,
    other: FloatArray,
    present: BoolArray,
    own_box: _Box,
    box: _Box,
    first: int,
    leaves: int,
    last: int,
) -> int:
    """Returns the least rows from the ego's being at a place to the other's being there; or -1.

    Args:
        ego: (n, 9) its states, columns ``Col``.
        other: (n, 9) states of the other.
        present: (n,) flags of the other.
        own_box: Of the ego.
        box: Of the other.
        first: First row of the ego's places.
        leaves: Last row of its places.
        last: Last row of the other's.
    """
    best = last - first + 1
    reach = 0.5 * (math.hypot(own_box.length, own_box.width) + math.hypot(box.length, box.width))
    for t in range(first, leaves + 1):
        for u in range(t, min(t + best, last + 1)):
            if not present[u] or abs(other[u, Col.Z] - ego[t, Col.Z]) > LEVEL_GAP:
                continue
            dx, dy = other[u, Col.X] - ego[t, Col.X], other[u, Col.Y] - ego[t, Col.Y]
            if math.hypot(dx, dy) > reach:
                continue
            depth = overlap_depth(
                dx, dy, ego[t, Col.YAW], own_box.length, own_box.width,
                other[u, Col.YAW], box.length, box.width,
            )  # fmt: skip
            if depth > 0.0:
                best = u - t
                break
    return best if best <= last - first else -1
