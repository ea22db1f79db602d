"""Inputs of plant-lite: the ego, pieces of the way, and others as boxes; (262,) numbers.

===========  =====================================================================================
0 to 9       the ego, as in ``WayView.show``
10 to 93     twelve pieces of the way, seven numbers each, likewise
94 to 261    twelve times another actor, the nearest first, fourteen numbers each, ``OtherInput``;
             zeros if there are fewer
===========  =====================================================================================

Places and headings are in the ego's frame, except for those on the way.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.agents.idm.run_following import WayCol
from drivora_service.agents.imitation.way_view import (
    EGO_SIZE,
    LENGTH_SCALE,
    PIECE_SIZE,
    PIECES,
    SPEED_SCALE,
    WayView,
)
from drivora_service.agents.interface import AgentContext, ObjectKind, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array, FloatArray, IntArray
from drivora_service.observations.trace import Col, SizeCol


class OtherInput(IntEnum):
    """Inputs of one other actor."""

    PRESENT = 0
    """1 if there is one."""
    AHEAD = 1
    LEFT = 2
    """1/40 m, of both."""
    COS = 3
    SIN = 4
    """Of its heading."""
    SPEED = 5
    """1/15 s/m, as the two others."""
    LENGTH = 6
    """1/10 m."""
    WIDTH = 7
    """1/4 m."""
    IS_WALKER = 8
    IS_OBSTACLE = 9
    ALONG = 10
    """Distance along the way, 1/40 m."""
    ASIDE = 11
    """Distance beside the way, positive to the left, 1/10 m."""
    SPEED_ALONG = 12
    SPEED_ACROSS = 13


OBJECTS = 12
OBJECT_SIZE = len(OtherInput)
OBJECTS_AT = EGO_SIZE + PIECES * PIECE_SIZE
SEEN_SIZE = OBJECTS_AT + OBJECTS * OBJECT_SIZE
SIGHT = 60.0
"""Range of the other actors, metres."""
_ASIDE_SCALE = 0.1
_LENGTH, _WIDTH = 0.1, 0.25
_BEHIND, _AHEAD = 40, 90
"""Segments of the way, before and behind the ego's, on which others are projected."""


class PlantView:
    """Fills the inputs of the network.

    Attributes:
        seen: (262,) after ``look``.
    """

    def __init__(self) -> None:
        self.seen = np.zeros(SEEN_SIZE, dtype=np.float32)
        self._own = self.seen[:EGO_SIZE]
        self._pieces = self.seen[EGO_SIZE:OBJECTS_AT].reshape(PIECES, PIECE_SIZE)
        self._others = self.seen[OBJECTS_AT:].reshape(OBJECTS, OBJECT_SIZE)

    def setup_env(self, context: AgentContext) -> None:
        """Finds the way of a run."""
        self._way = WayView(context)

    def follow(self, observation: Observation) -> None:
        """Follows the way."""
        self._way.follow(observation)

    def look(self, observation: Observation) -> None:
        """Fills ``seen``."""
        self._way.show(observation, self._own, self._pieces)
        show_others(
            observation.ego, observation.objects, observation.object_sizes,
            observation.object_kinds, self._way.points, self._way.cursor, self._way.s,
            self._others,
        )  # fmt: skip


@compiled
def show_others(
    ego: FloatArray,
    objects: FloatArray,
    sizes: FloatArray,
    kinds: IntArray,
    points: FloatArray,
    cursor: int,
    s: float,
    out: Float32Array,
) -> None:
    """Fills the others.

    Args:
        ego: (9,) the ego's state.
        objects: (n, 9) perceived actors.
        sizes: (n, 2) metres.
        kinds: (n,) of ``ObjectKind``.
        points: (m, 4) of the way.
        cursor: Segment of the ego on it.
        s: Its arc length there, metres.
        out: (12, 14) filled.
    """
    out[:] = 0.0
    nearest = np.empty(OBJECTS, np.int64)
    squares = np.empty(OBJECTS)
    found = 0
    for j in range(objects.shape[0]):
        dx, dy = objects[j, Col.X] - ego[Col.X], objects[j, Col.Y] - ego[Col.Y]
        square = dx * dx + dy * dy
        if square > SIGHT * SIGHT or (found == OBJECTS and square >= squares[found - 1]):
            continue
        found = min(found + 1, OBJECTS)
        place = found - 1
        while place > 0 and square < squares[place - 1]:
            nearest[place], squares[place] = nearest[place - 1], squares[place - 1]
            place -= 1
        nearest[place], squares[place] = j, square
    for k in range(found):
        j = nearest[k]
        _show_other(ego, objects[j], sizes[j], kinds[j], points, cursor, s, out[k])


@compiled
def _show_other(
    ego: FloatArray,
    other: FloatArray,
    size: FloatArray,
    kind: int,
    points: FloatArray,
    cursor: int,
    s: float,
    out: Float32Array,
) -> None:
    cos, sin = math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
    dx, dy = other[Col.X] - ego[Col.X], other[Col.Y] - ego[Col.Y]
    turn = other[Col.YAW] - ego[Col.YAW]
    out[OtherInput.PRESENT] = 1.0
    out[OtherInput.AHEAD] = LENGTH_SCALE * (dx * cos + dy * sin)
    out[OtherInput.LEFT] = LENGTH_SCALE * (dy * cos - dx * sin)
    out[OtherInput.COS], out[OtherInput.SIN] = math.cos(turn), math.sin(turn)
    out[OtherInput.SPEED] = SPEED_SCALE * math.hypot(other[Col.VX], other[Col.VY])
    out[OtherInput.LENGTH] = _LENGTH * size[SizeCol.LENGTH]
    out[OtherInput.WIDTH] = _WIDTH * size[SizeCol.WIDTH]
    out[OtherInput.IS_WALKER] = kind == ObjectKind.WALKER
    out[OtherInput.IS_OBSTACLE] = kind == ObjectKind.OBSTACLE
    first, last = max(cursor - _BEHIND, 0), min(cursor + _AHEAD, points.shape[0] - 2)
    near, i = np.inf, first
    for p in range(first, last + 1):
        square = (other[Col.X] - points[p, 0]) ** 2 + (other[Col.Y] - points[p, 1]) ** 2
        if square < near:
            near, i = square, p
    ux, uy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
    span = max(math.hypot(ux, uy), 1e-9)
    ux, uy = ux / span, uy / span
    dx, dy = other[Col.X] - points[i, 0], other[Col.Y] - points[i, 1]
    out[OtherInput.ALONG] = LENGTH_SCALE * (points[i, WayCol.ARC] + dx * ux + dy * uy - s)
    out[OtherInput.ASIDE] = _ASIDE_SCALE * (ux * dy - uy * dx)
    out[OtherInput.SPEED_ALONG] = SPEED_SCALE * (other[Col.VX] * ux + other[Col.VY] * uy)
    out[OtherInput.SPEED_ACROSS] = SPEED_SCALE * (ux * other[Col.VY] - uy * other[Col.VX])
