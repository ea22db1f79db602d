"""Room beside a lane run: to the edge of the road, and to oncoming traffic."""

from __future__ import annotations

from enum import IntEnum
from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.drivable_area import near_area
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRun

_SAMPLES = np.arange(1.0, 3.6, 0.25)
"""Distances beside the line at which the road is checked, metres."""
_EVERY = 2
"""Interval of the checked points of a run's line."""


class MarginCol(IntEnum):
    """Columns of the room beside a line, metres."""

    LEFT = 0
    """To the edge of the drivable area; inf if it is far."""
    RIGHT = 1
    ONCOMING = 2
    """To the left edge of the lanes of this direction; inf inside a junction."""


@lru_cache(maxsize=256)
def side_margins(network: RoadNetwork, run: LaneRun) -> FloatArray:
    """Returns the room beside a run's line; must not be changed.

    Returns:
        (n, 3) metres from each point of the line, columns ``MarginCol``.
    """
    points = run.line[::_EVERY]
    step = np.gradient(run.line, axis=0)[::_EVERY]
    normal = np.column_stack((-step[:, 1], step[:, 0]))
    normal /= np.maximum(np.hypot(normal[:, 0], normal[:, 1]), 1e-9)[:, None]
    margins = np.empty((len(run.line), 3))
    for column, sign in ((MarginCol.LEFT, 1.0), (MarginCol.RIGHT, -1.0)):
        spread = points[:, None, :] + sign * _SAMPLES[None, :, None] * normal[:, None, :]
        inside = near_area(network, spread.reshape(-1, 2), 0.0).reshape(len(points), -1)
        first = np.where(inside.all(axis=1), len(_SAMPLES), np.argmin(inside, axis=1))
        reach = np.append(_SAMPLES - 0.125, np.inf)[first]
        margins[:, column] = np.repeat(reach, _EVERY)[: len(margins)]
    margins[:, MarginCol.ONCOMING] = _to_oncoming(network, run)
    return margins


def _to_oncoming(network: RoadNetwork, run: LaneRun) -> FloatArray:
    """Returns the metres from each point of a run to the left edge of its direction's lanes."""
    lengths = np.array([float(network.lanes[lane].arc[-1]) for lane in run.lanes])
    ends = np.cumsum(lengths) * (float(run.arc[-1]) / max(float(lengths.sum()), 1e-9))
    widths = []
    for index in run.lanes:
        lane = network.lanes[index]
        width = np.inf if lane.is_internal else 0.5 * lane.width
        while lane.left >= 0 and not lane.is_internal:
            lane = network.lanes[lane.left]
            width += lane.width
        widths.append(width)
    return np.array(widths)[np.minimum(np.searchsorted(ends, run.arc), len(widths) - 1)]
