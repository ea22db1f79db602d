"""The controller's reference over the horizon, and its bounds; compiled.

The reference is the motion of the intelligent driver model along the lane run, behind actors that
the forecast predicts ahead. Frame: the network's plane; arc lengths are those of the lane run.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.agents.idm.car_following import MAX_ACCELERATION, halt
from drivora_service.agents.idm.driving import BRAKING_JERK, DRIVING_JERK
from drivora_service.agents.idm.right_of_way import HARD_BRAKING
from drivora_service.agents.idm.run_following import WayCol
from drivora_service.agents.interface import ObjectKind
from drivora_service.agents.nmpc.problem import BOXES, STAGE_TIME, BoxCol, ReferenceCol, SideCol
from drivora_service.agents.pdm_closed.forecast import FutureCol, SeenCol
from drivora_service.agents.pdm_closed.proposals import SeenActors, accelerate
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.trace import SizeCol

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


class PlaceCol(IntEnum):
    """Columns of the places of the reference on its way, metres."""

    ARC = 0
    SIDE = 1
    """To the left."""
    LEAST = 2
    """The first of the columns ``SideCol``, relative to the reference."""
    LARGEST = 3


class PlanningCar(NamedTuple):
    """The car of an ego, as it is planned for: metres, m/s² and m/s."""

    half_length: float
    half_width: float
    max_braking: float
    max_speed: float


class PlanStart(NamedTuple):
    """Where a plan begins.

    Attributes:
        speed: m/s.
        acceleration: The last commanded one, m/s².
        heading: Of the ego.
        cursor: Segment of the way.
        s: Arc length on it.
        lateral: Metres to its left.
    """

    speed: float
    acceleration: float
    heading: float
    cursor: int
    s: float
    lateral: float


class Bounds(NamedTuple):
    """What ends a plan's way.

    Attributes:
        stop: Arc length at which the front bumper must halt; inf without a halt.
        walker_rear: Arc length before which it must stay for a walker that may step into its way;
            inf without one.
        walker_speed: The walker's speed along the way, m/s.
        sides: (n, 2) columns ``SideCol``, at each point of the way.
    """

    stop: float
    walker_rear: float
    walker_speed: float
    sides: FloatArray


@compiled
def roll_out(
    start: PlanStart,
    car: PlanningCar,
    way: FloatArray,
    bounds: Bounds,
    others: SeenActors,
    reference: FloatArray,
    places: FloatArray,
) -> None:
    """Fills in the reference.

    Args:
        start: The ego's state, and its place on the way.
        car: The ego's.
        way: (n, 4) columns ``WayCol``.
        bounds: What ends the way, and its sides.
        others: The actors that the forecast predicts.
        reference: (S, 8) filled, columns ``ReferenceCol``, with x and y of the network.
        places: (S, 4) filled, columns ``PlaceCol``.
    """
    s, lateral, stop, sides = start.s, start.lateral, bounds.stop, bounds.sides
    walker_rear, walker_speed = bounds.walker_rear, bounds.walker_speed
    speed, pull, at, along = start.speed, start.acceleration, start.cursor, s
    rate = min(_SIDE_SPEED, _SIDE_SHARE * start.speed)
    last_yaw, last_along = start.heading, s
    for k in range(reference.shape[0]):
        t = k * STAGE_TIME
        while at < way.shape[0] - 2 and way[at + 1, WayCol.ARC] < along:
            at += 1
        aside = math.copysign(max(abs(lateral) - rate * t, 0.0), lateral)
        x, y = way[at, WayCol.X], way[at, WayCol.Y]
        next_x, next_y = way[at + 1, WayCol.X], way[at + 1, WayCol.Y]
        ux, uy = next_x - x, next_y - y
        span = max(math.hypot(ux, uy), 1e-9)
        ux, uy = ux / span, uy / span
        past = along - way[at, WayCol.ARC]
        yaw = math.atan2(uy, ux)
        if at + 2 < way.shape[0]:
            # Headings are interpolated within a segment, else each corner of the line would be a
            # jerk.
            ahead = math.atan2(way[at + 2, WayCol.Y] - next_y, way[at + 2, WayCol.X] - next_x)
            yaw += 0.5 * min(past / span, 1.0) * wrap_to_pi(ahead - yaw)
        yaw = last_yaw + wrap_to_pi(yaw - last_yaw)
        row, place = reference[k], places[k]
        low, high = sides[at, SideCol.LEAST], sides[at, SideCol.LARGEST]
        rear, other = _leader(
            along, s, aside, abs(lateral) > _CHANGING, low, high, car, others,
            FORECASTS_A_STAGE * k,
        )  # fmt: skip
        if walker_rear + walker_speed * t < rear:
            rear, other = walker_rear + walker_speed * t, walker_speed
        wanted = way[at, WayCol.WANTED]
        asked = accelerate(speed, wanted, rear - along, other, car.max_braking)
        if stop < np.inf:
            left = stop - along - car.half_length
            asked = min(asked, halt(speed, max(wanted, 1.0), left, car.max_braking))
        asked = min(asked, MAX_ACCELERATION)
        if asked > -HARD_BRAKING:
            calm = max(asked, pull - BRAKING_JERK * STAGE_TIME)
            asked = min(calm, pull + DRIVING_JERK * STAGE_TIME)
        row[ReferenceCol.X] = x + past * ux - aside * uy
        row[ReferenceCol.Y] = y + past * uy + aside * ux
        row[ReferenceCol.YAW], row[ReferenceCol.SPEED] = yaw, speed
        row[ReferenceCol.ACCELERATION] = asked
        turned = (yaw - last_yaw) / max(along - last_along, 0.5)
        row[ReferenceCol.CURVATURE] = turned if k else 0.0
        row[ReferenceCol.TO_HALT] = min(stop - car.half_length - along, _FAR)
        row[ReferenceCol.TO_LEADER] = min(rear - _GAP - along, _FAR)
        place[PlaceCol.ARC], place[PlaceCol.SIDE] = along, aside
        # A car beyond a side, as in a lane change, only has to return to it.
        place[PlaceCol.LEAST] = min(low - aside, 0.0)
        place[PlaceCol.LARGEST] = max(high - aside, 0.0)
        last_yaw, last_along = yaw, along
        pull = asked
        after = min(max(speed + pull * STAGE_TIME, 0.0), car.max_speed)
        along += 0.5 * (speed + after) * STAGE_TIME
        speed = after
    reference[0, ReferenceCol.CURVATURE] = reference[1, ReferenceCol.CURVATURE]


@compiled
def _leader(
    along: float,
    s: float,
    aside: float,
    changing: bool,
    low: float,
    high: float,
    car: PlanningCar,
    others: SeenActors,
    step: int,
) -> tuple[float, float]:
    """Returns the arc length before which the centre must stay at a stage, and its speed.

    Actors that can be passed within the lane are handled by the boxes.
    """
    rear, other = np.inf, 0.0
    first, seen, half_length = others.states[0], others.states[step], car.half_length
    for j in range(seen.shape[0]):
        at, side, speed = seen[j, SeenCol.ARC], seen[j, SeenCol.SIDE], seen[j, SeenCol.SPEED]
        extent, across = seen[j, SeenCol.HALF_LENGTH], seen[j, SeenCol.HALF_WIDTH]
        if side == np.inf or at + extent < along - half_length:
            continue
        front = first[j, SeenCol.ARC] + first[j, SeenCol.HALF_LENGTH]
        if first[j, SeenCol.SIDE] != np.inf and front < s - 0.5 * half_length:
            # Beside or behind the ego: keeping the line suffices.
            continue
        reach = car.half_width + across + others.room
        if others.kinds[j] == ObjectKind.WALKER:
            reach += _WALKER_ROOM
        passable = side + reach <= high or side - reach >= low
        if passable and not (changing and abs(side - aside) < reach):
            continue
        if at - extent - half_length < rear:
            rear, other = at - extent - half_length, max(speed, 0.0)
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
        reference: (S, 8) columns ``ReferenceCol``.
        half_length, half_width: Of the ego, metres.
        future: (K, m, 4) columns ``FutureCol``, as ``forecast`` fills it.
        sizes: (m, 2) columns ``SizeCol``.
        boxes: (S, BOXES, 5) filled, columns ``BoxCol``; unused ones are far away.
    """
    stages, count = reference.shape[0], sizes.shape[0]
    near = np.full(count, np.inf)
    for j in range(count):
        for k in range(stages):
            there = future[FORECASTS_A_STAGE * k, j]
            dx = there[FutureCol.X] - reference[k, ReferenceCol.X]
            dy = there[FutureCol.Y] - reference[k, ReferenceCol.Y]
            gap = math.hypot(dx, dy) - half_length - 0.5 * sizes[j, SizeCol.LENGTH]
            near[j] = min(near[j], gap)
    for number in range(BOXES):
        best = -1
        for j in range(count):
            if near[j] < _WATCHED and (best < 0 or near[j] < near[best]):
                best = j
        for k in range(stages):
            box = boxes[k, number]
            if best < 0:
                box[BoxCol.X] = reference[k, ReferenceCol.X] + 100.0
                box[BoxCol.Y], box[BoxCol.YAW] = reference[k, ReferenceCol.Y], 0.0
                box[BoxCol.HALF_LENGTH], box[BoxCol.HALF_WIDTH] = 5.0, 5.0
                continue
            there = future[FORECASTS_A_STAGE * k, best]
            turned = there[FutureCol.YAW] - reference[k, ReferenceCol.YAW]
            cos, sin = abs(math.cos(turned)), abs(math.sin(turned))
            box[BoxCol.X], box[BoxCol.Y] = there[FutureCol.X], there[FutureCol.Y]
            box[BoxCol.YAW] = there[FutureCol.YAW]
            half, across = 0.5 * sizes[best, SizeCol.LENGTH], 0.5 * sizes[best, SizeCol.WIDTH]
            box[BoxCol.HALF_LENGTH] = half + cos * half_length + sin * half_width + _BOX_ROOM_AHEAD
            box[BoxCol.HALF_WIDTH] = across + sin * half_length + cos * half_width + _BOX_ROOM_ASIDE
        if best >= 0:
            near[best] = np.inf
