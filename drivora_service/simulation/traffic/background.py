"""SUMO-driven background traffic: a fixed number of vehicles on random routes."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.road_network import Lane, RoadNetwork
from drivora_service.networks.routes.tight_turns import tight_turns
from drivora_service.scenario.model import Region

LENGTH = 4.6
WIDTH = 1.85
HEIGHT = 1.5
MODEL = "background"
_ROUTE_EDGES = 12
_CLEARANCE = 20.0
_SPACING = 12.0
_TRIES = 60


class Wanderers:
    """Draws entry points and endless random routes on the lane graph."""

    def __init__(
        self, network: RoadNetwork, region: Region | None, rng: np.random.Generator
    ) -> None:
        self._rng = rng
        self._region = region
        self._next: dict[str, tuple[str, ...]] = {}
        lanes: list[Lane] = []
        for lane in network.lanes:
            if not lane.drivable or lane.is_internal:
                continue
            follows = sorted(set(_edges_behind(network, lane)))
            merged = {*self._next.get(lane.edge_id, ()), *follows}
            self._next[lane.edge_id] = tuple(sorted(merged))
            if lane.length >= 2.0 * LENGTH and _reaches_into(region, lane):
                lanes.append(lane)
        self._lanes = lanes
        total = np.array([lane.length for lane in lanes])
        self._weights = total / total.sum() if lanes else total

    def draw_route(self, edge: str) -> list[str]:
        """Draws a random walk that begins with ``edge``; shorter at a dead end."""
        route = [edge]
        while len(route) < _ROUTE_EDGES:
            choices = self._next.get(route[-1], ())
            # At a dead end a vehicle leaves: U-turns there lead off the road.
            if not choices:
                break
            # Avoid U-turns elsewhere, which are not typical of traffic.
            onward = tuple(c for c in choices if not _is_turn_around(route[-1], c)) or choices
            route.append(onward[int(self._rng.integers(len(onward)))])
        return route

    def draw_entry(self, taken: FloatArray) -> tuple[Lane, float] | None:
        """Draws a place for a vehicle, away from occupied places.

        Args:
            taken: (n, 2) occupied positions, metres.

        Returns:
            Lane and arc length of the front bumper, or ``None`` if the road is full.
        """
        if not self._lanes:
            return None
        for _ in range(_TRIES):
            lane = self._lanes[int(self._rng.choice(len(self._lanes), p=self._weights))]
            s = float(self._rng.uniform(LENGTH, max(lane.length - 2.0, LENGTH + 0.1)))
            x, y, _ = lane.position_at(s * float(lane.arc[-1]) / lane.length)
            if not _contains(self._region, x, y):
                continue
            if not len(taken) or float(np.min(np.hypot(*(taken - (x, y)).T))) > _SPACING:
                return lane, s
        return None


def clearance_points(x: float, y: float) -> FloatArray:
    """Returns (9, 2) points around a start that keep a safe distance free, metres."""
    angles = np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False)
    directions = np.column_stack((elementary.cos(angles), elementary.sin(angles)))
    ring = directions * (_CLEARANCE - _SPACING)
    return np.concatenate((np.array([(x, y)]), ring + np.array([x, y])))


def _edges_behind(network: RoadNetwork, lane: Lane) -> list[str]:
    """Returns the edges that the lane's movements lead to, through internal lanes.

    Turns that no car can drive are left out.
    """
    turns = tight_turns(network)
    found = []
    for connection in lane.connections:
        if (lane.index, connection.to_lane) in turns:
            continue
        target = network.lanes[connection.to_lane]
        while target.is_internal and target.drivable and target.connections:
            target = network.lanes[target.connections[0].to_lane]
        if not target.is_internal and target.drivable:
            found.append(target.edge_id)
    return found


def _is_turn_around(edge: str, onward: str) -> bool:
    return edge.lstrip("-") == onward.lstrip("-") and edge != onward


def _reaches_into(region: Region | None, lane: Lane) -> bool:
    places = np.linspace(0.0, float(lane.arc[-1]), 1 + math.ceil(lane.length / _SPACING))
    return any(_contains(region, *lane.position_at(float(s))[:2]) for s in places)


def _contains(region: Region | None, x: float, y: float) -> bool:
    if region is None:
        return True
    return region.min_x <= x <= region.max_x and region.min_y <= y <= region.max_y
