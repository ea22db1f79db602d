"""Markings at the borders of lanes, as they follow from a network.

SUMO's networks have no markings. They follow from what is on the other side of a border: a lane of
the same direction, with or without a permitted change, the other direction, or nothing.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from drivora_service.geometry.arrays import FloatArray
from drivora_service.geometry.lines import offset_line
from drivora_service.networks.road_details import RoadDetails, road_details
from drivora_service.networks.road_network import Lane, RoadNetwork

_SAME_BORDER = 0.6
"""Metres between the borders of two directions up to which they are one."""


class Marking(StrEnum):
    """A line at the border of a lane."""

    NONE = "none"
    BROKEN = "broken"
    """To a lane of the same direction; a change is allowed."""
    SOLID = "solid"
    """To a lane of the same direction; a change is not allowed."""
    CENTRE = "centre"
    """To a lane of the opposite direction."""
    EDGE = "edge"
    """To what cars do not drive on."""


def lane_markings(network: RoadNetwork) -> tuple[tuple[Marking, Marking], ...]:
    """Returns the left and the right marking of every lane, by the lane's index.

    Lanes inside junctions and lanes that are not open to cars have none.
    """
    details = road_details(network)
    centred = _edges_beside_opposite(network, details)
    return tuple(_markings(lane, details, centred) for lane in network.lanes)


def _markings(lane: Lane, details: RoadDetails, centred: frozenset[str]) -> tuple[Marking, Marking]:
    if lane.is_internal or not lane.drivable:
        return Marking.NONE, Marking.NONE
    if lane.left >= 0:
        left = Marking.SOLID if lane.id in details.no_change_left else Marking.BROKEN
    else:
        left = Marking.CENTRE if lane.edge_id in centred else Marking.EDGE
    if lane.right >= 0:
        right = Marking.SOLID if lane.id in details.no_change_right else Marking.BROKEN
    else:
        right = Marking.EDGE
    return left, right


def _edges_beside_opposite(network: RoadNetwork, details: RoadDetails) -> frozenset[str]:
    """Returns the edges whose left border is also that of an edge of the opposite direction."""
    leftmost = {
        lane.edge_id: lane
        for lane in network.lanes
        if lane.drivable and not lane.is_internal and lane.left < 0
    }
    between: dict[tuple[str, str], list[str]] = {}
    for edge in leftmost:
        found = details.edges[edge]
        between.setdefault((found.begin, found.end), []).append(edge)
    middles = {edge: _middle(lane) for edge, lane in leftmost.items()}
    return frozenset(
        edge
        for (begin, end), edges in between.items()
        for edge in edges
        if any(
            np.hypot(*(middles[edge] - middles[other])) <= _SAME_BORDER
            for other in between.get((end, begin), ())
        )
    )


def _middle(lane: Lane) -> FloatArray:
    """Returns the place half-way along a lane's left border, metres."""
    border = offset_line(lane.shape, 0.5 * lane.width)
    half = 0.5 * float(lane.arc[-1])
    return np.array([np.interp(half, lane.arc, border[:, axis]) for axis in (0, 1)])
