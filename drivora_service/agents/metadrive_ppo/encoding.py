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
from functools import lru_cache

import numpy as np

from drivora_service.agents.metadrive_ppo.policy import OBSERVATION_SIZE
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi

REACH = 50.0
"""Range of the rays, and maximum shown distance of checkpoints, metres."""
RAYS = 240
_OTHERS = 4
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
    """Fills entries 0 to 8.

    Args:
        ego: (9,) the ego's state.
        speed: m/s.
        place: (5,) x, y and direction of the middle of the road beside the ego, the road's width in
            metres, and its number of lanes.
        last: (2,) steering and throttle of the last decision.
        out: (275,).
    """
    dx, dy = ego[0] - place[0], ego[1] - place[1]
    cos, sin = math.cos(place[2]), math.sin(place[2])
    right = dx * sin - dy * cos
    from_left = 0.5 * place[3] + right
    lane_width = place[3] / place[4]
    lane = min(max(math.floor(from_left / lane_width), 0.0), place[4] - 1.0)
    out[0] = _unit(from_left / _ROAD_WIDTH)
    out[1] = _unit((place[3] - from_left) / _ROAD_WIDTH)
    out[2] = _both_ways(math.sin(place[2] - ego[2]))
    out[3] = _unit((3.6 * speed + 1.0) / (_TOP_SPEED + 1.0))
    out[4] = _both_ways(last[0] / _STEERING_SCALE)
    out[5] = _both_ways(last[0])
    out[6] = _both_ways(last[1])
    out[7] = _unit(abs(ego[7]))
    out[8] = _both_ways(2.0 * (from_left - (lane + 0.5) * lane_width) / _LANE_WIDTH)


@compiled
def encode_checkpoint(ego: FloatArray, piece: FloatArray, out: FloatArray) -> None:
    """Fills the (5,) entries of a checkpoint.

    Args:
        ego: (9,) the ego's state.
        piece: (5,) a row of ``Checkpoints.pieces``.
        out: (5,).
    """
    dx, dy = piece[0] - ego[0], piece[1] - ego[1]
    distance = math.hypot(dx, dy)
    if distance > REACH:
        dx, dy = dx * REACH / distance, dy * REACH / distance
    cos, sin = math.cos(ego[2]), math.sin(ego[2])
    out[0] = _both_ways((dx * cos + dy * sin) / REACH)
    out[1] = _both_ways((dx * sin - dy * cos) / REACH)
    out[2], out[3], out[4] = 0.0, 0.5, 0.5
    if piece[2] > 0.0:
        out[2] = _unit(piece[2] / (_CURVE_RADIUS + piece[4]))
        out[3] = 1.0 if piece[3] < 0.0 else 0.0
        out[4] = _both_ways(math.degrees(abs(piece[3])) / _CURVE_ANGLE)


@compiled
def encode_others(
    ego: FloatArray, objects: FloatArray, sizes: FloatArray, kinds: IntArray, out: FloatArray
) -> None:
    """Fills entries 19 to 274: the nearest vehicles, and the hits of the rays.

    Args:
        ego: (9,) the ego's state.
        objects: (n, 9) perceived actors.
        sizes: (n, 2) metres.
        kinds: (n,) 0 vehicle, 1 walker, 2 obstacle.
        out: (275,).
    """
    out[_FIRST_OTHER:_FIRST_RAY] = 0.0
    out[_FIRST_RAY:] = 1.0
    cos, sin = math.cos(ego[2]), math.sin(ego[2])
    nearest = np.full(_OTHERS, -1)
    distances = np.full(_OTHERS, np.inf)
    for j in range(objects.shape[0]):
        dx, dy = objects[j, 0] - ego[0], objects[j, 1] - ego[1]
        distance = math.hypot(dx, dy)
        if distance > REACH + 0.5 * math.hypot(sizes[j, 0], sizes[j, 1]):
            continue
        _cast_rays(ego, objects[j], sizes[j], out)
        if kinds[j] != 0:
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
        dx, dy = objects[j, 0] - ego[0], objects[j, 1] - ego[1]
        dvx, dvy = 3.6 * (objects[j, 3] - ego[3]), 3.6 * (objects[j, 4] - ego[4])
        at = _FIRST_OTHER + 4 * k
        out[at] = _both_ways((dx * cos + dy * sin) / REACH)
        out[at + 1] = _both_ways((dx * sin - dy * cos) / REACH)
        out[at + 2] = _both_ways((dvx * cos + dvy * sin) / _TOP_SPEED)
        out[at + 3] = _both_ways((dvx * sin - dvy * cos) / _TOP_SPEED)


@compiled
def _cast_rays(ego: FloatArray, box: FloatArray, size: FloatArray, out: FloatArray) -> None:
    """Shortens the rays that meet a box; those that start in it hit it on leaving."""
    cos, sin = math.cos(box[2]), math.sin(box[2])
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
    along = 0.5 * size[0] if number in (0, 3) else -0.5 * size[0]
    left = 0.5 * size[1] if number < 2 else -0.5 * size[1]
    dx = box[0] + along * cos - left * sin - ego[0]
    dy = box[1] + along * sin + left * cos - ego[1]
    c, s = math.cos(ego[2]), math.sin(ego[2])
    return dx * c + dy * s, dx * s - dy * c


@lru_cache(maxsize=1)
def compile_encoding() -> None:
    """Compiles the functions of this module, before an agent's first step."""
    out, ego = np.zeros(OBSERVATION_SIZE), np.zeros(9)
    encode_ego(ego, 0.0, np.array([0.0, 0.0, 0.0, 3.5, 1.0]), np.zeros(2), out)
    encode_checkpoint(ego, np.zeros(5), out[9:14])
    encode_others(ego, np.zeros((1, 9)), np.ones((1, 2)), np.zeros(1, dtype=np.int64), out)
