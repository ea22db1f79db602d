"""The decisions of the intelligent-driver agent, compiled: one call for each step.

Frame: the network's plane, metres, radians counter-clockwise from east; arc lengths are those of
the lane run that the agent follows.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.agents.idm.car_following import MAX_ACCELERATION, follow, halt
from drivora_service.agents.idm.conflicts import Conflicts
from drivora_service.agents.idm.corridor import SIDE_ROOM, TIGHT_ROOM, Actors, gap_on_line
from drivora_service.agents.idm.pure_pursuit import point_at, preview, steer_at
from drivora_service.agents.idm.right_of_way import HARD_BRAKING, PATIENCE, Signal, find_halt
from drivora_service.agents.idm.run_following import WayCol
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import Col

DRIVING_JERK = 3.0
"""m/s³ by which the acceleration grows at most."""
BRAKING_JERK = 8.0
"""m/s³ by which it decreases at most, except for emergency braking."""
_LOOK_AHEAD = 90.0


class Car(NamedTuple):
    """The ego's body and what limits it.

    Attributes:
        half_length: Metres.
        half_width: Metres.
        wheelbase: Metres.
        max_braking: Its hardest braking, m/s², positive.
        step_length: Seconds.
    """

    half_length: float
    half_width: float
    wheelbase: float
    max_braking: float
    step_length: float


class Lane(NamedTuple):
    """The lane run that is followed.

    Attributes:
        wall: Arc length before which it must have been left; inf if there is no such place.
        points: (n, 4) its centre line, columns ``WayCol``.
        conflicts: Its conflict zones.
    """

    wall: float
    points: FloatArray
    conflicts: Conflicts


class Decision(IntEnum):
    """Cells of a decision and of what it was made from."""

    ACCELERATION = 0
    """m/s²."""
    STEER = 1
    """Front-wheel angle."""
    GAP = 2
    """To the actor ahead, metres; inf without one."""
    OTHER_SPEED = 3
    """Of the actor ahead, m/s."""
    OTHER = 4
    """Its row among the actors; -1 without one."""
    HALT = 5
    """Metres to the halt; inf without one."""
    LATERAL = 6
    """Offset from the line, metres, positive to the left."""
    WANTED = 7
    """Desired speed, m/s."""


@compiled
def decide(
    v: float,
    cursor: int,
    waited: float,
    light_distance: float,
    light: int,
    protected: bool,
    ego: FloatArray,
    actors: Actors,
    car: Car,
    lane: Lane,
    out: FloatArray,
) -> int:
    """Decides on acceleration and steering.

    Args:
        v: The ego's speed.
        cursor: Segment of the lane's line of the last step.
        waited: Seconds that the ego has stood; decreases while it moves.
        light_distance, light, protected: The next signal, as in ``Observation``: numbers, since a
            record of them would be made anew for each step.
        ego: (9,) the ego's state, columns ``Col``.
        actors: The perceived actors.
        car: The ego's body.
        lane: The lane run.
        out: (8,) of the preceding step; filled, cells ``Decision``.

    Returns:
        The present segment.
    """
    x, y, yaw = ego[Col.X], ego[Col.Y], ego[Col.YAW]
    way, wheelbase = lane.points, car.wheelbase
    line, arc, profile = way[:, : WayCol.ARC], way[:, WayCol.ARC], way[:, WayCol.WANTED]
    cursor, s, lateral = track_line(line, arc, cursor, 5, 30, x, y)
    wanted = profile[cursor]
    ahead = gap_on_line(
        line,
        arc,
        cursor,
        s,
        min(_LOOK_AHEAD, 25.0 + 4.0 * v),
        car.half_length,
        car.half_width,
        # An ego that has waited long creeps past a standing actor.
        SIDE_ROOM if waited < PATIENCE else TIGHT_ROOM,
        v,
        actors,
    )
    acceleration = follow(v, wanted, ahead.gap, ahead.speed, car.max_braking)
    signal = Signal(light_distance, light, protected)
    stop = find_halt(
        v, s, wanted, waited, signal, actors, car.half_length, lane.wall, lane.conflicts, ahead
    )
    if stop < np.inf:
        acceleration = min(acceleration, halt(v, wanted, stop, car.max_braking))
    acceleration = min(acceleration, MAX_ACCELERATION)
    if acceleration > -HARD_BRAKING:
        # Smooth changes of the acceleration, except for emergency braking.
        before, dt = out[Decision.ACCELERATION], car.step_length
        calm = max(acceleration, before - BRAKING_JERK * dt)
        acceleration = min(calm, before + DRIVING_JERK * dt)
    out[Decision.ACCELERATION] = acceleration
    tx, ty = point_at(line, arc, cursor, s - 0.5 * wheelbase + preview(v, wheelbase))
    out[Decision.STEER] = steer_at(tx, ty, x, y, yaw, wheelbase)
    out[Decision.GAP] = ahead.gap
    out[Decision.OTHER_SPEED] = ahead.speed
    out[Decision.OTHER] = float(ahead.row)
    out[Decision.HALT] = stop
    out[Decision.LATERAL] = lateral
    out[Decision.WANTED] = wanted
    return cursor
