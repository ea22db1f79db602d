"""The stop line before which an ego's part ended."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.networks.stop_lines import WayThrough, stop_lines
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col

AT_LINE = 4.0
"""Metres before a stop line within which an ego stands at it (Leaderboard, for stop signs)."""


def awaited_ways(ego: EgoView, reach: float = AT_LINE) -> tuple[WayThrough, ...]:
    """Returns the movements from the stop line that the ego had come to when its part ended.

    Args:
        ego: The ego.
        reach: Metres from its front to the line of its lane.

    Returns:
        Nothing if no line is that near, or the front is beyond it.
    """
    lines = stop_lines(ego.network)
    found = np.flatnonzero(lines.lanes == ego.lanes[-1])
    if not len(found):
        return ()
    line = int(found[0])
    x, y, yaw = ego.states[-1, [Col.X, Col.Y, Col.YAW]]
    heading_x, heading_y = math.cos(yaw), math.sin(yaw)
    front_x = x + 0.5 * ego.actor.length * heading_x
    front_y = y + 0.5 * ego.actor.length * heading_y
    (line_x, line_y), (way_x, way_y) = lines.points[line], lines.headings[line]
    ahead = float((line_x - front_x) * way_x + (line_y - front_y) * way_y)
    is_near = 0.0 <= ahead <= reach and heading_x * way_x + heading_y * way_y > 0.0
    return lines.ways[line] if is_near else ()
