"""The way ahead as inputs of the agents that were trained here.

The choice of lanes is not learned: ``RunFollower`` makes it, as for the rule-based agents.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.idm.conflicts import ZoneCol
from drivora_service.agents.idm.run_following import RunFollower
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array, FloatArray
from drivora_service.networks.routes.line_tracking import track_line

PIECES = 12
PIECE_SIZE = 7
EGO_SIZE = 10
LENGTH_SCALE = 1.0 / 40.0
"""Scale of places and distances, 1/m."""
SPEED_SCALE = 1.0 / 15.0
"""s/m."""
_FURTHEST = 80.0
"""Maximum shown distance, metres."""
_ENDS = np.array([2.0, 5.0, 8.0, 12.0, 16.0, 20.0, 25.0, 30.0, 36.0, 42.0, 50.0, 60.0])
"""Metres ahead of the ego's centre along the way at which each piece ends."""


class WayView:
    """The ego's place on its way, and the inputs of the way ahead.

    Attributes:
        s: Arc length of the ego's centre on the line of the lane run that it follows, metres.
    """

    def __init__(self, context: AgentContext) -> None:
        self._runs = RunFollower(context, 1.0)
        self._half_length = 0.5 * context.model.length
        self.s = 0.0

    @property
    def points(self) -> FloatArray:
        """(n, 4) x, y and arc length of the way, and the desired speed there, m/s."""
        return self._runs.way.points

    @property
    def cursor(self) -> int:
        """Segment of the way on which the ego is."""
        return self._runs.cursor

    def follow(self, observation: Observation) -> None:
        """Follows the way, with the lane changes of the route; called once in each step."""
        runs = self._runs
        runs.wait(observation.speed)
        runs.change_when_possible(observation)
        points = runs.way.points
        x, y = observation.ego[0], observation.ego[1]
        runs.cursor, self.s, _ = track_line(points, points[:, 2], runs.cursor, 5, 30, x, y)

    def show(self, observation: Observation, own: Float32Array, pieces: Float32Array) -> None:
        """Fills the inputs of the way ahead.

        Args:
            observation: Observation of this step.
            own: (10,) filled: speed, limit, four states of the light, distance to its stop line and
                to where the lane must have been left, distance to the left of the way, and heading
                across it. The states are red, yellow, green, and green that gives the right of way.
            pieces: (12, 7) filled: for each piece of the way x, y and direction (cosine, sine) at
                its end in the ego's frame, the desired speed there, whether others with priority
                cross it, and whether others without priority cross it.
        """
        way = self._runs.way
        show_way(
            way.points, self._runs.cursor, self.s, self._half_length, way.conflicts.zones,
            observation.light_protected, observation.ego, pieces,
        )  # fmt: skip
        light = int(observation.light)
        own[0] = SPEED_SCALE * observation.speed
        own[1] = SPEED_SCALE * observation.speed_limit
        own[2] = light == 3
        own[3] = light == 2
        own[4] = light == 1
        own[5] = light == 1 and observation.light_protected
        own[6] = LENGTH_SCALE * min(observation.light_distance, _FURTHEST)
        own[7] = LENGTH_SCALE * min(max(way.wall - self.s, 0.0), _FURTHEST)
        own[8], own[9] = place_beside(way.points, self._runs.cursor, observation.ego)


@compiled
def place_beside(points: FloatArray, cursor: int, ego: FloatArray) -> tuple[float, float]:
    """Returns the distance to the left of the way, over 4 m and at most 1, and sine of the heading.

    Args:
        points: (n, 4) of the way.
        cursor: Segment of it.
        ego: (9,) the ego's state.
    """
    ux, uy = points[cursor + 1, 0] - points[cursor, 0], points[cursor + 1, 1] - points[cursor, 1]
    span = max(math.hypot(ux, uy), 1e-9)
    dx, dy = ego[0] - points[cursor, 0], ego[1] - points[cursor, 1]
    aside = (ux * dy - uy * dx) / span
    return min(max(0.25 * aside, -1.0), 1.0), math.sin(ego[2] - math.atan2(uy, ux))


@compiled
def show_way(
    points: FloatArray,
    cursor: int,
    s: float,
    half_length: float,
    zones: FloatArray,
    protected: bool,
    ego: FloatArray,
    out: Float32Array,
) -> None:
    """Fills the pieces of the way ahead; beyond its end it continues straight.

    Args:
        points: (n, 4) of the way.
        cursor: Segment of it where the ego is.
        s: Its arc length there, metres.
        half_length: Of the ego, metres.
        zones: (C, 8) ``Conflicts.zones`` of the way.
        protected: Whether a green light gives the right of way.
        ego: (9,) the ego's state.
        out: (12, 7) filled, as in ``WayView.show``.
    """
    cos, sin = math.cos(ego[2]), math.sin(ego[2])
    i, last = cursor, points.shape[0] - 2
    begin = s - half_length
    for k in range(PIECES):
        end = s + _ENDS[k]
        while i < last and points[i + 1, 2] < end:
            i += 1
        ux, uy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
        span = max(math.hypot(ux, uy), 1e-9)
        ux, uy = ux / span, uy / span
        dx = points[i, 0] + (end - points[i, 2]) * ux - ego[0]
        dy = points[i, 1] + (end - points[i, 2]) * uy - ego[1]
        out[k, 0] = LENGTH_SCALE * (dx * cos + dy * sin)
        out[k, 1] = LENGTH_SCALE * (dy * cos - dx * sin)
        out[k, 2] = ux * cos + uy * sin
        out[k, 3] = uy * cos - ux * sin
        out[k, 4] = SPEED_SCALE * points[i, 3]
        out[k, 5] = out[k, 6] = 0.0
        for z in range(zones.shape[0]):
            if zones[z, ZoneCol.ENTER] > end or zones[z, ZoneCol.LEAVE] < begin:
                continue
            ahead_of_line = zones[z, ZoneCol.GATE] - s - half_length > -1.0
            is_ours = zones[z, ZoneCol.SIGNALISED] > 0.0 and protected and ahead_of_line
            if zones[z, ZoneCol.YIELDS] > 0.0 and not is_ours:
                out[k, 5] = 1.0
            else:
                out[k, 6] = 1.0
        begin = end
