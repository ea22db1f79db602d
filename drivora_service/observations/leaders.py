"""Actors ahead of an ego by row: their distance, and their speed along the ego's heading."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, Int32Array
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Col, Role, SizeCol

VEHICLES = (Role.EGO, Role.NPC_VEHICLE, Role.BACKGROUND)

SAME_WAY = math.radians(45.0)
"""Difference of headings up to which one vehicle follows another, radians."""

_ROUNDING = 1e-6
"""Metres by which the quick check is wider than the exact one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Leaders:
    """The nearest actor in the strip that the ego's width sweeps along its heading.

    Attributes:
        actor: (n,) row of the actor in the trace, -1 if there is none.
        room: (n,) metres between the boxes, inf if there is none.
        speed: (n,) speed of the actor along the ego's heading, m/s, NaN if there is none.
        same_way: (n,) whether its heading is similar to the ego's.
    """

    actor: Int32Array
    room: FloatArray
    speed: FloatArray
    same_way: BoolArray


def leaders(ego: EgoView, *, margin: float = 0.0, vehicles_only: bool = False) -> Leaders:
    """Returns the actors ahead of an ego.

    Args:
        ego: The ego.
        margin: Metres by which the strip is wider on each side.
        vehicles_only: Whether walkers and obstacles are ignored.
    """
    trace = ego.trace
    part = slice(ego.first, ego.first + ego.count)
    counts = np.array(
        [
            actor.row != ego.row and (not vehicles_only or actor.role in VEHICLES)
            for actor in trace.actors
        ]
    )
    sizes = np.array([(actor.length, actor.width) for actor in trace.actors])
    actor, room, speed, same = _in_front(
        np.ascontiguousarray(trace.states[part]),
        trace.present[part] & counts,
        sizes,
        ego.row,
        margin,
        SAME_WAY,
    )
    return Leaders(actor=actor, room=room, speed=speed, same_way=same)


@compiled
def _in_front(
    states: FloatArray,
    counts: BoolArray,
    sizes: FloatArray,
    row: int,
    margin: float,
    same_way: float,
) -> tuple[Int32Array, FloatArray, FloatArray, BoolArray]:
    rows = states.shape[0]
    actor = np.full(rows, -1, dtype=np.int32)
    room = np.full(rows, np.inf)
    speed = np.full(rows, np.nan)
    same = np.zeros(rows, dtype=np.bool_)
    length = sizes[row, SizeCol.LENGTH]
    width = sizes[row, SizeCol.WIDTH] + 2.0 * margin
    for t in range(rows):
        ego = states[t, row]
        cos, sin = math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
        for j in range(states.shape[1]):
            other = states[t, j]
            if not counts[t, j] or abs(other[Col.Z] - ego[Col.Z]) > LEVEL_GAP:
                continue
            other_length, other_width = sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH]
            dx, dy = other[Col.X] - ego[Col.X], other[Col.Y] - ego[Col.Y]
            ahead = dx * cos + dy * sin
            across = abs(-dx * sin + dy * cos)
            # The second condition only saves the angles of most actors.
            if ahead <= 0.0 or across >= 0.5 * (width + other_length + other_width) + _ROUNDING:
                continue
            turn = other[Col.YAW] - ego[Col.YAW]
            c, s = abs(math.cos(turn)), abs(math.sin(turn))
            if across >= 0.5 * (width + other_length * s + other_width * c):
                continue
            gap = max(ahead - 0.5 * (length + other_length * c + other_width * s), 0.0)
            if gap < room[t]:
                actor[t], room[t] = j, gap
                speed[t] = other[Col.VX] * cos + other[Col.VY] * sin
                same[t] = math.cos(turn) >= math.cos(same_way)
    return actor, room, speed, same
