"""Breaches by the ego: entered on red, off its road, or on the oncoming side."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray
from drivora_service.observations.run_view import BorderCol, EgoView
from drivora_service.observations.trace import Col, EgoCol, Light

OUTSIDE = 0.3
"""Tolerance in metres beyond the road of the ego's own direction (nuPlan)."""


class Breach(StrEnum):
    """A breach by the ego that excludes a careful driver."""

    RED_LIGHT = "red_light"
    """It was inside a junction that it had entered on red."""
    OFF_ITS_SIDE = "off_its_side"
    """It was off the road, or on the side of the other direction."""


def own_breach(ego: EgoView, k: int) -> tuple[Breach, int] | None:
    """Returns the ego's breach in row ``k`` and the row of its beginning; ``None`` without one."""
    astray = _astray(ego)
    if astray[k]:
        begun = k
        while begun > 0 and astray[begun - 1]:
            begun -= 1
        return Breach.OFF_ITS_SIDE, begun
    entered = _find_red_entry(ego, k)
    return None if entered is None else (Breach.RED_LIGHT, entered)


def _astray(ego: EgoView) -> BoolArray:
    """Returns (n,) whether it was off the road, or beyond the road of its direction.

    Inside junctions, where lanes of all directions overlap, only the former counts.
    """
    turn = elementary.cos(ego.states[:, Col.YAW] - ego.value(EgoCol.LANE_HEADING))
    with np.errstate(invalid="ignore"):
        left = ego.room_beside[:, BorderCol.LEFT] < -OUTSIDE
        oncoming = (left | (turn < 0.0)) & ~ego.in_junction
    astray: BoolArray = oncoming | (ego.outside > OUTSIDE)
    return astray


def _find_red_entry(ego: EgoView, k: int) -> int | None:
    """Returns the row in which the ego passed the stop line of its present junction on red."""
    if not ego.in_junction[k]:
        return None
    distance = ego.value(EgoCol.LIGHT_DISTANCE)
    row = k
    while row > 0 and not (distance[row] < 0.0 <= distance[row - 1]):
        if not (ego.in_junction[row] or distance[row] < 0.0):
            return None
        row -= 1
    return row if row and ego.lights[row] == Light.RED else None
