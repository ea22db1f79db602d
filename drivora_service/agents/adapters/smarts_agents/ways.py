"""The ways ahead as in SMARTS: one for each lane that leads along the route.

Frame: the network's plane, metres, radians counter-clockwise from east; left is positive.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.adapters.path_lines import arc_of
from drivora_service.agents.adapters.route_lanes import (
    beside_one_another,
    lane_sequence,
    ways_through_junction,
)
from drivora_service.agents.adapters.smarts_agents.lane_places import lane_index
from drivora_service.agents.remote.views import LaneView, RouteView
from drivora_service.geometry.array_shapes import FloatArray

_BEYOND = 60.0
"""Metres of straight extension after the last lane of a route."""

_LATE = 1.0
"""Metres by which a vehicle may be past a stage before the next one is used: the points of a route
are that far apart. A way must not begin behind the vehicle, or a standing vehicle would never pass
it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Way:
    """Consecutive lanes as a line.

    Attributes:
        lanes: Their ids.
        line: (n, 2).
        arc: (n,) from the start.
        starts: Start of each lane along ``arc``.
        first_length: Metres up to which the first stage of the way goes: its lane on a road, or all
            its lanes within a junction.
    """

    lanes: tuple[int, ...]
    line: FloatArray
    arc: FloatArray
    starts: FloatArray
    first_length: float

    def project(self, place: FloatArray) -> tuple[float, float]:
        """Returns the distance of a place along the way's first stage, and to the left of it."""
        last = self.first_length + _LATE
        count = max(int(np.searchsorted(self.arc, last)) + 1, 2)
        line = self.line[:count]
        steps = np.diff(line, axis=0)
        lengths = np.hypot(*steps.T)
        away = place - line[:-1]
        share = np.clip((away * steps).sum(axis=1) / lengths**2, 0.0, 1.0)
        gaps = np.hypot(*(away - share[:, None] * steps).T)
        k = int(np.argmin(gaps))
        side = float(steps[k, 0] * away[k, 1] - steps[k, 1] * away[k, 0])
        s = min(float(self.arc[k] + share[k] * lengths[k]), last)
        return s, float(np.copysign(gaps[k], side))

    def lane_at(self, s: float) -> int:
        """Returns the lane of ``lanes`` at a place along the way."""
        return max(int(np.searchsorted(self.starts, s, side="right")) - 1, 0)


class RouteWays:
    """The ways ahead along a route, for each of its roads and junctions."""

    def __init__(self, lanes: Mapping[int, LaneView], route: RouteView) -> None:
        """Finds the roads of a route and the ways from each to the next.

        Args:
            lanes: Lanes around the route, by id.
            route: The route.
        """
        self._lanes = lanes
        self._roads, own = _roads(lanes, lane_sequence(lanes, route))
        self._next = _connections(lanes, self._roads, own)
        self._stages = _stages(lanes, self._roads, route)
        self._arc = route.arc
        self._ways: dict[int, tuple[Way, ...]] = {}
        self._single: dict[int, Way] = {}

    def stage(self, route_s: float) -> int:
        """Returns the number of the road (even) or junction (odd) at a place along the route."""
        k = int(np.searchsorted(self._arc, route_s, side="right")) - 1
        return int(self._stages[min(max(k, 0), len(self._stages) - 1)])

    def road(self, stage: int) -> tuple[int, ...]:
        """Returns the lanes of a stage's road, from the right, or of the road before a junction."""
        return self._roads[stage // 2]

    def lane(self, lane: int) -> Way:
        """Returns the way of a single lane."""
        if lane not in self._single:
            self._single[lane] = self._way((lane,), 1)
        return self._single[lane]

    def ways(self, stage: int) -> tuple[Way, ...]:
        """Returns the ways ahead, from the right; at least one."""
        if stage not in self._ways:
            self._ways[stage] = tuple(self._find_ways(stage))
        return self._ways[stage]

    def _find_ways(self, stage: int) -> list[Way]:
        road, in_junction = divmod(stage, 2)
        last = road == len(self._roads) - 1
        found = []
        for lane in self._roads[road]:
            following = self._next[road].get(lane)
            if following is not None:
                ahead = self._extend_lanes(following, road + 1)
                found.append(
                    self._way(ahead, max(len(following) - 1, 1))
                    if in_junction
                    else self._way((lane, *ahead), 1)
                )
            elif last:
                found.append(self._way((lane,), 1))
        return found

    def _extend_lanes(self, lanes: tuple[int, ...], road: int) -> tuple[int, ...]:
        """Adds the continuation from ``road`` on, to which the last of the lanes belongs."""
        while road < len(self._roads) - 1:
            following = self._next[road].get(lanes[-1])
            if following is None:
                break
            lanes, road = lanes + following, road + 1
        return lanes

    def _way(self, ids: tuple[int, ...], first: int) -> Way:
        """Makes the way of lanes, of which ``first`` belong to its first stage."""
        lines = [self._lanes[lane].line for lane in ids]
        if ids[-1] in self._roads[-1]:
            end = lines[-1][-1] - lines[-1][-2]
            beyond = lines[-1][-1] + _BEYOND * end / max(float(np.hypot(*end)), 1e-9)
            lines.append(beyond[None])
        joined = np.concatenate(lines)
        keep = np.hypot(*np.diff(joined, axis=0, prepend=joined[:1] - 1.0).T) > 1e-3
        line = joined[keep]
        arc = arc_of(line)
        # A lane's first point is the last of the preceding lane, so it is not repeated.
        counts = np.cumsum([0, *(len(part) for part in lines)])[: len(ids) + 1]
        kept = np.concatenate(([0], np.cumsum(keep)))[counts]
        places = arc[np.maximum(kept - 1, 0)]
        return Way(
            lanes=ids, line=line, arc=arc, starts=places[:-1], first_length=float(places[first])
        )


def _roads(
    lanes: Mapping[int, LaneView], sequence: list[int]
) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """Returns the roads of a route, each as its lanes from the right, and the way after each."""
    roads = [_road(lanes, sequence[0])]
    own: list[tuple[int, ...]] = []
    way: list[int] = [sequence[0]]
    for position, lane in enumerate(sequence[1:], start=1):
        if lanes[lane].in_junction and position < len(sequence) - 1:
            way.append(lane)
            continue
        if len(way) == 1 and lane in roads[-1]:
            way = [lane]
            continue
        own.append((*way, lane))
        roads.append(_road(lanes, lane))
        way = [lane]
    return roads, own


def _road(lanes: Mapping[int, LaneView], lane: int) -> tuple[int, ...]:
    return tuple(sorted(beside_one_another(lanes, lane), key=lambda k: lane_index(lanes, k)))


def _connections(
    lanes: Mapping[int, LaneView], roads: list[tuple[int, ...]], own: list[tuple[int, ...]]
) -> list[dict[int, tuple[int, ...]]]:
    """Returns for each road the way from each lane to the next road, including its lane.

    If a lane has several, the route's own one is taken, else one that continues after the next
    road, else that to the lane nearest to the route's.
    """
    found: list[dict[int, tuple[int, ...]]] = [{} for _ in roads]
    for i in range(len(own) - 1, -1, -1):
        after, wanted = roads[i + 1], own[i]
        target = after.index(wanted[-1])
        for lane in roads[i]:
            if lane == wanted[0]:
                found[i][lane] = wanted[1:]
                continue
            ways = [tuple(w) for w in ways_through_junction(lanes, lane) if w[-1] in after]
            if ways:
                found[i][lane] = min(
                    ways,
                    key=lambda w: (
                        i + 1 < len(own) and w[-1] not in found[i + 1],
                        abs(after.index(w[-1]) - target),
                    ),
                )
    return found


def _stages(
    lanes: Mapping[int, LaneView], roads: list[tuple[int, ...]], route: RouteView
) -> NDArray[np.int64]:
    """Returns for each point of the route twice its road's number, or one more in a junction."""
    stages = np.empty(len(route.lanes), dtype=np.int64)
    road, through = 0, False
    for k, lane in enumerate(route.lanes.tolist()):
        if lane in roads[road] and not through:
            stages[k] = 2 * road
        elif road + 1 < len(roads) and lane in roads[road + 1]:
            road, through = road + 1, False
            stages[k] = 2 * road
        else:
            through = lanes[lane].in_junction
            stages[k] = 2 * road + 1
    return stages
