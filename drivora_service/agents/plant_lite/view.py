"""Inputs of plant-lite: the ego, pieces of the way, and others as boxes; (262,) numbers.

===========  =====================================================================================
0 to 9       the ego, as in ``WayView.show``
10 to 93     twelve pieces of the way, seven numbers each, likewise
94 to 261    twelve times another actor, the nearest first, fourteen numbers each: 1 if there is
             one; ahead and to the left (1/40 m), cosine and sine of its heading, speed (1/15 s/m),
             length (1/10 m), width (1/4 m), whether it is a walker, whether an obstacle; distance
             along the way and beside it (1/40 and 1/10 m), speed along the way and across it (1/15
             s/m); zeros if there are fewer
===========  =====================================================================================

Places and headings are in the ego's frame, except for those on the way.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.imitation.way_view import (
    EGO_SIZE,
    LENGTH_SCALE,
    PIECE_SIZE,
    PIECES,
    SPEED_SCALE,
    WayView,
)
from drivora_service.agents.interface import AgentContext, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array, FloatArray, IntArray

OBJECTS = 12
OBJECT_SIZE = 14
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
        kinds: (n,) 0 vehicle, 1 walker, 2 obstacle.
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
        dx, dy = objects[j, 0] - ego[0], objects[j, 1] - ego[1]
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
        _show_other(ego, objects[j], sizes[j, 0], sizes[j, 1], kinds[j], points, cursor, s, out[k])


@compiled
def _show_other(
    ego: FloatArray,
    other: FloatArray,
    length: float,
    width: float,
    kind: int,
    points: FloatArray,
    cursor: int,
    s: float,
    out: Float32Array,
) -> None:
    cos, sin = math.cos(ego[2]), math.sin(ego[2])
    dx, dy = other[0] - ego[0], other[1] - ego[1]
    turn = other[2] - ego[2]
    out[0] = 1.0
    out[1] = LENGTH_SCALE * (dx * cos + dy * sin)
    out[2] = LENGTH_SCALE * (dy * cos - dx * sin)
    out[3], out[4] = math.cos(turn), math.sin(turn)
    out[5] = SPEED_SCALE * math.hypot(other[3], other[4])
    out[6], out[7] = _LENGTH * length, _WIDTH * width
    out[8], out[9] = kind == 1, kind == 2
    first, last = max(cursor - _BEHIND, 0), min(cursor + _AHEAD, points.shape[0] - 2)
    near, i = np.inf, first
    for p in range(first, last + 1):
        square = (other[0] - points[p, 0]) ** 2 + (other[1] - points[p, 1]) ** 2
        if square < near:
            near, i = square, p
    ux, uy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
    span = max(math.hypot(ux, uy), 1e-9)
    ux, uy = ux / span, uy / span
    dx, dy = other[0] - points[i, 0], other[1] - points[i, 1]
    out[10] = LENGTH_SCALE * (points[i, 2] + dx * ux + dy * uy - s)
    out[11] = _ASIDE_SCALE * (ux * dy - uy * dx)
    out[12] = SPEED_SCALE * (other[3] * ux + other[4] * uy)
    out[13] = SPEED_SCALE * (ux * other[4] - uy * other[3])
