"""The drivable lanes of a network as a graph, with the steps from the start of each lane."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.tight_turns import tight_turns

CHANGE_COST = 25.0
"""Cost of a lane change, metres of detour."""

MIN_CHANGE_LENGTH = 8.0
"""Least length of a lane change in metres, for a car at walking pace."""

EASY_CHANGE_LENGTH = 40.0
"""Length from which on a lane change has no extra cost, metres; the missing length is added to
its cost."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sibling:
    """A lane that can be reached from another of the same edge by ``changes`` lane changes."""

    lane: int
    changes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A step from the start of a lane to the start of a next one.

    Attributes:
        lane: The next lane.
        exit_lane: The lane of the first edge that leads to it.
        cost: Metres, with the cost of lane changes.
    """

    lane: int
    exit_lane: int
    cost: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaneGraph:
    """Adjacency by lane index; empty for lanes that cars may not use.

    Attributes:
        lengths: Arc length of each lane's centre line, metres.
        siblings: Lanes of the same edge that can be reached, the lane itself first.
        successors: Drivable lanes after each lane's end, without those that are reached only by a
            turn that no car can drive.
        tight: Lanes that are reached only by such a turn.
        steps: Cheapest ways from a lane's start to the start of each lane after its edge.
    """

    lengths: tuple[float, ...]
    siblings: tuple[tuple[Sibling, ...], ...]
    successors: tuple[tuple[int, ...], ...]
    tight: tuple[tuple[int, ...], ...]
    steps: tuple[tuple[Step, ...], ...]


def change_cost(changes: int, room: float) -> float | None:
    """Returns the cost of ``changes`` lane changes in ``room`` metres; None if they do not fit."""
    if changes == 0:
        return 0.0
    each = room / changes
    if each < MIN_CHANGE_LENGTH:
        return None
    return changes * (CHANGE_COST + max(0.0, EASY_CHANGE_LENGTH - each))


@lru_cache(maxsize=128)
def lane_graph(network: RoadNetwork) -> LaneGraph:
    """Returns the graph of a network, built on the first call for this network object."""
    lengths = tuple(float(lane.arc[-1]) for lane in network.lanes)
    siblings = tuple(_siblings(network, lane) for lane in network.lanes)
    behind = tuple(
        tuple(
            dict.fromkeys(
                link.to_lane for link in lane.connections if network.lanes[link.to_lane].drivable
            )
        )
        if lane.drivable
        else ()
        for lane in network.lanes
    )
    turns = tight_turns(network)
    successors, tight = (
        tuple(
            tuple(to for to in lanes if ((lane, to) in turns) is wanted)
            for lane, lanes in enumerate(behind)
        )
        for wanted in (False, True)
    )
    steps = tuple(
        find_exit_steps(lengths, siblings, successors, lane.index, 0.0) for lane in network.lanes
    )
    return LaneGraph(
        lengths=lengths, siblings=siblings, successors=successors, tight=tight, steps=steps
    )


def find_exit_steps(
    lengths: tuple[float, ...],
    siblings: tuple[tuple[Sibling, ...], ...],
    successors: tuple[tuple[int, ...], ...],
    lane: int,
    s: float,
) -> tuple[Step, ...]:
    """Returns the cheapest ways from arc length ``s`` of a lane to each lane after its edge."""
    room = lengths[lane] - s
    best: dict[int, Step] = {}
    for sibling in siblings[lane]:
        extra = change_cost(sibling.changes, room)
        if extra is None:
            continue
        for following in successors[sibling.lane]:
            known = best.get(following)
            if known is None or room + extra < known.cost:
                best[following] = Step(lane=following, exit_lane=sibling.lane, cost=room + extra)
    return tuple(best.values())


def _siblings(network: RoadNetwork, lane: Lane) -> tuple[Sibling, ...]:
    if not lane.drivable:
        return ()
    found = [Sibling(lane=lane.index, changes=0)]
    if lane.is_internal:
        return tuple(found)
    for leftwards in (True, False):
        changes, current = 0, lane
        while (index := current.left if leftwards else current.right) >= 0:
            changes, current = changes + 1, network.lanes[index]
            found.append(Sibling(lane=index, changes=changes))
    return tuple(found)
