"""NPC vehicles and walkers that follow a path at the speeds of its waypoints.

A follower's state is its arc length on its path and its speed; the path determines its pose. A
reactive vehicle also brakes, by the intelligent driver model (Treiber, Hennecke, Helbing 2000), for
actors in the corridor ahead of it. Reactive vehicles that stand in a ring, each waiting for the
next, would stand for ever: after ``PATIENCE`` one of them is removed.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.ground import friction_at
from drivora_service.observations.trace import Col
from drivora_service.simulation.followers.follower_gaps import ActorOrder, gap_ahead, order_actors
from drivora_service.simulation.followers.follower_path import PathCol
from drivora_service.simulation.followers.follower_state import FollowerCol, FollowerPhase, Reaction
from drivora_service.simulation.followers.planned_driving import (
    free_grip,
    planned_speed,
    stand_at_stop,
)
from drivora_service.simulation.motion.vehicle_dynamics import GRAVITY

PATIENCE = 10.0
"""Seconds for which reactive vehicles wait for each other in a ring before one of them is removed:
long enough for queues to dissolve, and a small part of the minute after which an ego behind them
would be judged blocked. SUMO removes vehicles from its own jams likewise."""

STANDING_SPEED = 0.1
"""m/s below which a vehicle stands."""


class PlaceCol(IntEnum):
    """Columns of ``Followers.places``."""

    ROW = 0
    """Row of the follower in the world's arrays."""
    PATH = 1
    """Begin of its path in ``Followers.path``."""
    POINTS = 2
    """Number of the path's points."""


class Followers(NamedTuple):
    """All followers of an episode, in a few wide arrays: each array adds time to a compiled call.

    Attributes:
        places: (F, 3), columns ``PlaceCol``.
        path: (n, 9) concatenated paths, columns ``follower_path.PathCol``.
        state: (F, 17), columns ``FollowerCol``.
    """

    places: IntArray
    path: FloatArray
    state: FloatArray


# As the numbers in the columns: a compiled function compares no enum with a float.
_WAITING, _MOVING = float(FollowerPhase.WAITING), float(FollowerPhase.MOVING)
_DONE = float(FollowerPhase.DONE)
_BRAKES = float(Reaction.BRAKES)


@compiled
def look_ahead(speed: float, deceleration: float) -> float:
    """Returns the metres from its front up to which a reactive vehicle brakes for others.

    Args:
        speed: m/s.
        deceleration: Its hardest braking, m/s², positive.
    """
    return 8.0 + 1.5 * speed + speed * speed / (2.0 * 0.5 * deceleration)


@compiled
def advance_followers(
    time: float,
    dt: float,
    friction: float,
    patches: FloatArray,
    followers: Followers,
    states: FloatArray,
    sizes: FloatArray,
    present: BoolArray,
    next_states: FloatArray,
    next_present: BoolArray,
) -> None:
    """Moves every follower from ``time`` to ``time + dt``.

    Reads the world at ``time`` from ``states`` (N, 9), ``sizes`` (N, 2) and ``present`` (N,);
    writes the poses and velocities at ``time + dt`` into ``next_states`` and ``next_present``.
    The state of ``followers`` is changed in place. A follower has the friction at its centre:
    ``friction``, or less on ``patches`` (P, 8), columns ``ground.PatchCol``.
    """
    places, path, all_states = followers.places, followers.path, followers.state
    order = order_actors(states, sizes, present)
    for f in range(places.shape[0]):
        row, base = places[f, PlaceCol.ROW], places[f, PlaceCol.PATH]
        me, way = all_states[f], path[base : base + places[f, PlaceCol.POINTS]]
        if me[FollowerCol.PHASE] == _WAITING and time + dt >= me[FollowerCol.START_TIME] - 1e-9:
            me[FollowerCol.PHASE] = _MOVING
            me[FollowerCol.S] = 0.0
            me[FollowerCol.CURSOR] = 0.0
            me[FollowerCol.SPEED] = min(me[FollowerCol.SPEED], way[0, PathCol.WANTED])
            next_present[row] = True
        elif me[FollowerCol.PHASE] == _MOVING:
            mu = friction
            if patches.shape[0] > 0:
                at = states[row]
                mu = friction_at(at[Col.X], at[Col.Y], at[Col.Z], friction, patches)
            acceleration = _acceleration(row, dt, mu, me, way, states, sizes, order)
            done = _advance(me, way, acceleration, dt)
            next_present[row] = not done or me[FollowerCol.STAYS] > 0.0
        else:
            next_present[row] = me[FollowerCol.PHASE] == _DONE and me[FollowerCol.STAYS] > 0.0
        if (
            next_present[row]
            and me[FollowerCol.WAITED] > PATIENCE
            and _waits_in_ring(f, places, all_states)
        ):
            me[FollowerCol.PHASE], me[FollowerCol.STAYS] = _DONE, 0.0
            next_present[row] = False
        if next_present[row]:
            _write_pose(me, way, next_states[row])


@compiled
def _waits_in_ring(f: int, places: IntArray, state: FloatArray) -> bool:
    """Returns whether a follower is part of a ring of followers that wait for each other."""
    at = f
    for _ in range(places.shape[0]):
        if state[at, FollowerCol.PHASE] != _MOVING or state[at, FollowerCol.WAITED] <= PATIENCE:
            return False
        ahead, at = state[at, FollowerCol.WAITS_FOR], -1
        for g in range(places.shape[0]):
            if places[g, PlaceCol.ROW] == ahead:
                at = g
        if at < 0:
            return False
        if at == f:
            return True
    return False


@compiled
def _acceleration(
    row: int,
    dt: float,
    friction: float,
    me: FloatArray,
    way: FloatArray,
    states: FloatArray,
    sizes: FloatArray,
    order: ActorOrder,
) -> float:
    """Returns the follower's acceleration, m/s², and stores the row that it waits for."""
    grip = friction * GRAVITY
    v = me[FollowerCol.SPEED]
    cursor = int(me[FollowerCol.CURSOR])
    target = way[cursor, PathCol.WANTED]
    if me[FollowerCol.DECELERATION] > 0.0:
        target = planned_speed(me, way, dt)
        grip = free_grip(me, way, grip)
    elif cursor + 1 < way.shape[0] and way[cursor + 1, PathCol.WANTED] < target:
        room = max(way[cursor + 1, PathCol.ARC] - me[FollowerCol.S], 0.0)
        target = min(
            target,
            math.sqrt(
                way[cursor + 1, PathCol.WANTED] ** 2
                + 2.0 * 0.5 * me[FollowerCol.MAX_DECELERATION] * room
            ),
        )
    most, least = (
        min(me[FollowerCol.MAX_ACCELERATION], grip),
        -min(me[FollowerCol.MAX_DECELERATION], grip),
    )
    acceleration = (target - v) / dt
    if me[FollowerCol.REACTION] == _BRAKES:
        reach = look_ahead(v, me[FollowerCol.MAX_DECELERATION])
        gap, other, ahead = gap_ahead(
            row, way, cursor, me[FollowerCol.S], reach, 0.5 * me[FollowerCol.LENGTH],
            0.5 * me[FollowerCol.WIDTH], states, sizes, order,
        )  # fmt: skip
        is_waiting = gap < reach and v < STANDING_SPEED
        me[FollowerCol.WAITED] = me[FollowerCol.WAITED] + dt if is_waiting else 0.0
        me[FollowerCol.WAITS_FOR] = ahead
        if gap < reach:
            a, b = most, 0.35 * me[FollowerCol.MAX_DECELERATION]
            space = 2.0 + max(0.0, v * 1.0 + v * (v - other) / (2.0 * math.sqrt(a * b)))
            free = 1.0 - (v / max(target, 0.1)) ** 4 if target > 0.0 else -1.0
            following = a * (free - (space / max(gap, 0.1)) ** 2)
            if gap < 0.5:
                following = least
            acceleration = min(acceleration, following)
    return float(min(max(acceleration, least), most))


@compiled
def _advance(me: FloatArray, way: FloatArray, acceleration: float, dt: float) -> bool:
    """Moves a follower along its path; returns whether it has reached the end."""
    count = way.shape[0]
    v = me[FollowerCol.SPEED]
    v_next = max(v + acceleration * dt, 0.0)
    me[FollowerCol.S] += 0.5 * (v + v_next) * dt
    me[FollowerCol.SPEED] = v_next
    end = way[count - 1, PathCol.ARC]
    cursor = int(me[FollowerCol.CURSOR])
    while cursor + 2 < count and way[cursor + 1, PathCol.ARC] <= me[FollowerCol.S]:
        cursor += 1
    me[FollowerCol.CURSOR] = cursor
    done = count > 1 and (
        me[FollowerCol.S] >= end or (end - me[FollowerCol.S] < 0.5 and v_next < 0.2)
    )
    if me[FollowerCol.DECELERATION] > 0.0:
        done = stand_at_stop(me, way, dt)
    if done:
        me[FollowerCol.S] = min(me[FollowerCol.S], end)
        me[FollowerCol.SPEED] = 0.0
        me[FollowerCol.PHASE] = _DONE
    return bool(done)


@compiled
def _write_pose(me: FloatArray, way: FloatArray, state: FloatArray) -> None:
    i = int(me[FollowerCol.CURSOR])
    if way.shape[0] < 2:
        state[Col.X], state[Col.Y], heading = (
            way[i, PathCol.X],
            way[i, PathCol.Y],
            way[i, PathCol.YAW],
        )
    else:
        t = min(
            max(
                (me[FollowerCol.S] - way[i, PathCol.ARC])
                / (way[i + 1, PathCol.ARC] - way[i, PathCol.ARC]),
                0.0,
            ),
            1.0,
        )
        state[Col.X] = way[i, PathCol.X] + t * (way[i + 1, PathCol.X] - way[i, PathCol.X])
        state[Col.Y] = way[i, PathCol.Y] + t * (way[i + 1, PathCol.Y] - way[i, PathCol.Y])
        heading = way[i, PathCol.YAW] + t * (way[i + 1, PathCol.YAW] - way[i, PathCol.YAW])
    state[Col.YAW] = wrap_to_pi(heading)
    state[Col.VX] = me[FollowerCol.SPEED] * math.cos(heading)
    state[Col.VY] = me[FollowerCol.SPEED] * math.sin(heading)
    state[Col.Z] = way[i, PathCol.HEIGHT]
