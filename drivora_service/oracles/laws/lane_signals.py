"""Signals of the lanes that an ego drives on."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.run_view import EgoView

_BETWEEN = 1.0
"""Seconds for which an ego that changes lanes may be on neither."""


def has_lane_beside(ego: EgoView, *, left: bool, right: bool) -> FloatArray:
    """Returns the (n,) rows with a lane of the same direction on exactly the given sides."""
    found = np.zeros(ego.count)
    for index in np.unique(ego.lanes).tolist():
        if index < 0 or ego.network.lanes[index].is_internal:
            continue
        lane = ego.network.lanes[index]
        if (lane.left >= 0, lane.right >= 0) == (left, right):
            found[ego.lanes == index] = 1.0
    return found


def lane_change(ego: EgoView, *, to_left: bool) -> FloatArray:
    """Returns the (n,) rows in which the lane is the one beside that of the row before.

    Between two lanes the centre may be on neither for a moment.
    """
    found = np.zeros(ego.count)
    lanes = ego.network.lanes
    known = np.flatnonzero(ego.lanes >= 0)
    on = ego.lanes[known]
    for place in (np.flatnonzero(np.diff(on)) + 1).tolist():
        row, before = known[place], lanes[int(on[place - 1])]
        if (row - known[place - 1]) * ego.step_length > _BETWEEN:
            continue
        beside = before.left if to_left else before.right
        found[row] = beside >= 0 and beside == on[place]
    return found
