"""The way ahead as inputs of the agents that were trained here.

The choice of lanes is not learned: ``RunFollower`` makes it, as for the rule-based agents.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.agents.idm.conflicts import ZoneCol
from drivora_service.agents.idm.run_following import RunFollower, WayCol
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array, FloatArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import Col, Light


class OwnInput(IntEnum):
    """Inputs on the ego itself."""

    SPEED = 0
    LIMIT = 1
    RED = 2
    YELLOW = 3
    GREEN = 4
    PROTECTED = 5
    """Green that gives the right of way."""
    STOP_LINE = 6
    """Distance to that of the light."""
    LANE_END = 7
    """Distance to where the lane must have been left."""
    ASIDE = 8
    """Distance to the left of the way."""
    HEADING = 9
    """Sine of the heading across the way."""


class PieceInput(IntEnum):
    """Inputs of one piece of the way, at its end and in the ego's frame."""

    AHEAD = 0
    LEFT = 1
    COS = 2
    SIN = 3
    """Of the way's direction."""
    SPEED = 4
    """The desired one."""
    YIELDS = 5
    """Whether others with priority cross the piece."""
    HAS_PRIORITY = 6
    """Whether others without priority cross it."""


PIECES = 12
PIECE_SIZE = len(PieceInput)
EGO_SIZE = len(OwnInput)
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
        x, y = observation.ego[Col.X], observation.ego[Col.Y]
        runs.cursor, self.s, _ = track_line(points, points[:, WayCol.ARC], runs.cursor, 5, 30, x, y)

    def show(self, observation: Observation, own: Float32Array, pieces: Float32Array) -> None:
        """Fills the inputs of the way ahead.

        Args:
            observation: Observation of this step.
            own: (10,) filled, ``OwnInput``.
            pieces: (12, 7) filled, for each piece of the way, ``PieceInput``.
        """
        way = self._runs.way
        show_way(
            way.points, self._runs.cursor, self.s, self._half_length, way.conflicts.zones,
            observation.light_protected, observation.ego, pieces,
        )  # fmt: skip
        light = observation.light
        own[OwnInput.SPEED] = SPEED_SCALE * observation.speed
        own[OwnInput.LIMIT] = SPEED_SCALE * observation.speed_limit
        own[OwnInput.RED] = light == Light.RED
        own[OwnInput.YELLOW] = light == Light.YELLOW
        own[OwnInput.GREEN] = light == Light.GREEN
        own[OwnInput.PROTECTED] = light == Light.GREEN and observation.light_protected
        own[OwnInput.STOP_LINE] = LENGTH_SCALE * min(observation.light_distance, _FURTHEST)
        own[OwnInput.LANE_END] = LENGTH_SCALE * min(max(way.wall - self.s, 0.0), _FURTHEST)
        aside, across = place_beside(way.points, self._runs.cursor, observation.ego)
        own[OwnInput.ASIDE], own[OwnInput.HEADING] = aside, across


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
    dx, dy = ego[Col.X] - points[cursor, 0], ego[Col.Y] - points[cursor, 1]
    aside = (ux * dy - uy * dx) / span
    return min(max(0.25 * aside, -1.0), 1.0), math.sin(ego[Col.YAW] - math.atan2(uy, ux))


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
    cos, sin = math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
    i, last = cursor, points.shape[0] - 2
    begin = s - half_length
    for k in range(PIECES):
        end = s + _ENDS[k]
        while i < last and points[i + 1, WayCol.ARC] < end:
            i += 1
        ux, uy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
        span = max(math.hypot(ux, uy), 1e-9)
        ux, uy = ux / span, uy / span
        along = end - points[i, WayCol.ARC]
        dx = points[i, WayCol.X] + along * ux - ego[Col.X]
        dy = points[i, WayCol.Y] + along * uy - ego[Col.Y]
        piece = out[k]
        piece[PieceInput.AHEAD] = LENGTH_SCALE * (dx * cos + dy * sin)
        piece[PieceInput.LEFT] = LENGTH_SCALE * (dy * cos - dx * sin)
        piece[PieceInput.COS] = ux * cos + uy * sin
        piece[PieceInput.SIN] = uy * cos - ux * sin
        piece[PieceInput.SPEED] = SPEED_SCALE * points[i, WayCol.WANTED]
        piece[PieceInput.YIELDS] = piece[PieceInput.HAS_PRIORITY] = 0.0
        for z in range(zones.shape[0]):
            if zones[z, ZoneCol.ENTER] > end or zones[z, ZoneCol.LEAVE] < begin:
                continue
            ahead_of_line = zones[z, ZoneCol.GATE] - s - half_length > -1.0
            is_ours = zones[z, ZoneCol.SIGNALISED] > 0.0 and protected and ahead_of_line
            if zones[z, ZoneCol.YIELDS] > 0.0 and not is_ours:
                piece[PieceInput.YIELDS] = 1.0
            else:
                piece[PieceInput.HAS_PRIORITY] = 1.0
        begin = end
