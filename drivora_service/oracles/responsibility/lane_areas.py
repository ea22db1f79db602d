"""Lanes as areas: those at a place, and how far a box reaches into them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from shapely import LineString, Point, Polygon, STRtree
from shapely.geometry.base import BaseGeometry

from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import RoadNetwork

_REACH = 30.0
"""Radius of the search for lanes around a place, metres."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaneAreas:
    """The areas of a network's lanes.

    Attributes:
        network: The network.
        areas: Areas of the lanes, by index.
        tree: Spatial index of ``areas``.
    """

    network: RoadNetwork
    areas: tuple[Polygon, ...]
    tree: STRtree

    def drivable_at(self, place: tuple[float, float], tolerance: float = 0.0) -> tuple[int, ...]:
        """Returns the drivable lanes at a place, or within ``tolerance`` metres of it."""
        return tuple(
            index for index in self._at(place, tolerance) if self.network.lanes[index].drivable
        )

    def on_crossing(self, place: tuple[float, float]) -> tuple[int, ...]:
        """Returns the pedestrian crossings at a place."""
        lanes = self.network.lanes
        return tuple(
            index
            for index in self._at(place, 0.3)
            if lanes[index].walkable and lanes[index].is_internal and "_c" in lanes[index].id
        )

    def _at(self, place: tuple[float, float], tolerance: float) -> tuple[int, ...]:
        found = self.tree.query(Point(place).buffer(tolerance + 1e-6), predicate="intersects")
        return tuple(sorted(int(index) for index in found))

    def road(self, place: tuple[float, float]) -> BaseGeometry:
        """Returns the area of all drivable lanes around a place."""
        near = self.tree.query(Point(place).buffer(_REACH))
        lanes = self.network.lanes
        return self.union(int(index) for index in near if lanes[int(index)].drivable)

    def union(self, lanes: Iterable[int]) -> BaseGeometry:
        """Returns the area of several lanes; small gaps between them are closed."""
        merged: BaseGeometry = shapely.union_all([self.areas[lane].buffer(0.05) for lane in lanes])
        return merged

    def heading(self, lane: int, place: tuple[float, float]) -> float:
        """Returns the direction of a lane at the point nearest to a place, radians."""
        shape = self.network.lanes[lane].shape
        s = LineString(shape).project(Point(place))
        return self.network.lanes[lane].position_at(float(s))[2]

    def turn(self, lane: int, place: tuple[float, float], yaw: float) -> float:
        """Returns the angle between a heading and a lane, 0 to pi radians."""
        return abs(wrap_angle(yaw - self.heading(lane, place)))


@lru_cache(maxsize=16)
def lane_areas(network: RoadNetwork) -> LaneAreas:
    """Returns the areas of a network's lanes, built on the first call for it."""
    areas = tuple(_area(lane.shape, lane.width) for lane in network.lanes)
    return LaneAreas(network=network, areas=areas, tree=STRtree(areas))


def _area(shape: FloatArray, width: float) -> Polygon:
    line = LineString(shape)
    area = line.buffer(0.5 * width, cap_style="flat", join_style="mitre", mitre_limit=2.0)
    if isinstance(area, Polygon) and not area.is_empty:
        return area
    return line.buffer(max(0.05, 0.5 * width))


def intrusion(
    box: Polygon, yaw: float, length: float, width: float, area: BaseGeometry, heading: float
) -> float:
    """Returns the mean depth in metres to which a box reaches across a lane's edge into it.

    Args:
        box: The box.
        yaw: Its heading, radians.
        length: Its length, metres.
        width: Its width, metres.
        area: The lane.
        heading: Direction of the lane, radians.
    """
    # For a box along the lane the width that overlaps, which R157 means; of one that is turned, a
    # corner that reaches in deeper counts with the share of its length that does.
    common = float(box.intersection(area).area)
    turn = yaw - heading
    extent = length * abs(math.cos(turn)) + width * abs(math.sin(turn))
    return common / extent if np.isfinite(extent) and extent > 0.0 else 0.0
