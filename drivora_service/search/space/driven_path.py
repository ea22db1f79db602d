"""A path along lanes as the episode will drive it, for placing actors on."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from drivora_service.errors import NoRoute
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute
from drivora_service.networks.routes.routing import RoutePoint, plan_route
from drivora_service.scenario.frames import FrameTransform
from drivora_service.scenario.model import Region, Waypoint
from drivora_service.search.space.lane_walks import LaneWalk

_COORDINATE_DIGITS = 3
_DEGREE_DIGITS = 3
_ROAD_INSET = 1.0
"""Metres that places on a road keep from the junctions at its ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """A place on a path.

    Attributes:
        x: Metres.
        y: Metres.
        yaw: Direction of the path, radians.
    """

    x: float
    y: float
    yaw: float

    def beside(self, lateral: float) -> Pose:
        """Returns the place ``lateral`` metres to the left."""
        return Pose(
            x=self.x - lateral * math.sin(self.yaw),
            y=self.y + lateral * math.cos(self.yaw),
            yaw=self.yaw,
        )

    def waypoint(self, speed: float | None = None) -> Waypoint:
        """Returns it as a waypoint, rounded to a document's precision."""
        return Waypoint(
            x=round(self.x, _COORDINATE_DIGITS),
            y=round(self.y, _COORDINATE_DIGITS),
            yaw=document_angle(self.yaw),
            speed=speed if speed is None else round(speed, _COORDINATE_DIGITS),
        )


@lru_cache(maxsize=4096)
def document_angle(angle: float) -> float:
    """Rounds an angle in radians to one that a document in degrees represents exactly.

    Cached, as all places of a straight stretch have the same angle.
    """
    frame = FrameTransform()
    return frame.yaw_to_network(round(frame.yaw_from_network(angle), _DEGREE_DIGITS))


class DrivenPath:
    """A planned route by arc length, metres from its beginning.

    Attributes:
        network: The road network.
        route: The route.
        arc: (n,) arc length of each point, at most 1 m apart.
        line: (n, 2) metres.
        yaw: (n,) direction, radians, without jumps.
    """

    def __init__(self, network: RoadNetwork, route: LaneRoute) -> None:
        self.network, self.route = network, route
        self.arc, self.line = route.arc, route.line
        steps = np.diff(route.line, axis=0)
        headings = np.unwrap(elementary.arctan2(steps[:, 1], steps[:, 0]))
        self.yaw: FloatArray = np.append(headings, headings[-1])
        # Places are looked up one at a time: lists are read far faster than arrays.
        self._arcs: list[float] = self.arc.tolist()
        self._points: list[list[float]] = self.line.tolist()
        self._yaws: list[float] = self.yaw.tolist()

    @property
    def length(self) -> float:
        """Metres."""
        return float(self.arc[-1])

    @cached_property
    def in_junction(self) -> BoolArray:
        """(n,) whether each point is inside a junction."""
        inside = np.array([lane.is_internal for lane in self.network.lanes])
        points: BoolArray = inside[self.route.point_lanes]
        return points

    @cached_property
    def lane_ranges(self) -> tuple[tuple[int, float, float], ...]:
        """Lanes with the arc lengths of their beginnings and ends, in order along the path."""
        lanes = self.route.point_lanes
        firsts = np.flatnonzero(np.diff(lanes, prepend=-1))
        begins = [float(self.arc[first]) for first in firsts]
        ends = [*begins[1:], self.length]
        return tuple(
            (int(lanes[first]), begin, end)
            for first, begin, end in zip(firsts, begins, ends, strict=True)
        )

    @cached_property
    def roads(self) -> tuple[tuple[float, float], ...]:
        """Arc lengths between which the path is outside junctions, a little inside its ends."""
        roads = []
        for begin, end in _stretches(self.arc, ~self.in_junction):
            inset = min(_ROAD_INSET, 0.5 * (end - begin))
            low = begin if begin == 0.0 else begin + inset
            roads.append((low, end if end == self.length else end - inset))
        return tuple(roads)

    def is_within(self, region: Region | None) -> bool:
        """Returns whether the whole path lies in a region; ``None`` is everywhere."""
        if region is None:
            return True
        low, high = self.line.min(axis=0), self.line.max(axis=0)
        return bool(
            region.min_x <= low[0]
            and high[0] <= region.max_x
            and region.min_y <= low[1]
            and high[1] <= region.max_y
        )

    def on_road(self, s: float, after: float) -> float:
        """Returns the nearest place to ``s`` that is on a road and not before ``after``."""
        places = [min(max(s, after, low), high) for low, high in self.roads if high >= after]
        return min(places, key=lambda place: abs(place - s)) if places else self.length

    def at(self, s: float) -> Pose:
        """Returns the place at arc length ``s``, clamped to the path."""
        i = self._index(s)
        begin, end = self._arcs[i], self._arcs[i + 1]
        share = min(max((s - begin) / (end - begin), 0.0), 1.0)
        (x, y), (next_x, next_y) = self._points[i], self._points[i + 1]
        return Pose(x=x + share * (next_x - x), y=y + share * (next_y - y), yaw=self._yaws[i])

    def limit_at(self, s: float) -> float:
        """Returns the speed limit at arc length ``s``, m/s."""
        return float(self.route.speed_limits[self._index(s)])

    def range_at(self, s: float) -> int:
        """Returns the index in ``lane_ranges`` of the lane at arc length ``s``."""
        for index, (_, _, end) in enumerate(self.lane_ranges):
            if s < end:
                return index
        return len(self.lane_ranges) - 1

    def place_of(self, x: float, y: float) -> tuple[float, float]:
        """Returns arc length of, and distance to, the nearest point of the path, metres."""
        gaps = np.hypot(self.line[:, 0] - x, self.line[:, 1] - y)
        nearest = int(np.argmin(gaps))
        return float(self.arc[nearest]), float(gaps[nearest])

    def _index(self, s: float) -> int:
        """Returns the index of the line segment at arc length ``s``."""
        return min(max(bisect_right(self._arcs, s) - 1, 0), len(self._arcs) - 2)


def _stretches(arc: FloatArray, inside: BoolArray) -> list[tuple[float, float]]:
    """Returns the arc lengths of the marked stretches."""
    edges = np.flatnonzero(np.diff(inside.astype(np.int8), prepend=0, append=0))
    return [
        (float(arc[first]), float(arc[min(end, len(arc) - 1)]))
        for first, end in zip(edges[::2], edges[1::2], strict=True)
    ]


def plan_walk(network: RoadNetwork, walk: LaneWalk) -> DrivenPath | None:
    """Plans the path along a walk; ``None`` if the planner would take other lanes."""
    try:
        route = plan_route(network, walk_points(network, walk))
    except NoRoute:
        return None
    if len(route.runs) != 1 or route.runs[0].lanes != walk.lanes:
        return None
    return DrivenPath(network, route)


def walk_points(network: RoadNetwork, walk: LaneWalk) -> tuple[RoutePoint, ...]:
    """Returns the start of a walk, a place on every road that it passes, and its end."""
    first, last = walk.lanes[0], walk.lanes[-1]
    middle = [
        (lane, 0.5 * float(network.lanes[lane].arc[-1]))
        for lane in walk.lanes[1:-1]
        if not network.lanes[lane].is_internal
    ]
    places = [(first, walk.start_s), *middle, (last, walk.end_s)]
    points = []
    for lane, s in places:
        x, y, yaw = network.lanes[lane].position_at(s)
        points.append(
            RoutePoint(
                x=round(x, _COORDINATE_DIGITS),
                y=round(y, _COORDINATE_DIGITS),
                yaw=document_angle(yaw),
            )
        )
    return tuple(points)
