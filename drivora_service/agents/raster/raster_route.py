"""The route of a raster: a strip as wide as its lanes, and the stop lines of its signals."""

from __future__ import annotations

import numpy as np

from drivora_service.agents.raster.raster_drawing import Strip
from drivora_service.agents.raster.raster_map import stop_line
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.heights import line_heights
from drivora_service.networks.road_network import RoadNetwork
from drivora_service.networks.routes.lane_route import LaneRoute, RouteSignal

_USUAL_WIDTH = 3.2
"""Metres; where the route is on no lane."""
_SHARPEST = 0.25
"""Least square of the cosine of half the angle of a bend; borders of sharper ones are not moved
further out."""


def route_strip(network: RoadNetwork, route: LaneRoute) -> Strip:
    """Returns a route as a strip with its signals."""
    lanes = route.point_lanes
    widths = np.array([lane.width for lane in network.lanes])
    half = 0.5 * np.where(lanes >= 0, widths[np.maximum(lanes, 0)], _USUAL_WIDTH)
    across = half[:, None] * _across(route.line)
    left, right = route.line + across, route.line - across
    heights = line_heights(network, route.line, lanes)
    controlled = [network.lanes[signal_lane(network, route, one)] for one in route.signals]
    return Strip(
        quads=np.stack((left[:-1], left[1:], right[1:], right[:-1]), axis=1),
        arc=np.array(route.arc),
        heights=np.sort(np.stack((heights[:-1], heights[1:]), axis=1), axis=1),
        signal_arcs=np.array([signal.s for signal in route.signals], dtype=np.float64),
        signal_lines=np.array([stop_line(lane) for lane in controlled]).reshape(-1, 4),
        signal_heights=np.array([[lane.heights[-1]] * 2 for lane in controlled]).reshape(-1, 2),
    )


def signal_lane(network: RoadNetwork, route: LaneRoute, signal: RouteSignal) -> int:
    """Returns the lane whose end a signal controls."""
    controls = (signal.traffic_light, signal.link_index)
    return next(
        lane
        for lane in route.runs[signal.run].lanes
        if any((c.traffic_light, c.link_index) == controls for c in network.lanes[lane].connections)
    )


def _across(line: FloatArray) -> FloatArray:
    """Returns the (n, 2) vectors to the left of a line's points that keep its borders parallel.

    A vector halves the angle between two pieces, and is longer than 1 by the inverse of the cosine
    of half that angle.
    """
    steps = np.diff(line, axis=0)
    steps = steps / np.maximum(np.hypot(steps[:, 0], steps[:, 1]), 1e-9)[:, None]
    normals = np.stack((-steps[:, 1], steps[:, 0]), axis=1)
    middle = np.concatenate((normals[:1], 0.5 * (normals[:-1] + normals[1:]), normals[-1:]))
    squares = middle[:, 0] * middle[:, 0] + middle[:, 1] * middle[:, 1]
    return middle / np.maximum(squares, _SHARPEST)[:, None]
