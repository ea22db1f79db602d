"""The decisions of the intelligent-driver agent, compiled: one call for each step.

Frame: the network's plane, metres, radians counter-clockwise from east; arc lengths are those of
the lane run that the agent follows.
"""

from __future__ import annotations

import numpy as np

from drivora_service.agents.idm.car_following import MAX_ACCELERATION, follow, halt
from drivora_service.agents.idm.corridor import SIDE_ROOM, TIGHT_ROOM, gap_on_line
from drivora_service.agents.idm.pure_pursuit import point_at, preview, steer_at
from drivora_service.agents.idm.right_of_way import HARD_BRAKING, PATIENCE, find_halt
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line

DRIVING_JERK = 3.0
BRAKING_JERK = 8.0
_LOOK_AHEAD = 90.0


@compiled
def decide(
    v: float,
    cursor: int,
    waited: float,
    light_distance: float,
    light: int,
    protected: bool,
    ego: FloatArray,
    objects: FloatArray,
    sizes: FloatArray,
    kinds: IntArray,
    car: FloatArray,
    wall: float,
    way: FloatArray,
    zones: FloatArray,
    first: IntArray,
    foes: FloatArray,
    out: FloatArray,
) -> int:
    """Decides on acceleration and steering.

    Args:
        v: The ego's speed.
        cursor: Segment of ``way`` of the last step.
        waited: Seconds that the ego has stood; decreases while it moves.
        light_distance, light, protected: The next signal, as in ``Observation``.
        ego: (9,) the ego's state.
        objects, sizes, kinds: Perceived actors.
        car: (5,) half length, half width and wheelbase of the ego in metres, its hardest braking in
            m/s², positive, and the step length in seconds.
        wall: Arc length before which the lane must have been left; inf if there is none.
        way: (n, 4) x, y and arc length of the centre line of the lane run, and the speed to drive
            at each point, m/s.
        zones, first, foes: ``Conflicts`` of the run.
        out: (8,) of the preceding step; filled: acceleration, steer, gap to the actor ahead, its
            speed, its index, metres to the halt, lateral offset, desired speed.

    Returns:
        The present segment.
    """
    x, y, yaw = ego[0], ego[1], ego[2]
    half_length, half_width, wheelbase = car[0], car[1], car[2]
    max_braking, dt = car[3], car[4]
    line, arc, profile = way[:, :2], way[:, 2], way[:, 3]
    count = objects.shape[0]
    cursor, s, lateral = track_line(line, arc, cursor, 5, 30, x, y)
    wanted = profile[cursor]
    gap, other, index = gap_on_line(
        line,
        arc,
        cursor,
        s,
        min(_LOOK_AHEAD, 25.0 + 4.0 * v),
        half_length,
        half_width,
        SIDE_ROOM if waited < PATIENCE else TIGHT_ROOM,
        v,
        objects,
        sizes,
        kinds,
        count,
    )
    acceleration = follow(v, wanted, gap, other, max_braking)
    stop = find_halt(
        v,
        s,
        wanted,
        waited,
        light_distance,
        light,
        protected,
        objects,
        sizes,
        kinds,
        half_length,
        wall,
        zones,
        first,
        foes,
        gap,
        other,
        index,
    )
    if stop < np.inf:
        acceleration = min(acceleration, halt(v, wanted, stop, max_braking))
    acceleration = min(acceleration, MAX_ACCELERATION)
    if acceleration > -HARD_BRAKING:
        # Smooth changes of the acceleration, except for emergency braking.
        calm = max(acceleration, out[0] - BRAKING_JERK * dt)
        acceleration = min(calm, out[0] + DRIVING_JERK * dt)
    out[0] = acceleration
    tx, ty = point_at(line, arc, cursor, s - 0.5 * wheelbase + preview(v, wheelbase))
    out[1] = steer_at(tx, ty, x, y, yaw, wheelbase)
    out[2] = gap
    out[3] = other
    out[4] = float(index)
    out[5] = stop
    out[6] = lateral
    out[7] = wanted
    return cursor
