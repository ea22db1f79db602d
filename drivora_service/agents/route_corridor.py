"""The part of the road that a route may use, by middle and width, for learned policies.

Frame: the network's plane, metres, radians counter-clockwise from east.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.line_tracking import track_line

_MAX_CHAIN = 8
"""Maximum number of consecutive internal lanes through one junction."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RouteCorridor:
    """The lanes from which the route can be continued, at each point of its reference line.

    Attributes:
        arc: (n,) arc length of each point on the route's reference line, metres, ascending.
        middle: (n, 2) middle of those lanes, metres.
        heading: (n,) their direction, radians, without jumps of a full turn.
        width: (n,) metres from their right to their left border.
        lanes: (n,) their number.
    """

    arc: FloatArray
    middle: FloatArray
    heading: FloatArray
    width: FloatArray
    lanes: FloatArray


@lru_cache(maxsize=256)
def find_corridor(network: RoadNetwork, route: LaneRoute) -> RouteCorridor:
    """Finds the corridor of a route.

    A lane from which the next edge of the route cannot be reached belongs to it only until the
    reference line leaves it.
    """
    count = len(route.arc)
    middle = np.empty((count, 2))
    heading, width, lanes = np.empty(count), np.empty(count), np.empty(count)
    blocks = _blocks(network, route)
    for number, (first, last) in enumerate(blocks):
        edge = network.lanes[int(route.point_lanes[first])].edge_id
        following = _next_edge(network, route, blocks[number + 1 :])
        usable = _usable(network, edge, following)
        for begin, end in _runs_of_equal(route.point_lanes[first:last]):
            part = slice(first + begin, first + end)
            lane = int(route.point_lanes[part.start])
            right, left = _borders(network, lane, usable)
            place, direction = _along(network, lane, route.line[part])
            normal = np.column_stack((-elementary.sin(direction), elementary.cos(direction)))
            middle[part] = place + 0.5 * (left - right) * normal
            heading[part] = direction
            width[part] = left + right
            lanes[part] = len(_side_by_side(network, lane, usable))
    return RouteCorridor(
        arc=route.arc, middle=middle, heading=np.unwrap(heading), width=width, lanes=lanes
    )


def _blocks(network: RoadNetwork, route: LaneRoute) -> list[tuple[int, int]]:
    """Returns the first point and the end of each stretch on an edge."""
    edges = [network.lanes[lane].edge_id for lane in route.point_lanes.tolist()]
    starts = [0, *(i for i, (one, two) in enumerate(pairwise(edges), 1) if one != two)]
    return list(pairwise([*starts, len(edges)]))


def _runs_of_equal(values: NDArray[np.int64]) -> list[tuple[int, int]]:
    cuts = np.flatnonzero(np.diff(values)) + 1
    return list(pairwise([0, *cuts.tolist(), len(values)]))


def _next_edge(network: RoadNetwork, route: LaneRoute, blocks: list[tuple[int, int]]) -> str:
    """Returns the next edge outside a junction, "" after the last."""
    for first, _ in blocks:
        lane = network.lanes[int(route.point_lanes[first])]
        if not lane.is_internal:
            return lane.edge_id
    return ""


def _usable(network: RoadNetwork, edge: str, following: str) -> frozenset[int]:
    """Returns the lanes of an edge that lead to the following edge; all lanes of the last edge."""
    lanes = [lane for lane in network.edge_lanes[edge] if network.lanes[lane].drivable]
    if not following:
        return frozenset(lanes)
    return frozenset(lane for lane in lanes if _leads_to(network, lane, following))


def _leads_to(network: RoadNetwork, lane: int, edge: str) -> bool:
    ahead = [lane]
    for _ in range(_MAX_CHAIN):
        ahead = [link.to_lane for one in ahead for link in network.lanes[one].connections]
        if any(network.lanes[one].edge_id == edge for one in ahead):
            return True
        ahead = [one for one in ahead if network.lanes[one].is_internal]
    return False


def _side_by_side(network: RoadNetwork, lane: int, usable: frozenset[int]) -> tuple[int, ...]:
    """Returns the adjacent lanes from right to left that contain ``lane`` and all usable ones."""
    edge = [i for i in network.edge_lanes[network.lanes[lane].edge_id] if network.lanes[i].drivable]
    chosen = [place for place, i in enumerate(edge) if i in usable or i == lane]
    return tuple(edge[min(chosen) : max(chosen) + 1])


def _borders(network: RoadNetwork, lane: int, usable: frozenset[int]) -> tuple[float, float]:
    """Returns the metres from a lane's centre to the right and to the left border."""
    chosen = _side_by_side(network, lane, usable)
    at = chosen.index(lane)
    half = 0.5 * network.lanes[lane].width
    right = half + sum(network.lanes[i].width for i in chosen[:at])
    left = half + sum(network.lanes[i].width for i in chosen[at + 1 :])
    return right, left


def _along(network: RoadNetwork, lane: int, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Returns the (n, 2) foot points on a lane's centre, and the (n,) direction there."""
    shape = network.lanes[lane].shape
    arc = arc_lengths(shape)
    steps = np.diff(shape, axis=0)
    directions = elementary.arctan2(steps[:, 1], steps[:, 0])
    s = np.empty(len(points))
    heading = np.empty(len(points))
    for i, (x, y) in enumerate(points.tolist()):
        segment, s[i], _ = track_line(shape, arc, 0, 0, len(shape), x, y)
        heading[i] = directions[segment]
    foot = np.column_stack((np.interp(s, arc, shape[:, 0]), np.interp(s, arc, shape[:, 1])))
    return foot, heading
