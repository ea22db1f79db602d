"""Places on lanes, for documents in tests."""

from __future__ import annotations

import math
from typing import Any

from drivora_service.networks.road_network import RoadNetwork


def on_lane(network: RoadNetwork, lane_id: str, s: float, **more: Any) -> dict[str, Any]:
    """A waypoint on the centre of a lane, ``s`` metres from its start."""
    x, y, _ = network.lane(lane_id).position_at(s)
    return {"x": x, "y": y, **more}


def beside_lane(network: RoadNetwork, lane_id: str, s: float, right: float) -> dict[str, Any]:
    """A waypoint ``right`` metres to the right of a lane's centre."""
    x, y, yaw = network.lane(lane_id).position_at(s)
    return {"x": x + right * math.sin(yaw), "y": y - right * math.cos(yaw)}
