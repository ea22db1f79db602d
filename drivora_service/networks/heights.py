"""Heights of lines: roads that cross on bridges share a place in the plane, but not the level."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.road_network import RoadNetwork


@lru_cache(maxsize=128)
def is_flat(network: RoadNetwork) -> bool:
    """Returns whether all lanes are at height 0."""
    return not any(lane.heights.any() for lane in network.lanes)


def line_heights(network: RoadNetwork, line: FloatArray, lanes: IntArray) -> FloatArray:
    """Returns the heights of points on known lanes.

    Args:
        network: The road network.
        line: (n, 2) metres.
        lanes: (n,) index of the lane that each point lies on; negative: no lane, the point takes
            the height of the preceding point.

    Returns:
        (n,) metres.
    """
    heights = np.zeros(len(line))
    if is_flat(network) or not len(line):
        return heights
    for index in np.unique(lanes[lanes >= 0]).tolist():
        lane = network.lanes[index]
        here = np.flatnonzero(lanes == index)
        gaps = np.hypot(
            line[here, None, 0] - lane.shape[None, :, 0],
            line[here, None, 1] - lane.shape[None, :, 1],
        )
        heights[here] = lane.heights[np.argmin(gaps, axis=1)]
    known = lanes >= 0
    if known.all() or not known.any():
        return heights
    last = np.maximum.accumulate(np.where(known, np.arange(len(line)), 0))
    last[: int(np.argmax(known))] = int(np.argmax(known))
    return heights[last]
