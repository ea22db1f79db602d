"""Markings at the borders of lanes, as they follow from a network.

SUMO's networks have no markings. They follow from what is on the other side of a border: a lane of
the same direction, with or without a permitted change, the other direction, or nothing.
"""

from __future__ import annotations

import math
from enum import StrEnum

from shapely import LineString, Point, STRtree

from drivora_service.geometry.lines import offset_line
from drivora_service.networks.road_details import RoadDetails, road_details
from drivora_service.networks.road_network import Lane, RoadNetwork

_SAME_BORDER = 0.6
"""Metres between the borders of two directions up to which they are one."""
_OPPOSITE = -0.7
"""Cosine of the angle between opposite directions, at most."""
_BESIDE = 0.5
"""Metres to both sides of a place between which a line's direction is taken."""


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
    centred = _edges_beside_opposite(network)
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


def _edges_beside_opposite(network: RoadNetwork) -> frozenset[str]:
    """Returns the edges whose left border is also that of an edge of the opposite direction."""
    lanes = [
        lane for lane in network.lanes if lane.drivable and not lane.is_internal and lane.left < 0
    ]
    borders = [LineString(offset_line(lane.shape, 0.5 * lane.width)) for lane in lanes]
    tree = STRtree(borders)
    found = set()
    for lane, border in zip(lanes, borders, strict=True):
        middle = border.interpolate(0.5, normalized=True)
        heading = _heading(border, middle)
        for other in tree.query(middle, predicate="dwithin", distance=_SAME_BORDER).tolist():
            if math.cos(_heading(borders[other], middle) - heading) < _OPPOSITE:
                found.add(lane.edge_id)
    return frozenset(found)


def _heading(border: LineString, place: Point) -> float:
    """Returns the direction of a line beside a place, radians."""
    s = border.project(place)
    ends = [border.interpolate(max(s + along, 0.0)) for along in (-_BESIDE, _BESIDE)]
    return math.atan2(ends[1].y - ends[0].y, ends[1].x - ends[0].x)
