"""Finding the walks around given routes, and choosing among them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TypeVar

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_graph import lane_graph
from drivora_service.search.space.driven_path import DrivenPath
from drivora_service.search.space.lane_walks import LaneWalk, walks_from
from drivora_service.search.space.relations import (
    Relation,
    RouteSurroundings,
    closest_relation,
    spread_out,
)

START_ROOM = 80.0
"""Metres between the starts of walks on the same lane."""
_LEAST_STRETCH = 20.0
"""Least length of a lane for another walk, metres: a shorter rest belongs to the walk before."""
_CLEAR_OF_START = 8.0
"""Metres ahead of a route's start where leading walks begin."""
_CELL = 20.0
"""Length of the cells by which walks are compared, metres."""

T = TypeVar("T")


def find_walks(
    network: RoadNetwork,
    routes: Sequence[DrivenPath],
    *,
    reach: float,
    length: float,
    most: int,
) -> dict[Relation, list[LaneWalk]]:
    """Enumerates the walks that come near routes, by their relation to them.

    They begin on roads within ``reach`` metres of a route, are ``length`` metres long and lead
    through junctions in every permitted direction.

    Returns:
        At most ``most`` of each relation, the most different first.
    """
    surroundings = [RouteSurroundings(network, route, reach) for route in routes]
    walks: dict[Relation, list[LaneWalk]] = {relation: [] for relation in Relation}
    for lane, s in _roots(network, routes, surroundings, reach):
        for walk in walks_from(network, lane, s, length):
            relation = closest_relation(walk, surroundings)
            if relation is not None:
                walks[relation].append(walk)
    return {
        relation: [found[i] for i in spread_out(_cells(network, found), most)]
        for relation, found in walks.items()
        if found
    }


def take_in_turns(
    walks: Mapping[Relation, Sequence[LaneWalk]],
    turns: Sequence[Relation],
    count: int,
    accept: Callable[[LaneWalk, Relation], T | None],
) -> tuple[T, ...]:
    """Takes walks of one relation after another, cyclically, until there are enough.

    Args:
        walks: Walks by relation, the best first.
        turns: Relations in the order of their turns; one may have several.
        count: Number of walks to take.
        accept: Returns the result for a walk; ``None`` refuses it.
    """
    queues = {relation: iter(found) for relation, found in walks.items()}
    taken: list[T] = []
    while queues:
        for relation in turns:
            if relation not in queues:
                continue
            made = (accept(walk, relation) for walk in queues[relation])
            first = next((thing for thing in made if thing is not None), None)
            if first is None:
                del queues[relation]
            elif len(taken) < count:
                taken.append(first)
        if len(taken) >= count:
            break
    return tuple(taken)


def _roots(
    network: RoadNetwork,
    routes: Sequence[DrivenPath],
    surroundings: Sequence[RouteSurroundings],
    reach: float,
) -> Iterator[tuple[int, float]]:
    """Yields the lanes near the routes, with the starts of walks on them."""
    for lane in network.lanes:
        if not lane.drivable or lane.is_internal:
            continue
        near = [around.stretch_within(lane.index) for around in surroundings]
        stretches = [stretch for stretch in near if stretch is not None]
        if not stretches:
            continue
        low, high = min(low for low, _ in stretches), max(high for _, high in stretches)
        begins = {low}
        for route in routes:
            if int(route.route.point_lanes[0]) == lane.index:
                begins.add(_s_on(network, lane.index, route) + _CLEAR_OF_START)
        for begin in sorted(begins):
            end = min([other for other in begins if other > begin], default=high)
            for s in np.arange(begin, max(end - _LEAST_STRETCH, begin + 1e-6), START_ROOM).tolist():
                if any(around.gap_at(lane.index, s) <= reach for around in surroundings):
                    yield lane.index, s


def _s_on(network: RoadNetwork, lane: int, route: DrivenPath) -> float:
    """Returns the arc length on a route's first lane where the route begins."""
    shape = network.lanes[lane].shape
    x, y = route.line[0]
    fine = np.linspace(0.0, float(network.lanes[lane].arc[-1]), 400)
    gaps = np.hypot(
        np.interp(fine, network.lanes[lane].arc, shape[:, 0]) - x,
        np.interp(fine, network.lanes[lane].arc, shape[:, 1]) - y,
    )
    return float(fine[int(np.argmin(gaps))])


def _cells(network: RoadNetwork, walks: Sequence[LaneWalk]) -> FloatArray:
    """Returns (n, m) 1 where a walk passes a cell of a lane, else 0."""
    lengths = lane_graph(network).lengths
    numbers: dict[tuple[int, int], int] = {}
    rows = []
    for walk in walks:
        row: list[int] = []
        for position, lane in enumerate(walk.lanes):
            low = walk.start_s if position == 0 else 0.0
            high = walk.end_s if position == len(walk.lanes) - 1 else lengths[lane]
            passed = range(int(low // _CELL), int(high // _CELL) + 1)
            row.extend(numbers.setdefault((lane, cell), len(numbers)) for cell in passed)
        rows.append(row)
    cells = np.zeros((len(walks), len(numbers)))
    for i, row in enumerate(rows):
        cells[i, row] = 1.0
    return cells
