"""Connections that turn more tightly than a car can.

Road networks join the two directions of a road at its end, or where it was cut out of a larger
map, by a connection whose lane is a half circle of a metre or two. No car can drive it: it would
leave the road.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.road_network import Connection, Lane, RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute

TURNING_RADIUS = 5.0
"""Turning radius of the middle of a passenger car at its full steering angle, metres
(4.3 m for a wheelbase of 2.85 m and 0.61 rad), and a margin to turn the wheel."""

MAX_CUT = 1.5
"""Metres by which the circle of the turning radius may deviate from the path of a turn."""

MISSING_ROOM = 0.75
"""Metres by which a turn that leads back may be tighter than the turning radius."""

REVERSAL = math.radians(150.0)
"""Radians from which on a turn leads back, so that no path can cut its corner."""

MIN_TURN = math.radians(30.0)
"""Radians below which a connection is straight."""

_CHAIN = 8
"""Maximum number of consecutive internal lanes through one junction."""

_REACH = 4.0
"""Metres along the lanes before and after a junction that belong to the turn."""

_WINDOW = 5.0
"""Metres over which a radius is measured: about a car's length."""

_SPACING = 0.25
"""Metres between the points of the line on which it is measured."""

_BEND_MARGIN = 1.0
"""Metres before and after a junction between which the angle of a turn is measured."""


@lru_cache(maxsize=128)
def tight_turns(network: RoadNetwork) -> frozenset[tuple[int, int]]:
    """Returns the connections that no car can drive, as (lane, next lane)."""
    return frozenset(
        (lane.index, link.to_lane)
        for lane in network.lanes
        if lane.drivable and not lane.is_internal
        for link in lane.connections
        if network.lanes[link.to_lane].drivable and is_tight(network, lane, link)
    )


def uses_tight_turn(network: RoadNetwork, route: LaneRoute) -> bool:
    """Returns whether a route leads through a turn that no car can drive."""
    turns = tight_turns(network)
    return any(step in turns for run in route.runs for step in pairwise(run.lanes))


def is_tight(network: RoadNetwork, lane: Lane, link: Connection) -> bool:
    """Returns whether a connection turns more tightly than a car can.

    Args:
        network: The network.
        lane: The lane that the connection leads from, outside junctions.
        link: The connection.
    """
    headings = _headings(_line(network, lane, link))
    window = round(_WINDOW / _SPACING)
    margin = round((_REACH - _BEND_MARGIN) / _SPACING)
    if len(headings) <= window:
        return False
    sharpest = float(np.abs(headings[window:] - headings[:-window]).max())
    turn = abs(float(headings[-1 - margin] - headings[margin]))
    if turn < MIN_TURN or sharpest * TURNING_RADIUS < _WINDOW:
        return False
    missing = TURNING_RADIUS - _WINDOW / sharpest
    if turn >= REVERSAL:
        return missing > MISSING_ROOM
    return missing * (1.0 / math.cos(turn / 2.0) - 1.0) > MAX_CUT


def _line(network: RoadNetwork, lane: Lane, link: Connection) -> FloatArray:
    """Returns the line along the end of a lane, a connection, and the beginning of the next lane.

    The points are ``_SPACING`` apart.
    """
    end = float(lane.arc[-1])
    parts = [_part(lane, max(end - _REACH, 0.0), end)]
    following = network.lanes[link.to_lane]
    while following.is_internal and following.connections and len(parts) < _CHAIN:
        parts.append(following.shape)
        following = network.lanes[following.connections[0].to_lane]
    parts.append(_part(following, 0.0, min(_REACH, float(following.arc[-1]))))
    points = np.concatenate(parts)
    s = arc_lengths(points)
    at = np.arange(0.0, float(s[-1]), _SPACING)
    return np.column_stack((np.interp(at, s, points[:, 0]), np.interp(at, s, points[:, 1])))


def _part(lane: Lane, begin: float, end: float) -> FloatArray:
    inside = (lane.arc > begin) & (lane.arc < end)
    ends = [lane.position_at(s)[:2] for s in (begin, end)]
    return np.concatenate((ends[:1], lane.shape[inside], ends[1:]))


def _headings(line: FloatArray) -> FloatArray:
    """Returns the direction of each step of a line, radians, without jumps of a full turn."""
    steps = np.diff(line, axis=0)
    return np.unwrap(elementary.arctan2(steps[:, 1], steps[:, 0]))
