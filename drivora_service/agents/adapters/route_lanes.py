"""The usable lanes of a route, among the known lanes of an adapter."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from drivora_service.agents.remote.views import LaneView, RouteView


def usable_lanes(lanes: Mapping[int, LaneView], route: RouteView) -> set[int]:
    """Returns the lanes that a vehicle on the route may use, including those beside the route."""
    usable = set(lane_sequence(lanes, route))
    for lane in list(usable):
        usable.update(beside_one_another(lanes, lane))
    for lane in list(usable):
        for way in ways_through_junction(lanes, lane):
            if way[-1] in usable:
                usable.update(way)
    return usable


def lane_sequence(lanes: Mapping[int, LaneView], route: RouteView) -> list[int]:
    """Returns the lanes of the route in order; consecutive ones are connected or adjacent."""
    found = [int(lane) for lane in route.lanes[np.flatnonzero(np.diff(route.lanes, prepend=-1))]]
    sequence = found[:1]
    for lane in found[1:]:
        # Lanes of less than a metre, in junctions, may be between two points of the route.
        for way in ways_through_junction(lanes, sequence[-1]):
            if way[-1] == lane:
                sequence += way[:-1]
                break
        sequence.append(lane)
    return sequence


def ways_through_junction(
    lanes: Mapping[int, LaneView], lane: int, depth: int = 4
) -> Iterator[list[int]]:
    """Returns the ways from a lane's end to the next lane outside the junction, inclusive."""
    for following in lanes[lane].successors:
        if following not in lanes:
            continue
        if not lanes[following].in_junction:
            yield [following]
        elif depth:
            for way in ways_through_junction(lanes, following, depth - 1):
                yield [following, *way]


def beside_one_another(lanes: Mapping[int, LaneView], lane: int) -> list[int]:
    """Returns a lane and those beside it, from it to the left, then to the right."""
    beside = [lane]
    if lanes[lane].in_junction:
        return beside
    for leftwards in (True, False):
        current: int | None = lane
        while current is not None:
            view = lanes[current]
            current = view.left if leftwards else view.right
            if current is not None and current in lanes:
                beside.append(current)
            else:
                current = None
    return beside
