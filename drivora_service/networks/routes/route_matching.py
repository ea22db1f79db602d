"""Matching the waypoints of a route to the lanes as a whole.

The waypoints are the observations of a hidden Markov model and the lane positions near them its
states, as in Newson and Krumm, "Hidden Markov Map Matching Through Noise and Sparseness", ACM GIS
2009: the distance to the lane is weighed against the detour that the lane costs, both in metres.
The sum of metres that is minimised stands for the negative logarithm of the probability, of which
distances have exponential, not Gaussian, tails here: one far waypoint does not outweigh many.
Viterbi's algorithm goes from place to place, in
:mod:`~drivora_service.networks.routes.route_search`. A detour is there the excess over the straight
distance between places, here the whole length: the difference is the same for all ways.

Three extensions are added. A waypoint on a lane is passed in that lane if this costs no more than
lane changes. If it would cost a lap, the waypoint is passed in another lane of its edge. A waypoint
that can be passed only by a detour much longer than the polyline around it is an outlier and is
omitted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_graph import LaneGraph, lane_graph
from drivora_service.networks.routes.route_search import Candidate, EdgePass, Way, search

DETOUR_SHARE = 0.25
DETOUR_LENGTH = 10.0
"""A leg is a detour if it is longer than the polyline along it by more than this share and by
more than this many metres."""

MIN_SAVING = 30.0
"""Metres by which the route must become shorter for a waypoint to be passed in another lane than
its own."""

MIN_TRACK = 5
"""Least number of places in a route with outliers: in a route of fewer, each is
intended."""

OUTLIER_FACTOR = 1.5
"""Factor on the length of the polyline around waypoints on the road that a detour must exceed to
omit them."""

OFF_ROAD_FACTOR = 1.0
"""The same factor for waypoints off the road."""

MIN_OUTLIER_DETOUR = 50.0
"""Metres that a detour must exceed to omit waypoints."""

MAX_LOST_END = 60.0
"""Metres of the polyline's end that may be omitted."""

MAX_DETOURS = 12
"""Maximum number of detours of a track with outliers; with more, the waypoints are intended."""

_MAX_RUN = 3
"""Maximum number of consecutive waypoints that may be omitted at once."""

_WINDOW = 3
"""Places on each side of a run of waypoints for computing what omitting it saves.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A point of a route with its possible lane positions.

    Attributes:
        x: Metres.
        y: Metres.
        named: Lane positions at the point with their costs.
        beside: ``named``, and the positions on the other lanes of their edges, at the same costs.
        near: The same positions; an adjacent lane costs little more than the point's own lane.
        on_road: Whether the point is on a lane.
    """

    x: float
    y: float
    named: tuple[Candidate, ...]
    beside: tuple[Candidate, ...]
    near: tuple[Candidate, ...]
    on_road: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """The way from one waypoint to the next that is not omitted.

    Attributes:
        first: Number of the waypoint that it begins at.
        last: Number of the waypoint that it ends at.
        polyline: Metres along the straight lines between the waypoints.
        length: Metres along the lanes.
    """

    first: int
    last: int
    polyline: float
    length: float

    @property
    def is_detour(self) -> bool:
        """Whether the leg is much longer than the polyline."""
        return self.length - self.polyline > max(DETOUR_LENGTH, DETOUR_SHARE * self.polyline)


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteMatch:
    """The way through the lanes that matches a polyline.

    Attributes:
        passes: The way.
        legs: Its parts between the waypoints that are passed.
        left_out: Numbers of the omitted waypoints.
    """

    passes: tuple[EdgePass, ...]
    legs: tuple[Leg, ...]
    left_out: tuple[int, ...]


def match_places(network: RoadNetwork, places: Sequence[Place]) -> RouteMatch | int:
    """Finds the way through the lanes that matches places.

    Args:
        network: The network.
        places: Start, intermediate places, destination; at least two.

    Returns:
        The match, or the number of the first place that cannot be reached.
    """
    graph = lane_graph(network)
    kept = list(range(len(places)))
    # Most routes end here: the lanes at their places make no detour.
    strict = search(graph, [place.named for place in places])
    if not isinstance(strict, int):
        exact = _make_match(graph, places, kept, strict)
        if not any(leg.is_detour for leg in exact.legs):
            return exact
    # Else the lanes may make it, so those beside are allowed. Detours that remain come from places,
    # some of which are omitted. Then each place gets back its own lane where this costs no detour.
    way = strict
    if any(place.near != place.named for place in places):
        way = search(graph, [place.near for place in places])
    if isinstance(way, int):
        return way if isinstance(strict, int) else exact
    if len(places) >= MIN_TRACK:
        kept, way = _without_outliers(graph, places, kept, way)
    way = _in_named_lanes(network, graph, [places[number] for number in kept], way)
    match = _make_match(graph, places, kept, way)
    # Not to pass every place in its own lane has to be worth it.
    if not isinstance(strict, int) and _length(exact) - _length(match) < MIN_SAVING:
        return exact
    return match


def pass_length(graph: LaneGraph, one: EdgePass) -> float:
    """Returns the length of a pass along its edge, metres.

    In a bend the lanes of an edge differ in length: the place at which the pass ends is carried
    over to its first lane by its share of the length.
    """
    end = one.exit_s * graph.lengths[one.lane] / graph.lengths[one.exit_lane]
    return max(end - one.s, 0.0)


def _length(match: RouteMatch) -> float:
    return sum(leg.length for leg in match.legs)


def _make_match(
    graph: LaneGraph, places: Sequence[Place], kept: Sequence[int], way: Way
) -> RouteMatch:
    legs = tuple(
        Leg(
            first=first,
            last=last,
            polyline=_polyline(places, first, last),
            length=sum(pass_length(graph, one) for one in passes),
        )
        for first, last, passes in zip(kept, kept[1:], way.legs, strict=False)
    )
    left_out: tuple[int, ...] = ()
    if len(kept) < len(places):
        left_out = tuple(sorted(set(range(len(places))) - set(kept)))
    return RouteMatch(passes=way.passes, legs=legs, left_out=left_out)


def _polyline(places: Sequence[Place], first: int, last: int) -> float:
    return sum(
        math.hypot(places[i + 1].x - places[i].x, places[i + 1].y - places[i].y)
        for i in range(first, last)
    )


def _without_outliers(
    graph: LaneGraph, places: Sequence[Place], kept: list[int], way: Way
) -> tuple[list[int], Way]:
    """Omits runs of waypoints, the one that saves most first, until none saves enough.

    One at a time, since omitting a run changes what omitting another one saves.

    Returns:
        The numbers of the places that are left, and the way through them.
    """
    known: dict[tuple[int, ...], float] = {}
    for _ in range(len(places)):
        detours = [
            j for j, leg in enumerate(_make_match(graph, places, kept, way).legs) if leg.is_detour
        ]
        if len(detours) > MAX_DETOURS:
            break
        # A detour is made for the place at one of its ends, maybe with neighbours of it. The start,
        # at index 0, is never omitted.
        runs = {
            (first, last)
            for j in detours
            for first in range(max(j + 1 - _MAX_RUN, 1), j + 2)
            for last in range(max(first, j), min(first + _MAX_RUN, len(kept)))
        }
        savings = {run: _compute_saving(graph, places, kept, *run, known) for run in sorted(runs)}
        best = max(savings, key=savings.__getitem__, default=None)
        if best is None or savings[best] <= 0.0:
            break
        fewer = kept[: best[0]] + kept[best[1] + 1 :]
        shorter = search(graph, [places[number].near for number in fewer])
        if isinstance(shorter, int):
            break
        kept, way = fewer, shorter
    return kept, way


def _compute_saving(
    graph: LaneGraph,
    places: Sequence[Place],
    kept: Sequence[int],
    first: int,
    last: int,
    known: dict[tuple[int, ...], float],
) -> float:
    """Returns by how many metres omitting a run saves more than it must.

    Args:
        graph: The drivable lanes.
        places: All places.
        kept: Numbers of those that are passed.
        first: Index in ``kept`` of the run's first place.
        last: Index of its last.
        known: Costs of ways through places by their numbers, metres; extended.
    """
    at_end = last == len(kept) - 1
    around = _polyline(places, kept[first - 1], kept[last if at_end else last + 1])
    if at_end and (around > MAX_LOST_END or first < 2):
        return -math.inf
    run = set(kept[first : last + 1])
    # Some places before and behind the run, both ways are the same. So the part around it tells the
    # saving, and keeps it in later rounds that omit no place of it.
    window = tuple(kept[max(first - 1 - _WINDOW, 0) : last + 2 + _WINDOW])
    fewer = tuple(number for number in window if number not in run)
    for numbers in (window, fewer):
        if numbers not in known:
            way = search(graph, [places[number].near for number in numbers])
            known[numbers] = math.inf if isinstance(way, int) else way.cost
    if math.isinf(known[window]) or math.isinf(known[fewer]):
        return -math.inf
    # Compared with the polyline around the run, which is about what the way is long without it: a
    # detour longer than that is out of proportion to the part of the route that asks for it. A
    # place on a road is more likely to be intended than one beside it.
    on_road = any(places[number].on_road for number in run)
    needed = max((OUTLIER_FACTOR if on_road else OFF_ROAD_FACTOR) * around, MIN_OUTLIER_DETOUR)
    return known[window] - known[fewer] - needed


def _in_named_lanes(
    network: RoadNetwork, graph: LaneGraph, places: Sequence[Place], way: Way
) -> Way:
    """Returns a way moved into the lanes of the places, along the same edges.

    Inside junctions all lanes are allowed, as a movement from another lane is on lanes of its own.
    """
    lanes = [way.legs[0][0].lane, *(leg[-1].exit_lane for leg in way.legs)]
    candidates = []
    for lane, place in zip(lanes, places, strict=True):
        matched = network.lanes[lane]
        found = [
            candidate
            for candidate in place.beside
            if (one := network.lanes[candidate.lane]).edge_id == matched.edge_id
            or (one.is_internal and matched.is_internal)
        ]
        candidates.append(found)
    inside = _internal_lanes(network)
    allowed = [
        inside.union(
            *(network.edge_lanes[network.lanes[one.lane].edge_id] for one in leg),
        )
        for leg in way.legs
    ]
    moved = search(graph, candidates, allowed=allowed)
    if isinstance(moved, int):
        return way
    before = sum(pass_length(graph, one) for one in way.passes)
    after = sum(pass_length(graph, one) for one in moved.passes)
    return moved if after < before + MIN_SAVING else way


@lru_cache(maxsize=128)
def _internal_lanes(network: RoadNetwork) -> frozenset[int]:
    return frozenset(lane.index for lane in network.lanes if lane.is_internal)
