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

from drivora_service.networks.lane_graph import LaneGraph, Step, change_cost, leaving

BEHIND_TOLERANCE = 1.0
"""Metres by which a place may be behind the preceding one on a lane and still count as reached."""

NAMED_COST = 20.0
"""Metres by which a candidate may cost more than the cheapest of its place and still count as the
place's own lane."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class _Arrival:
    """The cheapest way to a candidate of a place from the candidates of the preceding place.

    The cost is infinite without a way.
    """

    cost: float
    source: int
    passes: tuple[EdgePass, ...]


_UNREACHABLE = _Arrival(cost=math.inf, source=-1, passes=())


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
    legs: list[list[_Arrival]] = []
    for number in range(1, len(places)):
        last = number == len(places) - 1
        arrivals = _search_leg(
            graph,
            places[number - 1],
            costs,
            places[number],
            around=around and last,
            allowed=None if allowed is None else allowed[number - 1],
        )
        if all(math.isinf(arrival.cost) for arrival in arrivals):
            return number
        legs.append(arrivals)
        costs = [
            arrival.cost + candidate.cost
            for arrival, candidate in zip(arrivals, places[number], strict=True)
        ]
    target = min(range(len(costs)), key=costs.__getitem__)
    cost = costs[target]
    way: list[tuple[EdgePass, ...]] = []
    for arrivals in reversed(legs):
        way.append(arrivals[target].passes)
        target = arrivals[target].source
    return Way(legs=tuple(reversed(way)), cost=cost)


def _search_leg(
    graph: LaneGraph,
    sources: Sequence[Candidate],
    source_costs: Sequence[float],
    targets: Sequence[Candidate],
    *,
    around: bool,
    allowed: Container[int] | None,
) -> list[_Arrival]:
    best = [math.inf] * len(targets)
    # Entry of the best way to a target: (source, -1) straight on, or (-1, lane of its last edge).
    entry = [(-1, -1)] * len(targets)
    if not around:
        for i, source in enumerate(sources):
            for j, target in enumerate(targets):
                cost = source_costs[i] + _straight_on(graph, source, target)
                if cost < best[j]:
                    best[j], entry[j] = cost, (i, -1)

    # Targets by the lane at whose start their edge may be entered.
    doors: dict[int, list[tuple[int, float]]] = {}
    for j, target in enumerate(targets):
        for sibling in graph.siblings[target.lane]:
            extra = change_cost(sibling.changes, target.s)
            if extra is not None:
                doors.setdefault(sibling.lane, []).append((j, target.s + extra))

    dearest = min(target.cost for target in targets) + NAMED_COST
    ends = {
        sibling.lane
        for target in targets
        if target.cost <= dearest
        for sibling in graph.siblings[target.lane]
    }
    # parent: (lane before or -1, source or -1, lane at the end of the edge before)
    parent: dict[int, tuple[int, int, int]] = {}
    cost_to: dict[int, float] = {}
    queue: list[tuple[float, int]] = []
    for i, source in enumerate(sources):
        if math.isinf(source_costs[i]):
            continue
        first = leaving(graph.lengths, graph.siblings, graph.successors, source.lane, source.s)
        for step in (*first, *_turns_asked_for(graph, source, ends)):
            if allowed is not None and step.lane not in allowed:
                continue
            cost = source_costs[i] + step.cost
            if cost < cost_to.get(step.lane, math.inf):
                cost_to[step.lane] = cost
                parent[step.lane] = (-1, i, step.exit_lane)
                heappush(queue, (cost, step.lane))
    settled: set[int] = set()
    bound = max(best)
    while queue:
        cost, lane = heappop(queue)
        if cost >= bound:
            break
        if lane in settled:
            continue
        settled.add(lane)
        if lane in doors:
            for j, rest in doors[lane]:
                if cost + rest < best[j]:
                    best[j], entry[j] = cost + rest, (-1, lane)
            bound = max(best)
        for step in graph.steps[lane]:
            if allowed is not None and step.lane not in allowed:
                continue
            through = cost + step.cost
            if through < cost_to.get(step.lane, math.inf):
                cost_to[step.lane] = through
                parent[step.lane] = (lane, -1, step.exit_lane)
                heappush(queue, (through, step.lane))
    return [
        _UNREACHABLE
        if math.isinf(best[j])
        else _arrival(graph, sources, target, best[j], entry[j], parent)
        for j, target in enumerate(targets)
    ]


def _turns_asked_for(graph: LaneGraph, source: Candidate, ends: Container[int]) -> list[Step]:
    """Returns the tight turns from the edge of a source that lead to lanes of ``ends``."""
    turns = leaving(graph.lengths, graph.siblings, graph.tight, source.lane, source.s)
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


def _arrival(
    graph: LaneGraph,
    sources: Sequence[Candidate],
    target: Candidate,
    cost: float,
    entry: tuple[int, int],
    parent: dict[int, tuple[int, int, int]],
) -> _Arrival:
    """Follows the parents back from a target to its source."""
    source, lane = entry
    if lane < 0:
        begin = sources[source]
        exit_s = max(target.s, begin.s) if target.lane == begin.lane else target.s
        only = EdgePass(
            lane=begin.lane, s=begin.s, exit_lane=target.lane, exit_s=exit_s, continues=True
        )
        return _Arrival(cost=cost, source=source, passes=(only,))
    passes: list[EdgePass] = []
    exit_lane, exit_s = target.lane, target.s
    while lane >= 0:
        passes.append(
            EdgePass(lane=lane, s=0.0, exit_lane=exit_lane, exit_s=exit_s, continues=False)
        )
        lane, source, exit_lane = parent[lane]
        exit_s = graph.lengths[exit_lane]
    begin = sources[source]
    passes.append(
        EdgePass(lane=begin.lane, s=begin.s, exit_lane=exit_lane, exit_s=exit_s, continues=True)
    )
    return _Arrival(cost=cost, source=source, passes=tuple(reversed(passes)))
