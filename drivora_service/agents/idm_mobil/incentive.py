"""The incentive of a lane change: the criterion of MOBIL, compiled.

Source: Kesting, Treiber, Helbing, *General lane-changing model MOBIL for car-following models*
(2007). Accelerations are those of the intelligent driver model.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.agents.idm.car_following import follow
from drivora_service.agents.idm.conflicts import LineCol
from drivora_service.agents.idm.corridor import SIDE_ROOM
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col, SizeCol

_REACH = 120.0
_HARDEST_BRAKING = 9.0


class Neighbours(IntEnum):
    """Cells of the next actors ahead and behind on a lane."""

    GAP_AHEAD = 0
    """Metres to the actor ahead; inf without one, and negative beside the ego."""
    SPEED_AHEAD = 1
    """Of that actor along the lane, m/s."""
    GAP_BEHIND = 2
    SPEED_BEHIND = 3


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
        line: (n, 3) the lane, columns ``LineCol``.
        x, y: The ego's centre; it need not be on the lane.
        half_length, half_width: Half size of the ego, metres.
        objects: (m, 9) perceived actors, columns ``Col``.
        sizes: (m, 2), columns ``SizeCol``.
        out: (4,) filled, cells ``Neighbours``.
    """
    out[Neighbours.GAP_AHEAD], out[Neighbours.SPEED_AHEAD] = np.inf, 0.0
    out[Neighbours.GAP_BEHIND], out[Neighbours.SPEED_BEHIND] = np.inf, 0.0
    _, own_s, _, _, _ = _locate(line, x, y, 1e6)
    for j in range(objects.shape[0]):
        ox, oy = objects[j, Col.X], objects[j, Col.Y]
        if math.hypot(ox - x, oy - y) > _REACH:
            continue
        radius = 0.5 * math.hypot(sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH])
        found, s, side, ux, uy = _locate(line, ox, oy, half_width + radius + SIDE_ROOM)
        if not found:
            continue
        cos, sin = math.cos(objects[j, Col.YAW]), math.sin(objects[j, Col.YAW])
        c, d = abs(cos * ux + sin * uy), abs(sin * ux - cos * uy)
        across = 0.5 * (sizes[j, SizeCol.LENGTH] * d + sizes[j, SizeCol.WIDTH] * c)
        if abs(side) > half_width + across + SIDE_ROOM:
            continue
        extent = 0.5 * (sizes[j, SizeCol.LENGTH] * c + sizes[j, SizeCol.WIDTH] * d)
        speed = objects[j, Col.VX] * ux + objects[j, Col.VY] * uy
        gap = abs(s - own_s) - half_length - extent
        if s >= own_s and gap < out[Neighbours.GAP_AHEAD]:
            out[Neighbours.GAP_AHEAD], out[Neighbours.SPEED_AHEAD] = gap, speed
        elif s < own_s and gap < out[Neighbours.GAP_BEHIND]:
            out[Neighbours.GAP_BEHIND], out[Neighbours.SPEED_BEHIND] = gap, speed


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
    return True, line[best_i, LineCol.ARC] + along, -dx * uy + dy * ux, ux, uy


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
        here: (4,) neighbours in its lane, cells ``Neighbours``.
        there: (4,) neighbours in the other lane.
        politeness: Weight of the gains and losses of others.
        safe_braking: Maximum braking of the actor behind in the other lane, m/s².
    """
    here_gap, here_speed = here[Neighbours.GAP_AHEAD], here[Neighbours.SPEED_AHEAD]
    there_gap, there_speed = there[Neighbours.GAP_AHEAD], there[Neighbours.SPEED_AHEAD]
    old_gap, old_speed = here[Neighbours.GAP_BEHIND], here[Neighbours.SPEED_BEHIND]
    new_gap, new_speed = there[Neighbours.GAP_BEHIND], there[Neighbours.SPEED_BEHIND]
    if there_gap <= 0.0 or new_gap <= 0.0:
        return -np.inf
    gain = _accelerate(v, wanted, there_gap, there_speed) - _accelerate(
        v, wanted, here_gap, here_speed
    )
    if new_gap < np.inf:
        # The new follower gets the ego as its leader instead of the actor ahead of the ego there.
        theirs = max(new_speed, wanted)
        now = _accelerate(new_speed, theirs, new_gap + length + there_gap, there_speed)
        then = _accelerate(new_speed, theirs, new_gap, v)
        # The safety criterion of MOBIL, whatever the gain.
        if then < -safe_braking:
            return -np.inf
        gain += politeness * (then - now)
    if old_gap < np.inf:
        # The old follower gets the actor ahead of the ego as its leader instead of the ego.
        theirs = max(old_speed, wanted)
        now = _accelerate(old_speed, theirs, old_gap, v)
        then = _accelerate(old_speed, theirs, old_gap + length + here_gap, here_speed)
        gain += politeness * (then - now)
    return gain


@compiled
def _accelerate(v: float, wanted: float, gap: float, other: float) -> float:
    return follow(max(v, 0.0), wanted, gap, other, _HARDEST_BRAKING)
