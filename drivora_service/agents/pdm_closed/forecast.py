"""Forecast of other actors: constant velocity along their lane, or straight on; compiled.

Frame: the network's plane. Time runs in ``STEPS`` steps of ``STEP`` seconds.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.agents.idm.run_following import WayCol
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import Col, SizeCol

STEPS = 40
STEP = 0.1
_BRAKES = -0.5
"""m/s² below which an actor is predicted to continue braking."""


class FutureCol(IntEnum):
    """Columns of predicted states."""

    X = 0
    Y = 1
    YAW = 2
    SPEED = 3


class SeenCol(IntEnum):
    """Columns of actors as seen from a way: metres along it, to its left, and m/s along it."""

    ARC = 0
    SIDE = 1
    """inf far from the way."""
    HALF_LENGTH = 2
    """Half of the box's extent along the way."""
    HALF_WIDTH = 3
    """Half of the box's extent across the way."""
    SPEED = 4


@compiled
def forecast(objects: FloatArray, spans: IntArray, points: FloatArray, future: FloatArray) -> None:
    """Fills in the predicted states of all actors.

    Braking actors continue braking; accelerating ones do not continue accelerating.

    Args:
        objects: (n, 9) actors, columns ``Col``.
        spans: (n, 2) ways of actors that follow a lane, as returned by ``LanePaths.spans``.
        points: (m, 3) points of the ways.
        future: (STEPS + 1, n, 4) filled, columns ``FutureCol``.
    """
    for j in range(objects.shape[0]):
        x, y, yaw = objects[j, Col.X], objects[j, Col.Y], objects[j, Col.YAW]
        vx, vy = objects[j, Col.VX], objects[j, Col.VY]
        speed = math.hypot(vx, vy)
        ux, uy = math.cos(yaw), math.sin(yaw)
        if speed > 0.1:
            ux, uy = vx / speed, vy / speed
        pull = objects[j, Col.AX] * ux + objects[j, Col.AY] * uy
        if pull > _BRAKES:
            pull = 0.0
        follows = spans[j, 1] - spans[j, 0] > 1
        cursor, s, side = 0, 0.0, 0.0
        line, arc = points[spans[j, 0] : spans[j, 1], :2], points[spans[j, 0] : spans[j, 1], 2]
        if follows:
            cursor, s, side = track_line(line, arc, 0, 0, line.shape[0], x, y)
        driven, v = 0.0, speed
        for k in range(future.shape[0]):
            if k > 0:
                after = max(v + pull * STEP, 0.0)
                driven += 0.5 * (v + after) * STEP
                v = after
            here = future[k, j]
            here[FutureCol.SPEED] = v
            if not follows or k == 0:
                here[FutureCol.X], here[FutureCol.Y] = x + driven * ux, y + driven * uy
                here[FutureCol.YAW] = yaw
                continue
            at = s + driven
            while cursor < line.shape[0] - 2 and arc[cursor + 1] < at:
                cursor += 1
            dx, dy = line[cursor + 1, 0] - line[cursor, 0], line[cursor + 1, 1] - line[cursor, 1]
            span = max(math.sqrt(dx * dx + dy * dy), 1e-9)
            dx, dy = dx / span, dy / span
            t = at - arc[cursor]
            here[FutureCol.X] = line[cursor, 0] + t * dx - side * dy
            here[FutureCol.Y] = line[cursor, 1] + t * dy + side * dx
            here[FutureCol.YAW] = math.atan2(dy, dx)


@compiled
def see_from_way(
    way: FloatArray,
    cursor: int,
    sizes: FloatArray,
    future: FloatArray,
    seen: FloatArray,
) -> None:
    """Fills in the predicted states of all actors relative to a way.

    Args:
        way: (n, 4) its points, columns ``WayCol``.
        cursor: Segment of the ego.
        sizes: (m, 2) columns ``SizeCol``.
        future: (K, m, 4) as filled by ``forecast``.
        seen: (K, m, 5) filled, columns ``SeenCol``.
    """
    line, arc = way[:, :2], way[:, WayCol.ARC]
    first, last = max(cursor - 25, 0), min(cursor + 160, line.shape[0] - 2)
    for j in range(sizes.shape[0]):
        at = first
        near = np.inf
        x, y = future[0, j, FutureCol.X], future[0, j, FutureCol.Y]
        for i in range(first, last + 1):
            d2 = (x - line[i, 0]) ** 2 + (y - line[i, 1]) ** 2
            if d2 < near:
                near, at = d2, i
        for k in range(future.shape[0]):
            here, out = future[k, j], seen[k, j]
            x, y, yaw = here[FutureCol.X], here[FutureCol.Y], here[FutureCol.YAW]
            at, _, side = track_line(line, arc, at, 12, 12, x, y)
            dx, dy = line[at + 1, 0] - line[at, 0], line[at + 1, 1] - line[at, 1]
            span = max(math.sqrt(dx * dx + dy * dy), 1e-9)
            dx, dy = dx / span, dy / span
            cos, sin = math.cos(yaw), math.sin(yaw)
            c, d = abs(cos * dx + sin * dy), abs(sin * dx - cos * dy)
            along = (x - line[at, 0]) * dx + (y - line[at, 1]) * dy
            out[SeenCol.ARC] = arc[at] + along
            out[SeenCol.SIDE] = side
            if abs(side) > 8.0 or along < -12.0 or along > 12.0 + span:
                out[SeenCol.SIDE] = np.inf
            length, width = sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH]
            out[SeenCol.HALF_LENGTH] = 0.5 * (length * c + width * d)
            out[SeenCol.HALF_WIDTH] = 0.5 * (length * d + width * c)
            out[SeenCol.SPEED] = here[FutureCol.SPEED] * (cos * dx + sin * dy)
