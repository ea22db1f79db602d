"""Inputs of the driving policy from an ego's perception: (1847,) numbers.

The layout is that of ``compute_observations`` in PufferLib's GPUDrive, in the ego's frame, ahead
and to the left positive:

============  ===================================================================================
0 to 5        goal ahead and to the left (1/100 m), speed (1/100 m/s), width (1/15 m), length
              (1/30 m), 1 after a collision
6 to 446      63 times another vehicle: place, width and length, cosine and sine of its heading,
              speed; zeros if there are fewer
447 to 1846   200 times a piece of road: place of its middle, half its length (1/100 m), 0.001,
              cosine and sine of its direction, kind; zeros if there are fewer
============  ===================================================================================

Cosines and sines are multiplied by pi/2: the original intends to divide by two pi, but its macro
divides by two and multiplies by pi. Boxes are shown at 0.7 of their size, as in training.
"""

from __future__ import annotations

import math
from enum import IntEnum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.puffer_drive.policy import (
    EGO_SIZE,
    OBSERVATION_SIZE,
    ROAD_PIECES,
    ROAD_SIZE,
    VEHICLE_SIZE,
    VEHICLES,
)
from drivora_service.agents.puffer_drive.road import RoadCol
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import Float32Array, FloatArray
from drivora_service.observations.trace import Col, SizeCol

SIZE_SHARE = 0.7
"""Share of its length and width of all vehicles in the policy's training."""
SIGHT = 50.0
"""Range of the other actors, metres."""
_ROAD_SIGHT = 52.5
"""Range of the road, metres: ten and a half of the original's cells of 5 m."""
_HUNDREDTH = 0.01
_WIDTH_SCALE, _LENGTH_SCALE = SIZE_SHARE / 15.0, SIZE_SHARE / 30.0
_DIRECTION_SCALE = 0.5 * math.pi
_LINE_WIDTH = 0.001
_ROAD_AT = EGO_SIZE + VEHICLES * VEHICLE_SIZE


class _OwnInput(IntEnum):
    """Inputs on the ego itself; the last of them, a collision, stays 0."""

    GOAL_AHEAD = 0
    GOAL_LEFT = 1
    SPEED = 2
    WIDTH = 3
    LENGTH = 4


class _VehicleInput(IntEnum):
    """Inputs of one other vehicle."""

    AHEAD = 0
    LEFT = 1
    WIDTH = 2
    LENGTH = 3
    COS = 4
    SIN = 5
    SPEED = 6


class _RoadInput(IntEnum):
    """Inputs of one piece of road."""

    AHEAD = 0
    LEFT = 1
    HALF_LENGTH = 2
    WIDTH = 3
    COS = 4
    SIN = 5
    KIND = 6


@compiled
def encode(
    ego: FloatArray,
    speed: float,
    size: FloatArray,
    goal: FloatArray,
    objects: FloatArray,
    sizes: FloatArray,
    road: FloatArray,
    out: Float32Array,
) -> None:
    """Fills an observation.

    If there are too many vehicles or pieces, the nearest are shown. Walkers and obstacles
    are shown as vehicles of their size.

    Args:
        ego: (9,) the ego's state.
        speed: m/s.
        size: (2,) length and width of the ego, metres.
        goal: (2,) metres.
        objects: (n, 9) perceived actors.
        sizes: (n, 2) metres.
        road: (m, 6) columns ``RoadCol``.
        out: (1847,) filled.
    """
    out[:] = 0.0
    x, y, cos, sin = ego[Col.X], ego[Col.Y], math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
    dx, dy = goal[0] - x, goal[1] - y
    out[_OwnInput.GOAL_AHEAD] = _HUNDREDTH * (dx * cos + dy * sin)
    out[_OwnInput.GOAL_LEFT] = _HUNDREDTH * (dy * cos - dx * sin)
    out[_OwnInput.SPEED] = _HUNDREDTH * abs(speed)
    out[_OwnInput.WIDTH] = _WIDTH_SCALE * size[SizeCol.WIDTH]
    out[_OwnInput.LENGTH] = _LENGTH_SCALE * size[SizeCol.LENGTH]
    at = EGO_SIZE
    for j in _nearest(objects, x, y, SIGHT, VEHICLES):
        dx, dy = objects[j, Col.X] - x, objects[j, Col.Y] - y
        turn = objects[j, Col.YAW] - ego[Col.YAW]
        out[at + _VehicleInput.AHEAD] = _HUNDREDTH * (dx * cos + dy * sin)
        out[at + _VehicleInput.LEFT] = _HUNDREDTH * (dy * cos - dx * sin)
        out[at + _VehicleInput.WIDTH] = _WIDTH_SCALE * sizes[j, SizeCol.WIDTH]
        out[at + _VehicleInput.LENGTH] = _LENGTH_SCALE * sizes[j, SizeCol.LENGTH]
        out[at + _VehicleInput.COS] = _DIRECTION_SCALE * math.cos(turn)
        out[at + _VehicleInput.SIN] = _DIRECTION_SCALE * math.sin(turn)
        out[at + _VehicleInput.SPEED] = _HUNDREDTH * math.hypot(
            objects[j, Col.VX], objects[j, Col.VY]
        )
        at += VEHICLE_SIZE
    at = _ROAD_AT
    for j in _nearest(road, x, y, _ROAD_SIGHT, ROAD_PIECES):
        dx, dy = road[j, RoadCol.X] - x, road[j, RoadCol.Y] - y
        ux, uy = road[j, RoadCol.DIRECTION_X], road[j, RoadCol.DIRECTION_Y]
        out[at + _RoadInput.AHEAD] = _HUNDREDTH * (dx * cos + dy * sin)
        out[at + _RoadInput.LEFT] = _HUNDREDTH * (dy * cos - dx * sin)
        out[at + _RoadInput.HALF_LENGTH] = _HUNDREDTH * road[j, RoadCol.HALF_LENGTH]
        out[at + _RoadInput.WIDTH] = _LINE_WIDTH
        out[at + _RoadInput.COS] = _DIRECTION_SCALE * (ux * cos + uy * sin)
        out[at + _RoadInput.SIN] = _DIRECTION_SCALE * (uy * cos - ux * sin)
        out[at + _RoadInput.KIND] = road[j, RoadCol.KIND]
        at += ROAD_SIZE


@compiled
def _nearest(places: FloatArray, x: float, y: float, reach: float, count: int) -> NDArray[np.int64]:
    """Returns the rows of the nearest places within reach, nearest first."""
    rows = np.empty(places.shape[0], np.int64)
    squared = np.empty(places.shape[0])
    found = 0
    for j in range(places.shape[0]):
        dx, dy = places[j, 0] - x, places[j, 1] - y
        d2 = dx * dx + dy * dy
        if d2 <= reach * reach:
            rows[found], squared[found] = j, d2
            found += 1
    order = np.argsort(squared[:found], kind="mergesort")[:count]
    return rows[:found][order]


@lru_cache(maxsize=1)
def compile_encoding() -> None:
    """Compiles the functions of this module, before an agent's first step."""
    two, out = np.zeros(2), np.zeros(OBSERVATION_SIZE, dtype=np.float32)
    encode(
        np.zeros(9),
        0.0,
        two,
        two,
        np.zeros((1, 9)),
        np.ones((1, 2)),
        np.zeros((1, len(RoadCol))),
        out,
    )
