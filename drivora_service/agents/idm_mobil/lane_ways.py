"""The lanes beside a route, and the ways along the route's edges from each of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.right_of_way import right_of_way
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_graph import change_cost, lane_graph
from drivora_service.networks.routes.lane_route import LaneRoute, LaneRun
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.networks.routes.route_line import build_route
from drivora_service.networks.routes.route_search import EdgePass

_BEHIND = 100.0
"""Metres of a lane's line before its beginning, for actors that come from there."""
_AHEAD = 300.0
_SPACING = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class _Onward:
    """The continuation from a lane of an edge.

    Attributes:
        exit_lane: The lane of the same edge that leads on.
        here: Lane changes to it.
        in_all: Lane changes to the destination.
        then: The lanes after ``exit_lane``: through the junction, and the first of the next edge;
            empty on the last edge.
    """

    exit_lane: int
    here: int
    in_all: int
    then: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A place on one of the route's edges.

    Attributes:
        stage: Index of the route's edge, counted from its start.
        lane: Index of the lane.
        s: Arc length on it, metres.
    """

    stage: int
    lane: int
    s: float


class LaneWays:
    """All lanes of a route's edges from which its destination can be reached along these edges."""

    def __init__(self, network: RoadNetwork, route: LaneRoute) -> None:
        self._network = network
        self._graph = lane_graph(network)
        last = network.lanes[route.runs[-1].lanes[-1]]
        x, y = (float(value) for value in route.line[-1])
        _, self._end_s, _ = track_line(last.shape, last.arc, 0, 0, len(last.arc), x, y)
        self._stages: list[dict[int, _Onward]] = []
        if not last.is_internal:
            self._stages = self._onward(route.edges, last.index)

    def _onward(self, edges: tuple[str, ...], destination: int) -> list[dict[int, _Onward]]:
        final = {
            sibling.lane: _Onward(
                exit_lane=destination, here=sibling.changes, in_all=sibling.changes, then=()
            )
            for sibling in self._graph.siblings[destination]
            if change_cost(sibling.changes, self._end_s) is not None
        }
        stages = [final]
        for edge in reversed(edges[:-1]):
            stages.append(self._before(edge, stages[-1]))
        return stages[::-1]

    def _before(self, edge: str, following: dict[int, _Onward]) -> dict[int, _Onward]:
        """Returns the continuations from the lanes of an edge, from those of the next edge."""
        found: dict[int, _Onward] = {}
        for lane in self._network.edge_lanes[edge]:
            for sibling in self._graph.siblings[lane]:
                if change_cost(sibling.changes, self._graph.lengths[lane]) is None:
                    continue
                for chain in self._through(sibling.lane):
                    if chain[-1] not in following:
                        continue
                    way = _Onward(
                        exit_lane=sibling.lane,
                        here=sibling.changes,
                        in_all=sibling.changes + following[chain[-1]].in_all,
                        then=chain,
                    )
                    known = found.get(lane)
                    if known is None or (way.in_all, way.here) < (known.in_all, known.here):
                        found[lane] = way
        return found

    def _through(self, lane: int) -> list[tuple[int, ...]]:
        """Returns the lanes after a lane, up to the first outside the junction, for each way."""
        ways = []
        for following in self._graph.successors[lane]:
            chain = [following]
            while self._network.lanes[chain[-1]].is_internal and self._graph.successors[chain[-1]]:
                chain.append(self._graph.successors[chain[-1]][0])
            ways.append(tuple(chain))
        return ways

    def beside(self, place: Place, *, left: bool) -> Place | None:
        """Returns the place on the neighbouring lane if the route can be followed from there."""
        lane = self._network.lanes[place.lane]
        index = lane.left if left else lane.right
        if index < 0 or index not in self._stages[place.stage]:
            return None
        share = self._graph.lengths[index] / self._graph.lengths[place.lane]
        return Place(stage=place.stage, lane=index, s=place.s * share)

    def knows(self, place: Place) -> bool:
        """Returns whether the destination can be reached from a place along the route's edges."""
        return place.stage < len(self._stages) and place.lane in self._stages[place.stage]

    def room(self, place: Place) -> tuple[float, int]:
        """Returns the metres until the lane must be left for the route, and the number of changes.

        Infinite metres and no changes if it leads to the destination.
        """
        stage, lane, metres = place.stage, place.lane, -place.s
        while True:
            way = self._stages[stage][lane]
            if way.here:
                end = self._graph.lengths[lane] if way.then else self._end_s
                return metres + end, way.here
            if not way.then:
                return math.inf, 0
            metres += sum(self._graph.lengths[one] for one in (lane, *way.then[:-1]))
            stage, lane = stage + 1, way.then[-1]

    def to_lane_end(self, place: Place) -> float:
        """Returns the metres to the end of the lane."""
        return self._graph.lengths[place.lane] - place.s

    def route(self, place: Place) -> LaneRoute:
        """Returns the route from a place to the destination."""
        passes = []
        stage, lane, s = place.stage, place.lane, place.s
        while True:
            way = self._stages[stage][lane]
            end = self._graph.lengths[way.exit_lane] if way.then else self._end_s
            passes.append(self._pass(lane, s, way.exit_lane, max(end, s if not way.then else 0.0)))
            if not way.then:
                return build_route(self._network, passes)
            passes.extend(
                self._pass(inner, 0.0, inner, self._graph.lengths[inner]) for inner in way.then[:-1]
            )
            stage, lane, s = stage + 1, way.then[-1], 0.0

    def _pass(self, lane: int, s: float, exit_lane: int, exit_s: float) -> EdgePass:
        return EdgePass(lane=lane, s=s, exit_lane=exit_lane, exit_s=exit_s, continues=False)

    def line(self, place: Place) -> FloatArray:
        """Returns the (n, 3) centre line of a lane with its predecessor and successor.

        Columns: x, y, arc length, metres.
        """
        lanes = [place.lane]
        before, behind = right_of_way(self._network).before, 0.0
        while behind < _BEHIND and before.get(lanes[0]) and before[lanes[0]][0] not in lanes:
            lanes.insert(0, before[lanes[0]][0])
            behind += self._graph.lengths[lanes[0]]
        stage, lane, ahead = place.stage, place.lane, 0.0
        while ahead < _AHEAD:
            way = self._stages[stage][lane]
            ahead += self._graph.lengths[lane]
            if way.here or not way.then:
                break
            lanes.extend(way.then)
            stage, lane = stage + 1, way.then[-1]
        points = np.concatenate([self._network.lanes[lane].shape for lane in lanes])
        arc = arc_lengths(points)
        distinct = np.concatenate(([True], np.diff(arc) > 1e-3))
        points, arc = points[distinct], arc[distinct]
        fine = np.linspace(0.0, arc[-1], max(2, math.ceil(arc[-1] / _SPACING) + 1))
        return np.column_stack([np.interp(fine, arc, points[:, k]) for k in (0, 1)] + [fine])


class Places:
    """The edges and lanes of the parts of a route's lane runs."""

    def __init__(self, network: RoadNetwork, route: LaneRoute, first_stage: int) -> None:
        """Args: first_stage: Index of the whole route's edge on which this one begins."""
        self._network = network
        self._starts: list[FloatArray] = []
        self._lanes: list[tuple[int, ...]] = []
        self._stages: list[list[int]] = []
        stage = first_stage - 1
        for number, run in enumerate(route.runs):
            stages = []
            for nth, lane in enumerate(run.lanes):
                if network.lanes[lane].is_internal:
                    stages.append(-1)
                    continue
                # After a lane change, the run begins on the edge on which the preceding one ended.
                if number == 0 or nth > 0:
                    stage += 1
                stages.append(stage)
            self._starts.append(_lane_starts(network, run))
            self._lanes.append(run.lanes)
            self._stages.append(stages)

    def at(self, run: int, s: float) -> Place | None:
        """Returns the place at arc length ``s`` of a lane run; ``None`` inside a junction."""
        starts = self._starts[run]
        nth = max(int(np.searchsorted(starts, s, side="right")) - 1, 0)
        stage, lane = self._stages[run][nth], self._lanes[run][nth]
        if stage < 0:
            return None
        length = float(self._network.lanes[lane].arc[-1])
        on_lane = min(max(s - float(starts[nth]), 0.0), length)
        return Place(stage=stage, lane=lane, s=on_lane)


def _lane_starts(network: RoadNetwork, run: LaneRun) -> FloatArray:
    """Returns the start of each lane on a run's line, with an error of up to two metres."""
    lengths = np.array([float(network.lanes[lane].arc[-1]) for lane in run.lanes])
    total = float(lengths.sum())
    starts: FloatArray = np.concatenate(([0.0], np.cumsum(lengths)[:-1]))
    return starts * (float(run.arc[-1]) / max(total, 1e-9))
