"""Inputs of MetaDrive's expert from an ego's perception: (275,) numbers from 0 to 1.

The layout is that of ``LidarStateObservation`` with 240 rays and four others, in the frame in which
the expert was trained: ahead and to the *right* are positive, angles run clockwise.

==========  =====================================================================================
0, 1        distance to the left and the right border of the road, over 18 m
2           heading across the road: 0.5 along it, 1 square to the right
3           speed, over 80 km/h
4           front wheels
5, 6        steering and throttle of the last decision
7           yaw rate, rad/s, without sign
8           distance from the middle of the lane to the right, over 2.25 m
9 to 13     checkpoint at the end of this piece of road: ahead, to the right (over 50 m); radius,
            side and angle of the piece's bend
14 to 18    the same of the next piece
19 to 34    the four nearest vehicles: ahead, to the right (over 50 m); relative speed ahead and
            to the right (over 80 km/h); zeros if there are fewer
35 to 274   distance to the first hit of each ray, over 50 m; the first ray points ahead
==========  =====================================================================================
"""

from __future__ import annotations

import math
from enum import IntEnum
from functools import lru_cache

import numpy as np

from drivora_service.agents.interface import ObjectKind
from drivora_service.agents.metadrive_ppo.checkpoints import PieceCol
from drivora_service.agents.metadrive_ppo.policy import OBSERVATION_SIZE
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.trace import Col, SizeCol

REACH = 50.0
"""Range of the rays, and maximum shown distance of checkpoints, metres."""
RAYS = 240
_OTHERS = 4
CHECKPOINT = slice(9, 14)
"""Inputs of the next checkpoint."""
LATER_CHECKPOINT = slice(14, 19)
"""Inputs of the one after it."""
_FIRST_OTHER = 19
_FIRST_RAY = 35
_TOP_SPEED = 80.0
"""km/h."""
_ROAD_WIDTH = 18.0
"""Metres: four lanes of 4.5 m, the most that MetaDrive's maps have."""
_LANE_WIDTH = 4.5
_CURVE_RADIUS = 60.0
"""Metres, widest bend of its maps; the width of the road is added to it."""
_CURVE_ANGLE = 135.0
"""Degrees, largest turn of its maps."""
_STEERING_SCALE = 60.0
"""Divisor of the steering, -1 to 1, where its angle in degrees was intended: the front wheels
always appear straight ahead to the expert, as in its training."""


class RoadCol(IntEnum):
    """Columns of the road beside the ego: a place in its middle."""

    X = 0
    Y = 1
    DIRECTION = 2
    """Radians."""
    WIDTH = 3
    """Metres, of all lanes in this direction."""
    LANES = 4


class _OwnInput(IntEnum):
    """Inputs on the ego itself."""

    LEFT_BORDER = 0
    RIGHT_BORDER = 1
    HEADING = 2
    SPEED = 3
    WHEELS = 4
    STEERING = 5
    THROTTLE = 6
    YAW_RATE = 7
    OFF_MIDDLE = 8


class _CheckpointInput(IntEnum):
    """Inputs of one checkpoint."""

    AHEAD = 0
    RIGHT = 1
    RADIUS = 2
    SIDE = 3
    ANGLE = 4


class _OtherInput(IntEnum):
    """Inputs of one other vehicle."""

    AHEAD = 0
    RIGHT = 1
    SPEED_AHEAD = 2
    SPEED_RIGHT = 3


_OTHER_SIZE = len(_OtherInput)


@compiled
def _unit(value: float) -> float:
    return min(max(value, 0.0), 1.0)


@compiled
def _both_ways(value: float) -> float:
    """Maps -1..1 to 0..1."""
    return min(max(0.5 * (value + 1.0), 0.0), 1.0)


@compiled
def encode_ego(
    ego: FloatArray, speed: float, place: FloatArray, last: FloatArray, out: FloatArray
) -> None:
    """Fills the inputs on the ego itself.

    Args:
        ego: (9,) the ego's state.
        speed: m/s.
        place: (5,) columns ``RoadCol``.
        last: (2,) steering and throttle of the last decision, each from -1 to 1.
        out: (275,).
    """
    steering, throttle = last[0], last[1]
    dx, dy = ego[Col.X] - place[RoadCol.X], ego[Col.Y] - place[RoadCol.Y]
    direction, width, lanes = place[RoadCol.DIRECTION], place[RoadCol.WIDTH], place[RoadCol.LANES]
    cos, sin = math.cos(direction), math.sin(direction)
    right = dx * sin - dy * cos
    from_left = 0.5 * width + right
    lane_width = width / lanes
    lane = min(max(math.floor(from_left / lane_width), 0.0), lanes - 1.0)
    out[_OwnInput.LEFT_BORDER] = _unit(from_left / _ROAD_WIDTH)
    out[_OwnInput.RIGHT_BORDER] = _unit((width - from_left) / _ROAD_WIDTH)
    out[_OwnInput.HEADING] = _both_ways(math.sin(direction - ego[Col.YAW]))
    out[_OwnInput.SPEED] = _unit((3.6 * speed + 1.0) / (_TOP_SPEED + 1.0))
    out[_OwnInput.WHEELS] = _both_ways(steering / _STEERING_SCALE)
    out[_OwnInput.STEERING] = _both_ways(steering)
    out[_OwnInput.THROTTLE] = _both_ways(throttle)
    out[_OwnInput.YAW_RATE] = _unit(abs(ego[Col.YAW_RATE]))
    off_middle = from_left - (lane + 0.5) * lane_width
    out[_OwnInput.OFF_MIDDLE] = _both_ways(2.0 * off_middle / _LANE_WIDTH)


@compiled
def encode_checkpoint(ego: FloatArray, piece: FloatArray, out: FloatArray) -> None:
    """Fills the (5,) entries of a checkpoint.

    Args:
        ego: (9,) the ego's state.
        piece: (5,) columns ``PieceCol``.
        out: (5,) filled.
    """
    dx, dy = piece[PieceCol.X] - ego[Col.X], piece[PieceCol.Y] - ego[Col.Y]
    distance = math.hypot(dx, dy)
    if distance > REACH:
        dx, dy = dx * REACH / distance, dy * REACH / distance
    cos, sin = math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
    out[_CheckpointInput.AHEAD] = _both_ways((dx * cos + dy * sin) / REACH)
    out[_CheckpointInput.RIGHT] = _both_ways((dx * sin - dy * cos) / REACH)
    out[_CheckpointInput.RADIUS] = 0.0
    out[_CheckpointInput.SIDE] = 0.5
    out[_CheckpointInput.ANGLE] = 0.5
    radius, angle = piece[PieceCol.RADIUS], piece[PieceCol.ANGLE]
    if radius > 0.0:
        out[_CheckpointInput.RADIUS] = _unit(radius / (_CURVE_RADIUS + piece[PieceCol.WIDTH]))
        out[_CheckpointInput.SIDE] = 1.0 if angle < 0.0 else 0.0
        out[_CheckpointInput.ANGLE] = _both_ways(math.degrees(abs(angle)) / _CURVE_ANGLE)


@compiled
def encode_others(
    ego: FloatArray, objects: FloatArray, sizes: FloatArray, kinds: IntArray, out: FloatArray
) -> None:
    """Fills entries 19 to 274: the nearest vehicles, and the hits of the rays.

    Args:
        ego: (9,) the ego's state.
        objects: (n, 9) perceived actors.
        sizes: (n, 2) metres.
        kinds: (n,) of ``ObjectKind``.
        out: (275,).
    """
    out[_FIRST_OTHER:_FIRST_RAY] = 0.0
    out[_FIRST_RAY:] = 1.0
    cos, sin = math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
    nearest = np.full(_OTHERS, -1)
    distances = np.full(_OTHERS, np.inf)
    for j in range(objects.shape[0]):
        dx, dy = objects[j, Col.X] - ego[Col.X], objects[j, Col.Y] - ego[Col.Y]
        distance = math.hypot(dx, dy)
        if distance > REACH + 0.5 * math.hypot(sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH]):
            continue
        _cast_rays(ego, objects[j], sizes[j], out)
        if kinds[j] != ObjectKind.VEHICLE:
            continue
        place = _OTHERS
        while place > 0 and distance < distances[place - 1]:
            place -= 1
        for k in range(_OTHERS - 1, place, -1):
            nearest[k], distances[k] = nearest[k - 1], distances[k - 1]
        if place < _OTHERS:
            nearest[place], distances[place] = j, distance
    for k in range(_OTHERS):
        j = nearest[k]
        if j < 0:
            break
        dx, dy = objects[j, Col.X] - ego[Col.X], objects[j, Col.Y] - ego[Col.Y]
        dvx = 3.6 * (objects[j, Col.VX] - ego[Col.VX])
        dvy = 3.6 * (objects[j, Col.VY] - ego[Col.VY])
        at = _FIRST_OTHER + _OTHER_SIZE * k
        out[at + _OtherInput.AHEAD] = _both_ways((dx * cos + dy * sin) / REACH)
        out[at + _OtherInput.RIGHT] = _both_ways((dx * sin - dy * cos) / REACH)
        out[at + _OtherInput.SPEED_AHEAD] = _both_ways((dvx * cos + dvy * sin) / _TOP_SPEED)
        out[at + _OtherInput.SPEED_RIGHT] = _both_ways((dvx * sin - dvy * cos) / _TOP_SPEED)


@compiled
def _cast_rays(ego: FloatArray, box: FloatArray, size: FloatArray, out: FloatArray) -> None:
    """Shortens the rays that meet a box; those that start in it hit it on leaving."""
    cos, sin = math.cos(box[Col.YAW]), math.sin(box[Col.YAW])
    step = 2.0 * math.pi / RAYS
    for edge in range(4):
        # The corners at both ends of the edge, relative to the ego: ahead, and to the right.
        ax, ay = _corner(ego, box, size, cos, sin, edge)
        bx, by = _corner(ego, box, size, cos, sin, (edge + 1) % 4)
        start = math.atan2(ay, ax)
        span = wrap_to_pi(math.atan2(by, bx) - start)
        low, high = min(start, start + span), max(start, start + span)
        ex, ey = bx - ax, by - ay
        for ray in range(math.ceil(low / step), math.floor(high / step) + 1):
            ux, uy = math.cos(ray * step), math.sin(ray * step)
            across = ux * ey - uy * ex
            if abs(across) < 1e-12:
                continue
            distance = (ax * ey - ay * ex) / across
            at = _FIRST_RAY + ray % RAYS
            if 0.0 <= distance < out[at] * REACH:
                out[at] = distance / REACH


@compiled
def _corner(
    ego: FloatArray, box: FloatArray, size: FloatArray, cos: float, sin: float, number: int
) -> tuple[float, float]:
    along = 0.5 * size[SizeCol.LENGTH] if number in (0, 3) else -0.5 * size[SizeCol.LENGTH]
    left = 0.5 * size[SizeCol.WIDTH] if number < 2 else -0.5 * size[SizeCol.WIDTH]
    dx = box[Col.X] + along * cos - left * sin - ego[Col.X]
    dy = box[Col.Y] + along * sin + left * cos - ego[Col.Y]
    c, s = math.cos(ego[Col.YAW]), math.sin(ego[Col.YAW])
    return dx * c + dy * s, dx * s - dy * c


@lru_cache(maxsize=1)
def compile_encoding() -> None:
    """Compiles the functions of this module, before an agent's first step."""
    out, ego = np.zeros(OBSERVATION_SIZE), np.zeros(9)
    encode_ego(ego, 0.0, np.array([0.0, 0.0, 0.0, 3.5, 1.0]), np.zeros(2), out)
    encode_checkpoint(ego, np.zeros(len(PieceCol)), out[CHECKPOINT])
    encode_others(ego, np.zeros((1, 9)), np.ones((1, 2)), np.zeros(1, dtype=np.int64), out)
