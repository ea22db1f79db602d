"""The incentive of a lane change: the criterion of MOBIL, compiled.

Source: Kesting, Treiber, Helbing, *General lane-changing model MOBIL for car-following models*
(2007). Accelerations are those of the intelligent driver model.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.idm.car_following import follow
from drivora_service.agents.idm.corridor import SIDE_ROOM
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray

_REACH = 120.0
_HARDEST_BRAKING = 9.0


@compiled
def find_neighbours(
    line: FloatArray,
    x: float,
    y: float,
    half_length: float,
    half_width: float,
    objects: FloatArray,
    sizes: FloatArray,
    out: FloatArray,
) -> None:
    """Finds the next actors ahead and behind on a lane.

    Args:
        line: (n, 3) x, y and arc length along the lane, metres.
        x, y: The ego's centre; it need not be on the lane.
        half_length, half_width: Half size of the ego, metres.
        objects: (m, 9) perceived actors.
        sizes: (m, 2) metres.
        out: (4,) filled: gap ahead in metres, speed of that actor along the lane, gap behind, and
            speed of that actor; a gap is inf without an actor, and negative beside the ego.
    """
    out[0], out[1], out[2], out[3] = np.inf, 0.0, np.inf, 0.0
    _, own_s, _, _, _ = _locate(line, x, y, 1e6)
    for j in range(objects.shape[0]):
        ox, oy = objects[j, 0], objects[j, 1]
        if math.hypot(ox - x, oy - y) > _REACH:
            continue
        radius = 0.5 * math.hypot(sizes[j, 0], sizes[j, 1])
        found, s, side, ux, uy = _locate(line, ox, oy, half_width + radius + SIDE_ROOM)
        if not found:
            continue
        cos, sin = math.cos(objects[j, 2]), math.sin(objects[j, 2])
        c, d = abs(cos * ux + sin * uy), abs(sin * ux - cos * uy)
        across = 0.5 * (sizes[j, 0] * d + sizes[j, 1] * c)
        if abs(side) > half_width + across + SIDE_ROOM:
            continue
        extent = 0.5 * (sizes[j, 0] * c + sizes[j, 1] * d)
        speed = objects[j, 3] * ux + objects[j, 4] * uy
        gap = abs(s - own_s) - half_length - extent
        if s >= own_s and gap < out[0]:
            out[0], out[1] = gap, speed
        elif s < own_s and gap < out[2]:
            out[2], out[3] = gap, speed


@compiled
def _locate(
    line: FloatArray, x: float, y: float, within: float
) -> tuple[bool, float, float, float, float]:
    """Returns whether a point is near a line, its arc length and side, and the direction there."""
    best, best_i = within * within + 1.0, -1
    for i in range(line.shape[0] - 1):
        dx, dy = x - line[i, 0], y - line[i, 1]
        d2 = dx * dx + dy * dy
        if d2 < best:
            best, best_i = d2, i
    if best_i < 0:
        return False, 0.0, 0.0, 1.0, 0.0
    ux, uy = line[best_i + 1, 0] - line[best_i, 0], line[best_i + 1, 1] - line[best_i, 1]
    span = max(math.sqrt(ux * ux + uy * uy), 1e-9)
    ux, uy = ux / span, uy / span
    dx, dy = x - line[best_i, 0], y - line[best_i, 1]
    along = dx * ux + dy * uy
    return True, line[best_i, 2] + along, -dx * uy + dy * ux, ux, uy


@compiled
def incentive(
    v: float,
    wanted: float,
    length: float,
    here: FloatArray,
    there: FloatArray,
    politeness: float,
    safe_braking: float,
) -> float:
    """Returns the gain of a lane change, m/s²; minus infinity if it is not safe.

    Args:
        v: The ego's speed, m/s.
        wanted: Its desired speed on a free road, m/s.
        length: Length of the ego, metres.
        here: (4,) neighbours in its lane, as filled by ``find_neighbours``.
        there: (4,) neighbours in the other lane.
        politeness: Weight of the gains and losses of others.
        safe_braking: Maximum braking of the actor behind in the other lane, m/s².
    """
    if there[0] <= 0.0 or there[2] <= 0.0:
        return -np.inf
    gain = _accelerate(v, wanted, there[0], there[1]) - _accelerate(v, wanted, here[0], here[1])
    if there[2] < np.inf:
        theirs = max(there[3], wanted)
        now = _accelerate(there[3], theirs, there[2] + length + there[0], there[1])
        then = _accelerate(there[3], theirs, there[2], v)
        if then < -safe_braking:
            return -np.inf
        gain += politeness * (then - now)
    if here[2] < np.inf:
        theirs = max(here[3], wanted)
        now = _accelerate(here[3], theirs, here[2], v)
        then = _accelerate(here[3], theirs, here[2] + length + here[0], here[1])
        gain += politeness * (then - now)
    return gain


@compiled
def _accelerate(v: float, wanted: float, gap: float, other: float) -> float:
    return follow(max(v, 0.0), wanted, gap, other, _HARDEST_BRAKING)
