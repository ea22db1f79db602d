"""Forecast of other actors: constant velocity along their lane, or straight on; compiled.

Frame: the network's plane. Time runs in ``STEPS`` steps of ``STEP`` seconds.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line

STEPS = 40
STEP = 0.1
_BRAKES = -0.5
"""m/s² below which an actor is predicted to continue braking."""


@compiled
def forecast(objects: FloatArray, spans: IntArray, points: FloatArray, future: FloatArray) -> None:
    """Fills in the predicted states of all actors.

    Braking actors continue braking; accelerating ones do not continue accelerating.

    Args:
        objects: (n, 9) actors.
        spans: (n, 2) ways of actors that follow a lane, as returned by ``LanePaths.spans``.
        points: (m, 3) points of the ways.
        future: (STEPS + 1, n, 4) filled: x, y, heading, speed.
    """
    for j in range(objects.shape[0]):
        x, y, yaw = objects[j, 0], objects[j, 1], objects[j, 2]
        vx, vy = objects[j, 3], objects[j, 4]
        speed = math.hypot(vx, vy)
        ux, uy = math.cos(yaw), math.sin(yaw)
        if speed > 0.1:
            ux, uy = vx / speed, vy / speed
        pull = objects[j, 5] * ux + objects[j, 6] * uy
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
            here[3] = v
            if not follows or k == 0:
                here[0], here[1], here[2] = x + driven * ux, y + driven * uy, yaw
                continue
            at = s + driven
            while cursor < line.shape[0] - 2 and arc[cursor + 1] < at:
                cursor += 1
            dx, dy = line[cursor + 1, 0] - line[cursor, 0], line[cursor + 1, 1] - line[cursor, 1]
            span = max(math.sqrt(dx * dx + dy * dy), 1e-9)
            dx, dy = dx / span, dy / span
            t = at - arc[cursor]
            here[0] = line[cursor, 0] + t * dx - side * dy
            here[1] = line[cursor, 1] + t * dy + side * dx
            here[2] = math.atan2(dy, dx)


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
        way: (n, 4) x, y and arc length of its points, metres.
        cursor: Segment of the ego.
        sizes: (m, 2) metres.
        future: (K, m, 4) as filled by ``forecast``.
        seen: (K, m, 5) filled: arc length, metres to the left, half of the box's extent along and
            across, speed along. Metres to the left are inf far from the way.
    """
    line, arc = way[:, :2], way[:, 2]
    first, last = max(cursor - 25, 0), min(cursor + 160, line.shape[0] - 2)
    for j in range(sizes.shape[0]):
        at = first
        near = np.inf
        x, y = future[0, j, 0], future[0, j, 1]
        for i in range(first, last + 1):
            d2 = (x - line[i, 0]) ** 2 + (y - line[i, 1]) ** 2
            if d2 < near:
                near, at = d2, i
        for k in range(future.shape[0]):
            here, out = future[k, j], seen[k, j]
            at, _, side = track_line(line, arc, at, 12, 12, here[0], here[1])
            dx, dy = line[at + 1, 0] - line[at, 0], line[at + 1, 1] - line[at, 1]
            span = max(math.sqrt(dx * dx + dy * dy), 1e-9)
            dx, dy = dx / span, dy / span
            cos, sin = math.cos(here[2]), math.sin(here[2])
            c, d = abs(cos * dx + sin * dy), abs(sin * dx - cos * dy)
            along = (here[0] - line[at, 0]) * dx + (here[1] - line[at, 1]) * dy
            out[0] = arc[at] + along
            out[1] = side
            if abs(side) > 8.0 or along < -12.0 or along > 12.0 + span:
                out[1] = np.inf
            out[2] = 0.5 * (sizes[j, 0] * c + sizes[j, 1] * d)
            out[3] = 0.5 * (sizes[j, 0] * d + sizes[j, 1] * c)
            out[4] = here[3] * (cos * dx + sin * dy)
