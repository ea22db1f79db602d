"""The proposals: simulated drives at each lateral offset and speed; compiled.

Each is driven by the intelligent driver model behind actors that the forecast predicts ahead, and
by pure pursuit along the centre line shifted sideways, on a kinematic bicycle.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.idm.car_following import (
    COMFORTABLE_BRAKING,
    MAX_ACCELERATION,
    STANDSTILL_GAP,
    TIME_HEADWAY,
    halt,
)
from drivora_service.agents.idm.driving import BRAKING_JERK, DRIVING_JERK
from drivora_service.agents.idm.pure_pursuit import point_at, preview, steer_at
from drivora_service.agents.idm.right_of_way import HARD_BRAKING
from drivora_service.agents.pdm_closed.forecast import STEP
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line

_STEER_RATE = 0.7
_SHIFT_TIME = 2.0
"""Seconds for moving to another offset."""
_LEAST_SHIFT = 5.0
_WALKER_ROOM = 0.5
"""Additional distance to walkers, metres."""
_PASSING_ROOM = 3.0
"""Additional distance behind actors that stand at the side of the lane, metres: from nearer by, the
ego cannot pass them."""
_AT_THE_SIDE = 0.8
_STANDING = 0.3


@compiled
def accelerate(v: float, wanted: float, gap: float, other: float, max_braking: float) -> float:
    """Returns the acceleration of the intelligent driver model (Treiber, Hennecke, Helbing 2000).

    Above the desired speed its braking is comfortable: a slow proposal that begins fast
    would otherwise brake hard.
    """
    free = MAX_ACCELERATION * (1.0 - (v / max(wanted, 0.1)) ** 4)
    free = max(free, -COMFORTABLE_BRAKING)
    closing = v * (v - other) / (2.0 * math.sqrt(MAX_ACCELERATION * COMFORTABLE_BRAKING))
    space = STANDSTILL_GAP + max(0.0, v * TIME_HEADWAY + closing)
    return max(free - MAX_ACCELERATION * (space / max(gap, 0.1)) ** 2, -max_braking)


@compiled
def _offset_at(s: float, begin: float, length: float, start: float, end: float) -> float:
    """Returns the offset of a path that moves from one offset to another."""
    share = min(max((s - begin) / length, 0.0), 1.0)
    return start + share * (end - start)


@compiled
def _next_ahead(
    s: float,
    begin: float,
    length: float,
    start: float,
    end: float,
    half_length: float,
    half_width: float,
    room: float,
    seen: FloatArray,
    kinds: IntArray,
) -> tuple[float, float]:
    """Returns gap and speed of the next actor ahead on a path that moves sideways."""
    gap, other = np.inf, 0.0
    for j in range(seen.shape[0]):
        at, side, extent, across = seen[j, 0], seen[j, 1], seen[j, 2], seen[j, 3]
        if at - s < -half_length or at - s > 120.0 or side == np.inf:
            continue
        one = _offset_at(max(at - extent - half_length, s), begin, length, start, end)
        two = _offset_at(at + extent, begin, length, start, end)
        reach = half_width + across + (room + _WALKER_ROOM if kinds[j] == 1 else room)
        if side > max(one, two) + reach or side < min(one, two) - reach:
            continue
        there = at - extent - s - half_length
        if there < -0.5 * half_length and kinds[j] == 0:
            # Beside the ego: keeping the line suffices.
            continue
        if abs(side) > _AT_THE_SIDE and kinds[j] != 1 and abs(seen[j, 4]) < _STANDING:
            there -= _PASSING_ROOM
        if there < gap:
            gap, other = there, seen[j, 4]
    return gap, other


@compiled
def propose(
    ego: FloatArray,
    v: float,
    acceleration: float,
    steer: float,
    car: FloatArray,
    grip: float,
    way: FloatArray,
    cursor: int,
    s: float,
    lateral: float,
    offsets: FloatArray,
    factors: FloatArray,
    stops: FloatArray,
    room: float,
    seen: FloatArray,
    kinds: IntArray,
    out: FloatArray,
) -> None:
    """Simulates all proposals, offset by offset.

    Args:
        ego: (9,) the ego's state.
        v, acceleration, steer: Its speed, its last commanded acceleration, and front-wheel angle.
        car: (6,) half length, half width and wheelbase in metres, hardest braking in m/s², largest
            front-wheel angle, and the top speed in m/s.
        grip: Grip of the tyres, m/s².
        way: (n, 4) x, y, arc length and desired speed.
        cursor, s, lateral: The ego's place on it.
        offsets: (O,) metres to the left.
        factors: (F,) shares of the desired speed.
        stops: (F,) arc length on the way at which the front bumper must halt; inf without a halt.
        room: Metres to keep to actors beside the path.
        seen: (K, n, 5) the others, as filled by ``see_from_way``.
        kinds: (n,) their kinds.
        out: (O * F, K, 8) filled: x, y, heading, speed, acceleration, desired front-wheel angle,
            arc length and metres to the left.
    """
    half_length, half_width, wheelbase, max_braking = car[0], car[1], car[2], car[3]
    line, arc = way[:, :2], way[:, 2]
    for p in range(out.shape[0]):
        offset = offsets[p // factors.shape[0]]
        factor = factors[p % factors.shape[0]]
        stop = stops[p % factors.shape[0]]
        # Small errors are corrected over a short distance, else bends are not followed.
        length = max(_LEAST_SHIFT, _SHIFT_TIME * v) * min(max(abs(offset - lateral), 0.1), 1.0)
        x, y, yaw = ego[0], ego[1], ego[2]
        speed, pull, wheel = v, acceleration, steer
        at, along, side = cursor, s, lateral
        for k in range(out.shape[1]):
            wanted = way[at, 3] * factor
            gap, other = _next_ahead(
                along, s, length, lateral, offset, half_length, half_width, room, seen[k], kinds
            )
            asked = accelerate(speed, wanted, gap, other, max_braking)
            if stop < np.inf:
                left = stop - along - half_length
                asked = min(asked, halt(speed, max(wanted, 1.0), left, max_braking))
            if asked > -HARD_BRAKING:
                asked = min(max(asked, pull - BRAKING_JERK * STEP), pull + DRIVING_JERK * STEP)
            aim = along - 0.5 * wheelbase + preview(speed, wheelbase)
            tx, ty = point_at(line, arc, at, aim)
            ahead = at
            while ahead < line.shape[0] - 2 and arc[ahead + 1] < aim:
                ahead += 1
            ux, uy = line[ahead + 1, 0] - line[ahead, 0], line[ahead + 1, 1] - line[ahead, 1]
            span = max(math.sqrt(ux * ux + uy * uy), 1e-9)
            aside = _offset_at(aim, s, length, lateral, offset)
            turn = steer_at(tx - aside * uy / span, ty + aside * ux / span, x, y, yaw, wheelbase)
            row = out[p, k]
            row[0], row[1], row[2], row[3] = x, y, yaw, speed
            row[4], row[5], row[6], row[7] = asked, turn, along, side
            pull = asked
            turn = min(max(turn, -car[4]), car[4])
            wheel += min(max(turn - wheel, -_STEER_RATE * STEP), _STEER_RATE * STEP)
            # The traction decreases with the speed.
            gained = pull * max(0.0, 1.0 - speed / car[5]) if pull > 0.0 else pull
            after = min(max(speed + gained * STEP, 0.0), car[5])
            mean = 0.5 * (speed + after)
            slip = math.atan(0.5 * math.tan(wheel))
            yaw_rate = mean * math.cos(slip) * math.tan(wheel) / wheelbase
            if abs(mean * yaw_rate) > grip:
                yaw_rate = math.copysign(grip / mean, yaw_rate)
            heading = yaw + slip + 0.5 * yaw_rate * STEP
            x += mean * math.cos(heading) * STEP
            y += mean * math.sin(heading) * STEP
            yaw += yaw_rate * STEP
            speed = after
            at, along, side = track_line(line, arc, at, 3, 8, x, y)
