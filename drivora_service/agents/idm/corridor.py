"""Actors in the way ahead, and actors beside; compiled.

Frame: the network's plane, metres, radians counter-clockwise from east; arc lengths are those of
the lane run that the agent follows.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.agents.interface import ObjectKind, Observation
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.observations.trace import Col, SizeCol

SIDE_ROOM = 0.35
TIGHT_ROOM = 0.08
"""Metres that suffice to creep past a standing actor."""
_WALKER_HORIZON = 3.5
"""Seconds within which a walker that approaches the corridor counts as in it."""
_CUT_IN_HORIZON = 1.2
"""Seconds within which another actor that approaches the corridor counts as in it."""


class Actors(NamedTuple):
    """Perceived actors.

    Attributes:
        objects: (n, 9), columns ``Col``.
        sizes: (n, 2), columns ``SizeCol``.
        kinds: (n,) ``ObjectKind``.
    """

    objects: FloatArray
    sizes: FloatArray
    kinds: IntArray


class Ahead(NamedTuple):
    """The actor at the end of the free corridor.

    Attributes:
        gap: Metres to it; inf without one.
        speed: Its speed along the line, m/s; 0 without one.
        row: Its row among the actors; -1 without one.
    """

    gap: float
    speed: float
    row: int


def perceived_actors(observation: Observation) -> Actors:
    """Returns the actors of an observation."""
    return Actors(observation.objects, observation.object_sizes, observation.object_kinds)


@compiled
def gap_on_line(
    line: FloatArray,
    arc: FloatArray,
    cursor: int,
    s: float,
    reach: float,
    half_length: float,
    half_width: float,
    side_room: float,
    v: float,
    actors: Actors,
) -> Ahead:
    """Finds the actor at the end of the free corridor.

    The corridor is ``side_room`` metres wider on each side than the vehicle.
    """
    objects, sizes, kinds = actors.objects, actors.sizes, actors.kinds
    best, best_speed, best_j = np.inf, 0.0, -1
    for j in range(objects.shape[0]):
        x, y = objects[j, Col.X], objects[j, Col.Y]
        radius = 0.5 * math.hypot(sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH])
        px, py = line[cursor, 0], line[cursor, 1]
        if math.hypot(x - px, y - py) > reach + radius + half_length:
            continue
        near, near_i = np.inf, -1
        cos, sin = math.cos(objects[j, Col.YAW]), math.sin(objects[j, Col.YAW])
        ahead_hit, ahead_speed = np.inf, 0.0
        for i in range(cursor, line.shape[0] - 1):
            at = arc[i] - s
            if at > reach + radius:
                break
            dx, dy = x - line[i, 0], y - line[i, 1]
            d2 = dx * dx + dy * dy
            if d2 < near:
                near, near_i = d2, i
            if d2 > (radius + half_width + 2.5) ** 2:
                continue
            ux, uy = line[i + 1, 0] - line[i, 0], line[i + 1, 1] - line[i, 1]
            span = math.sqrt(ux * ux + uy * uy)
            if span < 1e-9:
                continue
            ux, uy = ux / span, uy / span
            along, side = dx * ux + dy * uy, -dx * uy + dy * ux
            c, d = abs(cos * ux + sin * uy), abs(sin * ux - cos * uy)
            extent = 0.5 * (sizes[j, SizeCol.LENGTH] * c + sizes[j, SizeCol.WIDTH] * d)
            across = 0.5 * (sizes[j, SizeCol.LENGTH] * d + sizes[j, SizeCol.WIDTH] * c)
            if abs(along) > 1.0 or abs(side) > half_width + across + side_room:
                continue
            gap = at + along - half_length - extent
            if at + along < -half_length:
                continue
            if gap < ahead_hit:
                ahead_hit = gap
                ahead_speed = objects[j, Col.VX] * ux + objects[j, Col.VY] * uy
        if near_i >= 0 and ahead_hit == np.inf:
            # Not in the corridor yet: a walker that approaches it, or a vehicle that cuts in.
            i = near_i
            ux, uy = line[i + 1, 0] - line[i, 0], line[i + 1, 1] - line[i, 1]
            span = math.sqrt(ux * ux + uy * uy)
            if span > 1e-9:
                ux, uy = ux / span, uy / span
                dx, dy = x - line[i, 0], y - line[i, 1]
                side = -dx * uy + dy * ux
                aside = -objects[j, Col.VX] * uy + objects[j, Col.VY] * ux
                towards = -aside * math.copysign(1.0, side)
                d = abs(sin * ux - cos * uy)
                c = abs(cos * ux + sin * uy)
                across = (
                    0.5 * (sizes[j, SizeCol.LENGTH] * d + sizes[j, SizeCol.WIDTH] * c)
                    + half_width
                    + side_room
                )
                at = arc[i] - s - half_length - radius
                horizon = _WALKER_HORIZON if kinds[j] == ObjectKind.WALKER else _CUT_IN_HORIZON
                if towards > 0.3 and at > -half_length:
                    t_in = (abs(side) - across) / towards
                    t_out = (abs(side) + across) / towards
                    t_here = max(at, 0.0) / max(v, 1.0)
                    if t_in < horizon and t_in < t_here + 1.5 and t_out > t_here - 1.0:
                        ahead_hit = at
                        ahead_speed = objects[j, Col.VX] * ux + objects[j, Col.VY] * uy
        if ahead_hit < best:
            best, best_speed, best_j = ahead_hit, ahead_speed, j
    return Ahead(best, best_speed, best_j)


@compiled
def lane_is_free(
    line: FloatArray,
    arc: FloatArray,
    cursor: int,
    s: float,
    v: float,
    half_length: float,
    actors: Actors,
) -> bool:
    """Returns whether an adjacent lane has room: no actor near, none closing in."""
    objects, sizes = actors.objects, actors.sizes
    for j in range(objects.shape[0]):
        x, y = objects[j, Col.X], objects[j, Col.Y]
        if math.hypot(x - line[cursor, 0], y - line[cursor, 1]) > 80.0:
            continue
        best, best_i = 4.0, -1
        for i in range(max(cursor - 70, 0), min(cursor + 70, line.shape[0] - 1)):
            d2 = (x - line[i, 0]) ** 2 + (y - line[i, 1]) ** 2
            if d2 < best:
                best, best_i = d2, i
        if best_i < 0:
            continue
        ux, uy = line[best_i + 1, 0] - line[best_i, 0], line[best_i + 1, 1] - line[best_i, 1]
        span = max(math.sqrt(ux * ux + uy * uy), 1e-9)
        speed = (objects[j, Col.VX] * ux + objects[j, Col.VY] * uy) / span
        distance = arc[best_i] - s
        room = abs(distance) - half_length - 0.5 * sizes[j, SizeCol.LENGTH]
        if distance >= 0.0:
            if room < 3.0 + 0.3 * v + max(v - speed, 0.0) * 2.0:
                return False
        elif room < 5.0 + 0.3 * speed + max(speed - v, 0.0) * 3.5:
            return False
    return True
