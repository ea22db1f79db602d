"""Likely ways of other actors: along their lane, with the straightest continuation."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.networks.projection import lane_positions_near
from drivora_service.networks.road_network import LanePosition, RoadNetwork
from drivora_service.networks.routes.lane_graph import lane_graph
from drivora_service.observations.trace import Col

_PERIOD = 10
"""Steps between checks of an actor's lane."""
_AHEAD = 110.0
_SPACING = 2.0
_BESIDE = 2.0
"""Metres from a lane's centre up to which a vehicle follows it."""
_ALONG = math.cos(math.radians(40.0))
_STANDING = 0.3
_BEND_AHEAD = 6.0
_BEND_WEIGHT = 4.0
"""Metres beside a lane that count like a radian of difference between its bend and the motion."""


class LanePaths:
    """Ways of all considered vehicles; one pool of points for all lanes."""

    def __init__(self, network: RoadNetwork) -> None:
        self._network = network
        self._graph = lane_graph(network)
        self.points: FloatArray = np.zeros((1024, 3))
        self._used = 0
        self._spans: dict[int, tuple[int, int]] = {}
        self._of: dict[int, tuple[int, tuple[int, int]]] = {}

    def spans(self, step: int, objects: FloatArray, kinds: IntArray, ids: IntArray) -> IntArray:
        """Returns each actor's way as a range of ``points``.

        Args:
            step: Row of the trace.
            objects: (n, 9) actors, columns ``Col``.
            kinds: (n,) 0 for vehicles.
            ids: (n,) constant numbers of the actors.

        Returns:
            (n, 2) first row and end in ``points`` (x, y, arc length); (0, 0) for actors that follow
            no lane.
        """
        spans = np.zeros((len(objects), 2), dtype=np.int64)
        speeds = np.hypot(objects[:, Col.VX], objects[:, Col.VY])
        for j in np.flatnonzero((kinds == 0) & (speeds > _STANDING)).tolist():
            number = int(ids[j])
            known = self._of.get(number)
            if known is None or step >= known[0]:
                known = (step + _PERIOD, self._match(objects[j].tolist(), float(speeds[j])))
                self._of[number] = known
            spans[j] = known[1]
        return spans

    def _match(self, state: list[float], speed: float) -> tuple[int, int]:
        x, y, yaw, turn = state[Col.X], state[Col.Y], state[Col.YAW], state[Col.YAW_RATE]
        near = lane_positions_near(self._network, x, y, max_distance=_BESIDE, heading=yaw)
        along = [place for place in near if math.cos(place.heading - yaw) > _ALONG]
        if not along:
            return 0, 0
        bend = turn / max(speed, 1.0) * _BEND_AHEAD

        def misfit(place: LanePosition) -> float:
            return abs(place.lateral) + _BEND_WEIGHT * abs(self._bend(place) - bend)

        chosen = along[0] if len(along) == 1 else min(along, key=misfit)
        return self._span(chosen.lane)

    def _bend(self, place: LanePosition) -> float:
        """Returns the turn of a lane over the next metres, radians."""
        lane, s = self._network.lanes[place.lane], place.s + _BEND_AHEAD
        while s > float(lane.arc[-1]) and (following := self._graph.successors[lane.index]):
            s -= float(lane.arc[-1])
            lane = self._network.lanes[following[0]]
        return wrap_angle(lane.position_at(s)[2] - place.heading)

    def _span(self, lane: int) -> tuple[int, int]:
        span = self._spans.get(lane)
        if span is None:
            line = self._draw(lane)
            while self._used + len(line) > len(self.points):
                self.points = np.concatenate((self.points, np.zeros_like(self.points)))
            span = (self._used, self._used + len(line))
            self.points[span[0] : span[1]] = line
            self._used = span[1]
            self._spans[lane] = span
        return span

    def _draw(self, lane: int) -> FloatArray:
        """Returns the way from the beginning of a lane, at branches the straightest."""
        lanes, ahead = [lane], 0.0
        while ahead < _AHEAD and (following := self._graph.successors[lanes[-1]]):
            lanes.append(min(following, key=self._turn))
            ahead += self._graph.lengths[lanes[-1]]
        points = np.concatenate([self._network.lanes[one].shape for one in lanes])
        arc = arc_lengths(points)
        distinct = np.concatenate(([True], np.diff(arc) > 1e-3))
        points, arc = points[distinct], arc[distinct]
        fine = np.linspace(0.0, arc[-1], max(2, math.ceil(arc[-1] / _SPACING) + 1))
        return np.column_stack(
            (np.interp(fine, arc, points[:, 0]), np.interp(fine, arc, points[:, 1]), fine)
        )

    def _turn(self, lane: int) -> float:
        shape = self._network.lanes[lane]
        turned = shape.position_at(math.inf)[2] - shape.position_at(0.0)[2]
        return abs(wrap_angle(turned))
