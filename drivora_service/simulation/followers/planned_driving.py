"""Followers whose path plans their braking within the grip of the road.

Such a path has the speed at each of its points, between which the follower accelerates or brakes
uniformly: it brakes as hard as planned, and comes to a stop within centimetres of the place.
"""

from __future__ import annotations

import math

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.simulation.followers.follower_path import PathCol
from drivora_service.simulation.followers.follower_state import FollowerCol

_S, _SPEED, _CURSOR = int(FollowerCol.S), int(FollowerCol.SPEED), int(FollowerCol.CURSOR)
_PLANNED, _NEXT_STOP = int(FollowerCol.DECELERATION), int(FollowerCol.NEXT_STOP)
_LAST_STOP, _STOOD = int(FollowerCol.LAST_STOP), int(FollowerCol.STOOD)
_WAITED, _WAITS_FOR = int(FollowerCol.WAITED), int(FollowerCol.WAITS_FOR)
_YAW, _ARC, _WANTED, _WAIT = (
    int(PathCol.YAW), int(PathCol.ARC), int(PathCol.WANTED), int(PathCol.WAIT),
)  # fmt: skip
_AT_PLACE = 0.3
"""Metres before a place within which a follower that stands is there."""
_STANDS = 0.01
"""m/s up to which it stands."""


@compiled
def planned_speed(me: FloatArray, way: FloatArray, dt: float) -> float:
    """Returns the speed that the path plans for the end of a step, m/s.

    Args:
        me: The follower, columns ``FollowerCol``.
        way: (n, 9) its path, n > 1, columns ``PathCol``.
        dt: Seconds.
    """
    if me[_STOOD] >= 0.0:
        return 0.0
    count, stop, left = way.shape[0], int(me[_NEXT_STOP]), int(me[_LAST_STOP])
    # Where it would be at its present speed: not before the place that it has left.
    at = me[_S] + me[_SPEED] * dt
    if left >= 0:
        at = max(at, way[left, _ARC])
    if stop < count and me[_S] >= way[stop, _ARC]:
        return 0.0
    i = max(int(me[_CURSOR]), left)
    while i + 2 < count and i + 1 != stop and way[i + 1, _ARC] <= at:
        i += 1
    i = min(i, count - 2)
    here, there = way[i, _WANTED] ** 2, way[i + 1, _WANTED] ** 2
    room = way[i + 1, _ARC] - way[i, _ARC]
    if i == left:
        # The plan is to stand here, which is done.
        here = there if there > 0.0 else 2.0 * me[_PLANNED] * room
    # The square of the speed is linear in the way, which is the mean of both speeds by the time:
    # a quadratic equation for the speed at the end of the step.
    slope = (there - here) / room
    now = here + slope * (max(me[_S], way[left, _ARC] if left >= 0 else 0.0) - way[i, _ARC])
    quarter = 0.25 * slope * dt
    root = quarter * quarter + now + 0.5 * slope * dt * me[_SPEED]
    speed = quarter + math.sqrt(root) if root > 0.0 else 0.0
    return float(min(max(speed, 0.0), math.sqrt(max(here, there))))


@compiled
def free_grip(me: FloatArray, way: FloatArray, grip: float) -> float:
    """Returns the part of the grip that cornering leaves for braking and driving, m/s²."""
    i = min(int(me[_CURSOR]), way.shape[0] - 2)
    bend = abs(way[i + 1, _YAW] - way[i, _YAW]) / (way[i + 1, _ARC] - way[i, _ARC])
    side = min(me[_SPEED] ** 2 * bend, grip)
    return float(math.sqrt(grip * grip - side * side))


@compiled
def stand_at_stop(me: FloatArray, way: FloatArray, dt: float) -> bool:
    """Lets a follower that has moved stand at its place; returns whether it has reached its end."""
    count, stop = way.shape[0], int(me[_NEXT_STOP])
    if stop >= count:
        room = way[count - 1, _ARC] - me[_S]
        return bool(room <= 0.0 or (room < _AT_PLACE and me[_SPEED] <= _STANDS))
    if me[_SPEED] > _STANDS or way[stop, _ARC] - me[_S] > _AT_PLACE:
        return False
    me[_SPEED] = 0.0
    # It waits for no other actor meanwhile.
    me[_WAITED], me[_WAITS_FOR] = 0.0, -1.0
    me[_STOOD] = me[_STOOD] + dt if me[_STOOD] >= 0.0 else 0.0
    if me[_STOOD] >= way[stop, _WAIT] - 1e-9:
        me[_LAST_STOP], me[_STOOD] = stop, -1.0
        stop += 1
        while stop < count and way[stop, _WAIT] <= 0.0:
            stop += 1
        me[_NEXT_STOP] = stop
    return False
