"""Ways of egos through junctions, as lines."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from shapely import LineString

from drivora_service.networks.right_of_way import Movement
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col

_AHEAD = 80.0
"""Metres behind a junction up to which a way is followed."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JunctionPath:
    """A way through a junction.

    Attributes:
        line: Its middle, from the lane before the junction on, metres.
        behind: Metres along ``line`` to the first lane behind the junction.
    """

    line: LineString
    behind: float


def line_through(network: RoadNetwork, lanes: tuple[int, ...]) -> LineString:
    """Returns the middle of lanes that lead into one another."""
    points = np.concatenate([network.lanes[lane].shape for lane in lanes])
    return LineString(points[np.concatenate(([True], np.any(np.diff(points, axis=0), axis=1)))])


def path_of(network: RoadNetwork, movement: Movement) -> JunctionPath:
    """Returns the way of a movement, straight on where it is followed further."""
    before = (movement.incoming,) if movement.incoming >= 0 else ()
    lanes = [*before, *movement.lanes]
    behind = line_through(network, tuple(lanes)).length
    length = 0.0
    while length < _AHEAD and network.lanes[lanes[-1]].connections:
        connections = network.lanes[lanes[-1]].connections
        straight = [one for one in connections if one.direction == "s"]
        following = (straight or list(connections))[0].to_lane
        if following in lanes:
            break
        lanes.append(following)
        length += float(network.lanes[following].arc[-1])
    return JunctionPath(line=line_through(network, tuple(lanes)), behind=behind)


def path_straight_on(ego: EgoView, row: int) -> JunctionPath:
    """Returns the way straight on of an ego that follows no movement."""
    x, y = ego.location(row)
    yaw = float(ego.states[row, Col.YAW])
    ahead = (x + _AHEAD * math.cos(yaw), y + _AHEAD * math.sin(yaw))
    return JunctionPath(line=LineString([(x, y), ahead]), behind=0.5 * _AHEAD)
