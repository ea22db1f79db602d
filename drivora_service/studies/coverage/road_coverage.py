"""The share of a road network that the scenarios of a campaign use.

The drivable lanes, those inside junctions included, are cut into cells of at most five metres. A
cell is covered once any scenario places an actor there (its start, a waypoint, its end, where it
stands), a vehicle's planned path leads over it, or a walker's path crosses it. The share is of the
length of all cells. Coverage is of the documents: it does not matter how far an actor came in the
run.

The path between two places of a vehicle is the planner's between the two lanes. It is planned once
for each pair of lanes, not from place to place, because a study has hundreds of thousands of pairs.
Where it changes lanes on a road, each lane counts for its part of that road.

A way counts once in each cell that it passes once: its places count, and the paths between them
without the cells of their ends.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from drivora_service.errors import NoRoute
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.projection import LaneProjections, project_points
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.scenario.model import NpcBehavior, Scenario, Waypoint

CELL = 5.0
"""Greatest length of a cell, metres."""
_STEP = 1.0
"""Metres between places on a straight path."""

Road = tuple[int, ...]
"""Lanes of one road, or one lane in a junction, in the order of a path."""


class RoadCoverage:
    """Collects the places of scenarios on one road network."""

    def __init__(self, network: RoadNetwork) -> None:
        """Creates the record of a network, of which nothing is covered."""
        self._network = network
        lengths = [float(lane.arc[-1]) if lane.drivable else 0.0 for lane in network.lanes]
        self._lengths = np.array(lengths)
        self._counts = np.ceil(self._lengths / CELL).astype(np.int64)
        self._firsts = np.concatenate(([0], np.cumsum(self._counts)))
        self._begun = np.zeros(int(self._firsts[-1]) + 1, dtype=np.int64)
        """Number of ranges that begin at each cell, minus those that ended before it."""

    @property
    def share(self) -> float:
        """The covered share of the drivable lanes' length; 0 if there are none."""
        return covered_share((self,))

    @property
    def lengths(self) -> tuple[float, float]:
        """The length of the covered cells and of all, metres."""
        sizes = np.repeat(self._lengths / np.maximum(self._counts, 1), self._counts)
        return float(sizes[self.covered].sum()), float(sizes.sum())

    @property
    def covered(self) -> NDArray[np.bool_]:
        """(n,) whether each cell is covered, lane by lane."""
        covered: NDArray[np.bool_] = self._cell_counts > 0
        return covered

    @property
    def _cell_counts(self) -> NDArray[np.int64]:
        """(n,) ways and places on each cell, lane by lane."""
        counts: NDArray[np.int64] = np.cumsum(self._begun)[:-1]
        return counts

    def counts_by_lane(self) -> tuple[NDArray[np.int64], ...]:
        """Returns how many ways and places are on each cell, an array for each lane."""
        return tuple(np.split(self._cell_counts, self._firsts[1:-1]))

    def add(self, scenarios: Sequence[Scenario], *, only_egos: bool = False) -> None:
        """Covers the lanes that scenarios on this network use.

        Args:
            scenarios: The scenarios.
            only_egos: Whether other actors are left out.
        """
        joined = [way for scenario in scenarios for way in _ego_ways(scenario)]
        single: list[FloatArray] = []
        if not only_egos:
            joined += [way for scenario in scenarios for way in _joined_ways(scenario)]
            single += [way for scenario in scenarios for way in _straight_ways(scenario)]
        if joined:
            self._add_joined(joined)
        if single:
            places = project_points(self._network, np.concatenate(single))
            self._cover_places(places, _followers(single))

    def _add_joined(self, ways: Sequence[FloatArray]) -> None:
        """Covers (n, 3) places x, y, yaw (NaN if unknown) and the paths between them."""
        points = np.concatenate(ways)
        places = project_points(self._network, points[:, :2], points[:, 2])
        lanes = places.lane.astype(np.int64)
        on = lanes >= 0
        follows = _followers(ways)
        self._cover_places(places, follows)
        ends = np.flatnonzero(follows & on & np.roll(on, 1))
        pairs = np.column_stack((lanes[ends - 1], lanes[ends]))
        for pair in np.unique(pairs, axis=0):
            chosen = ends[(pairs == pair).all(axis=1)]
            self._cover_ways(_roads_between(self._network, *map(int, pair)), places, chosen)

    def _cover_places(self, places: LaneProjections, follows: NDArray[np.bool_]) -> None:
        """Covers the cells of (n,) places, those on no lane left out.

        Args:
            places: Where they are.
            follows: Whether each has the place before it on the same way; if both are in one cell,
                it counts once.
        """
        on = np.flatnonzero(places.lane >= 0)
        lanes = places.lane[on].astype(np.int64)
        cells = np.full(len(places.lane), -1)
        cells[on] = self._firsts[lanes] + self._cells(lanes, places.s[on])
        kept = cells[(cells >= 0) & ~(follows & (cells == np.roll(cells, 1)))]
        np.add.at(self._begun, kept, 1)
        np.add.at(self._begun, kept + 1, -1)

    def _cover_ways(self, roads: tuple[Road, ...], places: LaneProjections, ends: IntArray) -> None:
        """Covers paths along the same roads that end at places ``ends`` and begin one before.

        The cells of these places are left out.
        """
        for number, road in enumerate(roads):
            for turn, lane in enumerate(road):
                length = self._lengths[lane]
                low = places.s[ends - 1] if number == 0 else np.zeros(len(ends))
                high = places.s[ends] if number == len(roads) - 1 else np.full(len(ends), length)
                part = (high - low) / len(road)
                forward = part >= 0.0
                begin = (low + turn * part)[forward]
                lanes = np.full(len(begin), lane)
                from_place = number == turn == 0
                to_place = number == len(roads) - 1 and turn == len(road) - 1
                first = self._cells(lanes, begin) + from_place
                last = self._cells(lanes, begin + part[forward]) - to_place
                some = first <= last
                np.add.at(self._begun, self._firsts[lane] + first[some], 1)
                np.add.at(self._begun, self._firsts[lane] + last[some] + 1, -1)

    def _cells(self, lanes: IntArray, s: FloatArray) -> IntArray:
        """Returns the cells of (n,) lanes that are (n,) metres from their begins."""
        cells: IntArray = (s * self._counts[lanes] / self._lengths[lanes]).astype(np.int64)
        return np.minimum(np.maximum(cells, 0), self._counts[lanes] - 1)


def _followers(ways: Sequence[FloatArray]) -> NDArray[np.bool_]:
    """Returns for each place of ways, one after the other, whether it is not the first of its."""
    follows = np.ones(sum(len(way) for way in ways), dtype=np.bool_)
    follows[np.cumsum([0, *(len(way) for way in ways[:-1])])] = False
    return follows


def _ego_ways(scenario: Scenario) -> Iterator[FloatArray]:
    """Yields (n, 3) places of each ego."""
    for ego in scenario.ego_vehicles:
        yield _places(ego.route)


def _joined_ways(scenario: Scenario) -> Iterator[FloatArray]:
    """Yields (n, 3) places of each other vehicle that follows lanes between them."""
    for npc in scenario.npc_vehicles:
        if npc.behavior is not NpcBehavior.REPLAY:
            yield _places(npc.route)


def _straight_ways(scenario: Scenario) -> Iterator[FloatArray]:
    """Yields (n, 2) places of each actor that moves in straight lines, or not at all."""
    for npc in scenario.npc_vehicles:
        if npc.behavior is NpcBehavior.REPLAY:
            yield _sample_route(npc.route)
    for walker in scenario.npc_walkers:
        yield _sample_route(walker.route)
    for obstacle in scenario.npc_obstacles:
        yield _sample_route((obstacle.location,))


def _places(route: Sequence[Waypoint]) -> FloatArray:
    return np.array([(p.x, p.y, math.nan if p.yaw is None else p.yaw) for p in route])


def _sample_route(route: Sequence[Waypoint]) -> FloatArray:
    pieces = [np.array([(route[0].x, route[0].y)])]
    for here, there in itertools.pairwise(route):
        count = max(math.ceil(math.hypot(there.x - here.x, there.y - here.y) / _STEP), 1)
        share = np.arange(1, count + 1)[:, None] / count
        ends = np.array([(here.x, here.y), (there.x, there.y)])
        pieces.append(ends[0] + share * (ends[1] - ends[0]))
    return np.concatenate(pieces)


@lru_cache(maxsize=65536)
def _roads_between(network: RoadNetwork, start: int, end: int) -> tuple[Road, ...]:
    """Returns the roads from one lane to another; none if there is no path."""
    lanes = network.lanes
    if start == end:
        return ((start,),)
    if lanes[start].edge_id == lanes[end].edge_id:
        return ((start, end),)
    try:
        route = plan_route(network, [_middle(network, start), _middle(network, end)])
    except NoRoute:
        return ()
    used = route.point_lanes[np.flatnonzero(np.diff(route.point_lanes, prepend=-1))].tolist()
    passed = [start, *(lane for lane in used if lane not in (start, end)), end]
    return tuple(
        tuple(road) for _, road in itertools.groupby(passed, key=lambda lane: lanes[lane].edge_id)
    )


def _middle(network: RoadNetwork, lane: int) -> RoutePoint:
    x, y, yaw = network.lanes[lane].position_at(0.5 * float(network.lanes[lane].arc[-1]))
    return RoutePoint(x=x, y=y, yaw=yaw)


def covered_share(coverages: Sequence[RoadCoverage]) -> float:
    """Returns the covered share of the drivable lanes' length of several networks together."""
    lengths = [coverage.lengths for coverage in coverages]
    whole = sum(of_all for _, of_all in lengths)
    return sum(covered for covered, _ in lengths) / whole if whole else 0.0
