"""The proposals: simulated drives at each lateral offset and speed; compiled.

Each is driven by the intelligent driver model behind actors that the forecast predicts ahead, and
by pure pursuit along the centre line shifted sideways, on a kinematic bicycle.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

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
from drivora_service.agents.idm.run_following import WayCol
from drivora_service.agents.interface import ObjectKind
from drivora_service.agents.pdm_closed.forecast import STEP, SeenCol
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import Col

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


class ProposalCol(IntEnum):
    """Columns of the states of a proposal."""

    X = 0
    Y = 1
    YAW = 2
    SPEED = 3
    ACCELERATION = 4
    STEER = 5
    """Desired angle of the front wheels."""
    ARC = 6
    """Arc length on the way."""
    SIDE = 7
    """Metres to the left of the way."""


class ProposingCar(NamedTuple):
    """The car of an ego, as it is simulated.

    Attributes:
        half_length: Metres.
        half_width: Metres.
        wheelbase: Metres.
        max_braking: Hardest braking, m/s².
        max_steer: Largest angle of the front wheels.
        max_speed: m/s.
        grip: Of the tyres, m/s².
    """

    half_length: float
    half_width: float
    wheelbase: float
    max_braking: float
    max_steer: float
    max_speed: float
    grip: float


class Start(NamedTuple):
    """Where proposals begin.

    Attributes:
        ego: (9,) the ego's state, columns ``Col``.
        speed: m/s.
        acceleration: The last commanded one, m/s².
        steer: Angle of the front wheels.
        cursor: Segment of the way.
        s: Arc length on it.
        lateral: Metres to its left.
    """

    ego: FloatArray
    speed: float
    acceleration: float
    steer: float
    cursor: int
    s: float
    lateral: float


class Choices(NamedTuple):
    """What proposals differ in.

    Attributes:
        offsets: (O,) metres to the left.
        factors: (F,) shares of the desired speed.
        stops: (F,) arc length on the way at which the front bumper must halt; inf without a halt.
    """

    offsets: FloatArray
    factors: FloatArray
    stops: FloatArray


class SeenActors(NamedTuple):
    """The other actors at each step.

    Attributes:
        states: (K, n, 5) columns ``SeenCol``, as filled by ``see_from_way``.
        kinds: (n,) their kinds.
        room: Metres to keep to those beside the path.
    """

    states: FloatArray
    kinds: IntArray
    room: float


class SidewaysPath(NamedTuple):
    """A path that moves from one offset to another.

    Attributes:
        begin: Arc length at which it does.
        length: Metres that it takes.
        start: Offset before, metres to the left.
        end: Offset after.
    """

    begin: float
    length: float
    start: float
    end: float


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
def _offset_at(path: SidewaysPath, s: float) -> float:
    """Returns the offset of a path at an arc length."""
    share = min(max((s - path.begin) / path.length, 0.0), 1.0)
    return path.start + share * (path.end - path.start)


@compiled
def _next_ahead(
    s: float, path: SidewaysPath, car: ProposingCar, others: SeenActors, step: int
) -> tuple[float, float]:
    """Returns gap and speed of the next actor ahead on a path, at a step."""
    gap, other = np.inf, 0.0
    half_length, half_width, room = car.half_length, car.half_width, others.room
    seen = others.states[step]
    for j in range(seen.shape[0]):
        at, side, speed = seen[j, SeenCol.ARC], seen[j, SeenCol.SIDE], seen[j, SeenCol.SPEED]
        extent, across = seen[j, SeenCol.HALF_LENGTH], seen[j, SeenCol.HALF_WIDTH]
        kind = others.kinds[j]
        if at - s < -half_length or at - s > 120.0 or side == np.inf:
            continue
        one = _offset_at(path, max(at - extent - half_length, s))
        two = _offset_at(path, at + extent)
        reach = half_width + across + (room + _WALKER_ROOM if kind == ObjectKind.WALKER else room)
        if side > max(one, two) + reach or side < min(one, two) - reach:
            continue
        there = at - extent - s - half_length
        if there < -0.5 * half_length and kind == ObjectKind.VEHICLE:
            # Beside the ego: keeping the line suffices.
            continue
        if abs(side) > _AT_THE_SIDE and kind != ObjectKind.WALKER and abs(speed) < _STANDING:
            there -= _PASSING_ROOM
        if there < gap:
            gap, other = there, speed
    return gap, other


@compiled
def propose(
    start: Start,
    car: ProposingCar,
    way: FloatArray,
    choices: Choices,
    others: SeenActors,
    out: FloatArray,
) -> None:
    """Simulates all proposals, offset by offset.

    Args:
        start: The ego's state and place.
        car: The ego's.
        way: (n, 4) columns ``WayCol``.
        choices: Offsets and speeds; their O * F pairs are the proposals.
        others: The actors that the forecast predicts.
        out: (O * F, K, 8) filled, columns ``ProposalCol``.
    """
    wheelbase, max_braking = car.wheelbase, car.max_braking
    offsets, factors, stops = choices.offsets, choices.factors, choices.stops
    v, s, lateral = start.speed, start.s, start.lateral
    line, arc = way[:, : WayCol.ARC], way[:, WayCol.ARC]
    for p in range(out.shape[0]):
        offset = offsets[p // factors.shape[0]]
        factor = factors[p % factors.shape[0]]
        stop = stops[p % factors.shape[0]]
        # Small errors are corrected over a short distance, else bends are not followed.
        length = max(_LEAST_SHIFT, _SHIFT_TIME * v) * min(max(abs(offset - lateral), 0.1), 1.0)
        path = SidewaysPath(s, length, lateral, offset)
        x, y, yaw = start.ego[Col.X], start.ego[Col.Y], start.ego[Col.YAW]
        speed, pull, wheel = v, start.acceleration, start.steer
        at, along, side = start.cursor, s, lateral
        for k in range(out.shape[1]):
            wanted = way[at, WayCol.WANTED] * factor
            gap, other = _next_ahead(along, path, car, others, k)
            asked = accelerate(speed, wanted, gap, other, max_braking)
            if stop < np.inf:
                left = stop - along - car.half_length
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
            aside = _offset_at(path, aim)
            turn = steer_at(tx - aside * uy / span, ty + aside * ux / span, x, y, yaw, wheelbase)
            row = out[p, k]
            row[ProposalCol.X], row[ProposalCol.Y], row[ProposalCol.YAW] = x, y, yaw
            row[ProposalCol.SPEED], row[ProposalCol.ACCELERATION] = speed, asked
            row[ProposalCol.STEER], row[ProposalCol.ARC] = turn, along
            row[ProposalCol.SIDE] = side
            pull = asked
            turn = min(max(turn, -car.max_steer), car.max_steer)
            wheel += min(max(turn - wheel, -_STEER_RATE * STEP), _STEER_RATE * STEP)
            # The traction decreases with the speed.
            gained = pull * max(0.0, 1.0 - speed / car.max_speed) if pull > 0.0 else pull
            after = min(max(speed + gained * STEP, 0.0), car.max_speed)
            mean = 0.5 * (speed + after)
            slip = math.atan(0.5 * math.tan(wheel))
            yaw_rate = mean * math.cos(slip) * math.tan(wheel) / wheelbase
            if abs(mean * yaw_rate) > car.grip:
                yaw_rate = math.copysign(car.grip / mean, yaw_rate)
            heading = yaw + slip + 0.5 * yaw_rate * STEP
            x += mean * math.cos(heading) * STEP
            y += mean * math.sin(heading) * STEP
            yaw += yaw_rate * STEP
            speed = after
            at, along, side = track_line(line, arc, at, 3, 8, x, y)
