"""Search for the cheapest way through the lanes that passes places in order.

Every place may be on one of several lanes. The search goes from place to place and keeps, for each
lane of the place, the cheapest way to it from any lane of the preceding place. A turn that
no car can drive is part of a leg only if the leg begins before it and ends in or after it.
"""

from __future__ import annotations

import math
from collections.abc import Container, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

from drivora_service.networks.routes.lane_graph import LaneGraph, Step, change_cost, find_exit_steps

BEHIND_TOLERANCE = 1.0
"""Metres by which a place may be behind the preceding one on a lane and still count as reached."""

NAMED_COST = 20.0
"""Metres by which a candidate may cost more than the cheapest of its place and still count as the
place's own lane: one metre further aside (``routing.DISTANCE_COST``)."""

_TURN_LANES = 4
"""Maximum number of lanes of a turn, with the one after it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A possible lane position of a place, and its cost in metres."""

    lane: int
    s: float
    cost: float


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgePass:
    """A stretch of one edge, with the lane changes between the lanes at its ends.

    Attributes:
        lane: Index of the lane at its beginning.
        s: Arc length on ``lane``, metres.
        exit_lane: Index of the lane at its end, of the same edge.
        exit_s: Arc length on ``exit_lane``, metres.
        continues: True where it begins in the middle of an edge, where the preceding pass ended.
    """

    lane: int
    s: float
    exit_lane: int
    exit_s: float
    continues: bool


# Plain tuples, which are unpacked into names where they are read: named ones would make the search
# a third slower.
_Entry = tuple[int, int]
"""The end of a way to a target: the number of the candidate from which it goes straight on, else
-1; the lane at the beginning of its last edge, else -1."""

_Parent = tuple[int, int, int]
"""How a lane is reached: the lane at the beginning of the edge before, -1 from the source's edge;
the number of the candidate there, else -1; the lane at the end of the edge before."""


@dataclass(slots=True, kw_only=True)
class _Leg:
    """The cheapest ways to the candidates of a place from those of the preceding place.

    Attributes:
        sources: Candidates of the preceding place.
        targets: Candidates of the place.
        costs: Cost of the way to each target; infinite without one.
        entries: End of the way to each target.
        parents: How each lane that has been reached is reached.
    """

    sources: Sequence[Candidate]
    targets: Sequence[Candidate]
    costs: list[float]
    entries: list[_Entry]
    parents: dict[int, _Parent]

    def reach(self, target: int, cost: float, entry: _Entry) -> None:
        """Takes a way to a target if it is the cheapest so far."""
        if cost < self.costs[target]:
            self.costs[target], self.entries[target] = cost, entry

    def total(self) -> float:
        """Returns the cost of the cheapest target with its own cost."""
        return min(
            [cost + target.cost for cost, target in zip(self.costs, self.targets, strict=True)]
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """A way through places.

    Attributes:
        legs: Passes to each place but the first from the preceding one.
        cost: Metres, with the costs of lane changes and of the chosen candidates.
    """

    legs: tuple[tuple[EdgePass, ...], ...]
    cost: float

    @property
    def passes(self) -> tuple[EdgePass, ...]:
        """All passes in order."""
        return tuple(one for leg in self.legs for one in leg)


def search(
    graph: LaneGraph,
    places: Sequence[Sequence[Candidate]],
    *,
    around: bool = False,
    allowed: Sequence[Container[int]] | None = None,
) -> Way | int:
    """Finds the cheapest way.

    Args:
        graph: The drivable lanes.
        places: Candidates of each place, at least two places.
        around: The last place must be reached from the end of another edge, even if it is
            straight ahead or the preceding place.
        allowed: Lanes that may be entered on the way to each place but the first;
            ``None``: all lanes.

    Returns:
        The way, or the number of the first place that cannot be reached.
    """
    costs = [candidate.cost for candidate in places[0]]
    legs: list[_Leg] = []
    for number in range(1, len(places)):
        last = number == len(places) - 1
        leg = _search_leg(
            graph,
            places[number - 1],
            costs,
            places[number],
            around=around and last,
            last=last,
            allowed=None if allowed is None else allowed[number - 1],
        )
        if math.isinf(min(leg.costs)):
            return number
        legs.append(leg)
        costs = [
            cost + candidate.cost for cost, candidate in zip(leg.costs, places[number], strict=True)
        ]
    target = min(range(len(costs)), key=costs.__getitem__)
    cost = costs[target]
    way: list[tuple[EdgePass, ...]] = []
    for leg in reversed(legs):
        target, passes = _trace_back(graph, leg, target)
        way.append(passes)
    return Way(legs=tuple(reversed(way)), cost=cost)


def _search_leg(
    graph: LaneGraph,
    sources: Sequence[Candidate],
    source_costs: Sequence[float],
    targets: Sequence[Candidate],
    *,
    around: bool,
    last: bool,
    allowed: Container[int] | None,
) -> _Leg:
    """Finds the ways of a leg; of the last one, only that to the target that is cheapest then."""
    count = len(targets)
    leg = _Leg(
        sources=sources,
        targets=targets,
        costs=[math.inf] * count,
        entries=[(-1, -1)] * count,
        parents={},
    )
    if not around:
        for i, source in enumerate(sources):
            for j, target in enumerate(targets):
                leg.reach(j, source_costs[i] + _straight_on(graph, source, target), (i, -1))

    cheapest = min([target.cost for target in targets])
    bound = max(leg.costs)
    limit = leg.total() if last else math.inf
    cost_to: dict[int, float] = {}
    queue: list[tuple[float, int]] = []
    for i, source in enumerate(sources):
        # No way to another edge is shorter than that to the end of the source's own.
        least = source_costs[i] + (graph.lengths[source.lane] - source.s)
        if least >= bound or least + cheapest > limit:
            continue
        first = find_exit_steps(
            graph.lengths, graph.siblings, graph.successors, source.lane, source.s
        )
        for step in (*first, *_turns_asked_for(graph, source, targets)):
            if allowed is not None and step.lane not in allowed:
                continue
            cost = source_costs[i] + step.cost
            if cost < cost_to.get(step.lane, math.inf):
                cost_to[step.lane] = cost
                leg.parents[step.lane] = (-1, i, step.exit_lane)
                heappush(queue, (cost, step.lane))

    if not queue:
        return leg
    doors = _doors(graph, targets)
    settled: set[int] = set()
    while queue:
        cost, lane = heappop(queue)
        # A way on from here is no shorter, as rounding keeps the order of numbers.
        if cost >= bound or cost + cheapest > limit:
            break
        if lane in settled:
            continue
        settled.add(lane)
        if lane in doors:
            for j, rest in doors[lane]:
                leg.reach(j, cost + rest, (-1, lane))
            bound = max(leg.costs)
            limit = leg.total() if last else math.inf
        for step in graph.steps[lane]:
            if allowed is not None and step.lane not in allowed:
                continue
            through = cost + step.cost
            if through < cost_to.get(step.lane, math.inf):
                cost_to[step.lane] = through
                leg.parents[step.lane] = (lane, -1, step.exit_lane)
                heappush(queue, (through, step.lane))
    return leg


def _doors(graph: LaneGraph, targets: Sequence[Candidate]) -> dict[int, list[tuple[int, float]]]:
    """Returns the targets, and the costs to them, by the lane at whose start their edge begins."""
    doors: dict[int, list[tuple[int, float]]] = {}
    for j, target in enumerate(targets):
        for sibling in graph.siblings[target.lane]:
            extra = change_cost(sibling.changes, target.s)
            if extra is not None:
                doors.setdefault(sibling.lane, []).append((j, target.s + extra))
    return doors


def _turns_asked_for(
    graph: LaneGraph, source: Candidate, targets: Sequence[Candidate]
) -> list[Step]:
    """Returns the tight turns from the edge of a source that lead to a place's own lanes."""
    turns = find_exit_steps(graph.lengths, graph.siblings, graph.tight, source.lane, source.s)
    if not turns:
        return []
    dearest = min([target.cost for target in targets]) + NAMED_COST
    ends = {
        sibling.lane
        for target in targets
        if target.cost <= dearest
        for sibling in graph.siblings[target.lane]
    }
    return [turn for turn in turns if _leads_into(graph, turn.lane, ends)]


def _leads_into(graph: LaneGraph, lane: int, ends: Container[int]) -> bool:
    for _ in range(_TURN_LANES):
        if lane in ends:
            return True
        if not graph.successors[lane]:
            return False
        lane = graph.successors[lane][0]
    return False


def _straight_on(graph: LaneGraph, source: Candidate, target: Candidate) -> float:
    """Returns the cost of reaching ``target`` on the edge of ``source``; infinite if impossible."""
    for sibling in graph.siblings[source.lane]:
        if sibling.lane == target.lane:
            ahead = target.s * graph.lengths[source.lane] / graph.lengths[target.lane] - source.s
            extra = change_cost(sibling.changes, ahead)
            if ahead < -BEHIND_TOLERANCE or extra is None:
                return math.inf
            return max(ahead, 0.0) + extra
    return math.inf


def _trace_back(
    graph: LaneGraph, leg: _Leg, target_number: int
) -> tuple[int, tuple[EdgePass, ...]]:
    """Follows the parents back from a target; returns its source, and the way from there."""
    target = leg.targets[target_number]
    source, lane = leg.entries[target_number]
    if lane < 0:
        begin = leg.sources[source]
        exit_s = max(target.s, begin.s) if target.lane == begin.lane else target.s
        only = EdgePass(
            lane=begin.lane, s=begin.s, exit_lane=target.lane, exit_s=exit_s, continues=True
        )
        return source, (only,)
    passes: list[EdgePass] = []
    exit_lane, exit_s = target.lane, target.s
    while lane >= 0:
        passes.append(
            EdgePass(lane=lane, s=0.0, exit_lane=exit_lane, exit_s=exit_s, continues=False)
        )
        lane, source, exit_lane = leg.parents[lane]
        exit_s = graph.lengths[exit_lane]
    begin = leg.sources[source]
    passes.append(
        EdgePass(lane=begin.lane, s=begin.s, exit_lane=exit_lane, exit_s=exit_s, continues=True)
    )
    return source, tuple(reversed(passes))
