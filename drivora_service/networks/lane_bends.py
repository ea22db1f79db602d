"""Deviation of a lane from its tangents, by which straight boxes must be tolerant in bends."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.road_network import RoadNetwork

SPACING = 0.5
"""Maximum distance between the evaluated places of a lane, metres."""


@lru_cache(maxsize=65_536)
def tangent_gap(network: RoadNetwork, lane: int, reach: float) -> float:
    """Returns the maximum deviation of a lane's centre line from its own tangents, metres.

    Args:
        network: The network.
        lane: Index of the lane.
        reach: Metres along the lane, to both sides of the tangent's point.
    """
    shape = network.lanes[lane].shape
    arc = arc_lengths(shape)
    places = np.unique(np.concatenate((arc, np.arange(0.0, arc[-1], SPACING))))
    points = np.column_stack([np.interp(places, arc, shape[:, axis]) for axis in (0, 1)])
    steps = np.diff(points, axis=0)
    steps /= np.hypot(steps[:, 0], steps[:, 1])[:, None]
    widest = 0.0
    for ahead in range(1, len(points)):
        near = places[ahead:] - places[:-ahead] <= reach + SPACING
        if not near.any():
            break
        offset = (points[ahead:] - points[:-ahead])[near]
        # A pair of places, relative to the tangents at both of them.
        for tangent in (steps[: len(near)], steps[ahead - 1 :]):
            chosen = tangent[near]
            beside = chosen[:, 0] * offset[:, 1] - chosen[:, 1] * offset[:, 0]
            widest = max(widest, float(np.abs(beside).max()))
    return widest
