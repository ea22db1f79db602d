"""The controller's reference over the horizon, and its bounds; compiled.

The reference is the motion of the intelligent driver model along the lane run, behind actors that
the forecast predicts ahead. Frame: the network's plane; arc lengths are those of the lane run.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.idm.car_following import MAX_ACCELERATION, halt
from drivora_service.agents.idm.driving import BRAKING_JERK, DRIVING_JERK
from drivora_service.agents.idm.right_of_way import HARD_BRAKING
from drivora_service.agents.nmpc.problem import BOXES, STAGE_TIME
from drivora_service.agents.pdm_closed.proposals import accelerate
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi

FORECASTS_A_STAGE = 2
_FAR = 1e3
_WALKER_ROOM = 0.5
_CHANGING = 1.2
"""Metres beside the line from which on the offset counts as a lane change."""
_SIDE_SPEED = 1.2
"""m/s at which the reference returns to the line."""
_SIDE_SHARE = 0.25
"""Maximum share of the speed for this."""
_GAP = 1.5
"""Minimum gap of the plan to a leader, metres."""
_BOX_ROOM_AHEAD, _BOX_ROOM_ASIDE = 0.6, 0.25
_WATCHED = 12.0


@compiled
def roll_out(
    v: float,
    acceleration: float,
    cursor: int,
    s: float,
    lateral: float,
    stop: float,
    walker_rear: float,
    walker_speed: float,
    car: FloatArray,
    side_room: float,
    way: FloatArray,
    sides: FloatArray,
    seen: FloatArray,
    kinds: IntArray,
    heading: float,
    reference: FloatArray,
    places: FloatArray,
) -> None:
    """Fills in the reference.

    Args:
        v, acceleration, heading: State of the ego; the acceleration is its last command.
        cursor, s, lateral: Its place on the way.
        stop: Arc length at which its front bumper must halt; inf without a halt.
        walker_rear, walker_speed: Arc length before which it must stay for a walker that may step
            into its way, and the walker's speed along it; inf without one.
        car: (4,) half length, half width, hardest braking, and top speed.
        side_room: Metres to keep to actors beside it.
        way: (n, 4) x, y, arc length and desired speed.
        sides: (n, 2) least and largest offset at each of its points.
        seen: (K, m, 5) the others, as ``forecast.see_from_way`` fills it.
        kinds: (m,) their kinds.
        reference: (S, 8) filled, as in ``problem.REFERENCE``, with x and y of the network.
        places: (S, 4) filled: arc length, offset, least and largest offset.
    """
    half_length, max_braking, top = car[0], car[2], car[3]
    speed, pull, at, along = v, acceleration, cursor, s
    rate = min(_SIDE_SPEED, _SIDE_SHARE * v)
    last_yaw, last_along = heading, s
    for k in range(reference.shape[0]):
        t = k * STAGE_TIME
        while at < way.shape[0] - 2 and way[at + 1, 2] < along:
            at += 1
        aside = math.copysign(max(abs(lateral) - rate * t, 0.0), lateral)
        ux, uy = way[at + 1, 0] - way[at, 0], way[at + 1, 1] - way[at, 1]
        span = max(math.hypot(ux, uy), 1e-9)
        ux, uy = ux / span, uy / span
        past = along - way[at, 2]
        yaw = math.atan2(uy, ux)
        if at + 2 < way.shape[0]:
            # Headings are interpolated within a segment, else each corner of the line would be a
            # jerk.
            ahead = math.atan2(way[at + 2, 1] - way[at + 1, 1], way[at + 2, 0] - way[at + 1, 0])
            yaw += 0.5 * min(past / span, 1.0) * wrap_to_pi(ahead - yaw)
        yaw = last_yaw + wrap_to_pi(yaw - last_yaw)
        row, place = reference[k], places[k]
        low, high = sides[at, 0], sides[at, 1]
        rear, other = _leader(
            along, s, aside, abs(lateral) > _CHANGING, low, high, car, side_room,
            seen[0], seen[FORECASTS_A_STAGE * k], kinds,
        )  # fmt: skip
        if walker_rear + walker_speed * t < rear:
            rear, other = walker_rear + walker_speed * t, walker_speed
        wanted = way[at, 3]
        asked = accelerate(speed, wanted, rear - along, other, max_braking)
        if stop < np.inf:
            asked = min(
                asked, halt(speed, max(wanted, 1.0), stop - along - half_length, max_braking)
            )
        asked = min(asked, MAX_ACCELERATION)
        if asked > -HARD_BRAKING:
            calm = max(asked, pull - BRAKING_JERK * STAGE_TIME)
            asked = min(calm, pull + DRIVING_JERK * STAGE_TIME)
        row[0], row[1] = way[at, 0] + past * ux - aside * uy, way[at, 1] + past * uy + aside * ux
        row[2], row[3], row[4] = yaw, speed, asked
        row[5] = (yaw - last_yaw) / max(along - last_along, 0.5) if k else 0.0
        row[6] = min(stop - half_length - along, _FAR)
        row[7] = min(rear - _GAP - along, _FAR)
        place[0], place[1] = along, aside
        # A car beyond a side, as in a lane change, only has to return to it.
        place[2], place[3] = min(low - aside, 0.0), max(high - aside, 0.0)
        last_yaw, last_along = yaw, along
        pull = asked
        after = min(max(speed + pull * STAGE_TIME, 0.0), top)
        along += 0.5 * (speed + after) * STAGE_TIME
        speed = after
    reference[0, 5] = reference[1, 5]


@compiled
def _leader(
    along: float,
    s: float,
    aside: float,
    changing: bool,
    low: float,
    high: float,
    car: FloatArray,
    side_room: float,
    first: FloatArray,
    seen: FloatArray,
    kinds: IntArray,
) -> tuple[float, float]:
    """Returns the arc length before which the centre must stay at a stage, and its speed.

    Actors that can be passed within the lane are handled by the boxes.
    """
    rear, other = np.inf, 0.0
    for j in range(seen.shape[0]):
        at, side, extent, across = seen[j, 0], seen[j, 1], seen[j, 2], seen[j, 3]
        if side == np.inf or at + extent < along - car[0]:
            continue
        if first[j, 1] != np.inf and first[j, 0] + first[j, 2] < s - 0.5 * car[0]:
            # Beside or behind the ego: keeping the line suffices.
            continue
        reach = car[1] + across + side_room
        if kinds[j] == 1:
            reach += _WALKER_ROOM
        passable = side + reach <= high or side - reach >= low
        if passable and not (changing and abs(side - aside) < reach):
            continue
        if at - extent - car[0] < rear:
            rear, other = at - extent - car[0], max(seen[j, 4], 0.0)
    return rear, other


@compiled
def lay_boxes(
    reference: FloatArray,
    half_length: float,
    half_width: float,
    future: FloatArray,
    sizes: FloatArray,
    boxes: FloatArray,
) -> None:
    """Fills in the boxes to avoid: those nearest to the reference.

    Args:
        reference: (S, 8).
        half_length, half_width: Of the ego, metres.
        future: (K, m, 4) x, y, heading, speed, as ``forecast`` fills it.
        sizes: (m, 2) metres.
        boxes: (S, BOXES, 5) filled; unused ones are far away.
    """
    stages, count = reference.shape[0], sizes.shape[0]
    near = np.full(count, np.inf)
    for j in range(count):
        for k in range(stages):
            there = future[FORECASTS_A_STAGE * k, j]
            gap = math.hypot(there[0] - reference[k, 0], there[1] - reference[k, 1])
            near[j] = min(near[j], gap - half_length - 0.5 * sizes[j, 0])
    for number in range(BOXES):
        best = -1
        for j in range(count):
            if near[j] < _WATCHED and (best < 0 or near[j] < near[best]):
                best = j
        for k in range(stages):
            box = boxes[k, number]
            if best < 0:
                box[0], box[1], box[2] = reference[k, 0] + 100.0, reference[k, 1], 0.0
                box[3], box[4] = 5.0, 5.0
                continue
            there = future[FORECASTS_A_STAGE * k, best]
            turned = there[2] - reference[k, 2]
            cos, sin = abs(math.cos(turned)), abs(math.sin(turned))
            box[0], box[1], box[2] = there[0], there[1], there[2]
            box[3] = 0.5 * sizes[best, 0] + cos * half_length + sin * half_width + _BOX_ROOM_AHEAD
            box[4] = 0.5 * sizes[best, 1] + sin * half_length + cos * half_width + _BOX_ROOM_ASIDE
        if best >= 0:
            near[best] = np.inf
