"""The speeds of NPCs at their waypoints, and what vehicles may use of the grip in bends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.projection import nearest_lane_position
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.scenario.model import Waypoint

GRAVITY = 9.81
"""m/s²."""
OFF_ROAD_SPEED = 8.0
"""m/s at waypoints without a speed that lie beside all lanes."""
SIDE_GRIP_SHARE = 0.6
"""Share of the grip that a vehicle uses in bends, unless it has another one."""
_MOST_SIDE_SHARE = 0.9
"""Greatest such share: some grip is left for braking, and for the corners of the line."""


def most_lateral(lateral_acceleration: float | None, friction: float) -> float:
    """Returns the lateral acceleration that a vehicle uses on a road, m/s²."""
    grip = friction * GRAVITY
    if lateral_acceleration is None:
        return SIDE_GRIP_SHARE * grip
    return min(lateral_acceleration, _MOST_SIDE_SHARE * grip)


def waypoint_speeds(
    waypoints: Sequence[Waypoint], network: RoadNetwork, default: float | None
) -> FloatArray:
    """Returns the (w,) speeds at waypoints, m/s.

    Args:
        waypoints: The waypoints.
        network: The road network.
        default: Speed at those without one, m/s; ``None``: the limit of the nearest lane.
    """
    speeds = []
    for point in waypoints:
        if point.speed is not None:
            speeds.append(point.speed)
        elif default is not None:
            speeds.append(default)
        else:
            place = nearest_lane_position(network, point.x, point.y)
            limit = OFF_ROAD_SPEED if place is None else network.lanes[place.lane].speed_limit
            speeds.append(limit)
    return np.array(speeds)
