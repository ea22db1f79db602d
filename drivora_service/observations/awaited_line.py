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
    heading = np.array([math.cos(yaw), math.sin(yaw)])
    front = np.array([x, y]) + 0.5 * ego.actor.length * heading
    ahead = float((lines.points[line] - front) @ lines.headings[line])
    is_near = 0.0 <= ahead <= reach and float(heading @ lines.headings[line]) > 0.0
    return lines.ways[line] if is_near else ()
