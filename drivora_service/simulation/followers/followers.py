"""NPC vehicles and walkers that follow a path at the speeds of its waypoints.

A follower's state is its arc length on its path and its speed; the path determines its pose. A
reactive vehicle also brakes, by the intelligent driver model (Treiber, Hennecke, Helbing 2000), for
actors in the corridor ahead of it. Reactive vehicles that stand in a ring, each waiting for the
next, would stand for ever: after ``PATIENCE`` one of them is removed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.ground import friction_at
from drivora_service.simulation.followers.follower_gaps import gap_ahead, order_actors
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


@dataclass(slots=True, kw_only=True, eq=False)
class Followers:
    """All followers of an episode, in a few wide arrays: each array adds time to a compiled call.

    Attributes:
        places: (F, 3) row of each follower in the world's arrays, begin of its path in ``path``,
            and number of its points.
        path: (n, 9) concatenated paths, columns ``follower_path.PathCol``.
        state: (F, 17), columns ``FollowerCol``.
    """

    places: IntArray
    path: FloatArray
    state: FloatArray


# The columns as plain integers, which compiled functions use as indices.
_S, _SPEED, _CURSOR, _PHASE, _START, _REACTION, _STAYS = (int(c) for c in tuple(FollowerCol)[:7])
_MOST, _LEAST, _LENGTH, _WIDTH, _WAITED, _WAITS_FOR = (int(c) for c in tuple(FollowerCol)[7:13])
_PLANNED, _NEXT_STOP = int(FollowerCol.DECELERATION), int(FollowerCol.NEXT_STOP)
_X, _Y, _YAW, _ARC, _WANTED, _HEIGHT = (int(c) for c in tuple(PathCol)[:6])
_WAITING, _MOVING, _DONE = (float(phase) for phase in FollowerPhase)
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
    places: IntArray,
    path: FloatArray,
    followers: FloatArray,
    states: FloatArray,
    sizes: FloatArray,
    present: BoolArray,
    next_states: FloatArray,
    next_present: BoolArray,
) -> None:
    """Moves every follower from ``time`` to ``time + dt``.

    Reads the world at ``time`` from ``states`` (N, 9), ``sizes`` (N, 2) and ``present`` (N,);
    writes the poses and velocities at ``time + dt`` into ``next_states`` and ``next_present``.
    ``places``, ``path`` and ``followers``, which is changed in place, are those of ``Followers``.
    A follower has the friction at its centre: ``friction``, or less on ``patches`` (P, 8), columns
    ``ground.PatchCol``.
    """
    axis, radius, positions, rows = order_actors(states, sizes, present)
    for f in range(places.shape[0]):
        row, base = places[f, 0], places[f, 1]
        me, way = followers[f], path[base : base + places[f, 2]]
        if me[_PHASE] == _WAITING and time + dt >= me[_START] - 1e-9:
            me[_PHASE] = _MOVING
            me[_S] = 0.0
            me[_CURSOR] = 0.0
            me[_SPEED] = min(me[_SPEED], way[0, _WANTED])
            next_present[row] = True
        elif me[_PHASE] == _MOVING:
            mu = friction
            if patches.shape[0] > 0:
                at = states[row]
                mu = friction_at(at[0], at[1], at[8], friction, patches)
            acceleration = _acceleration(
                row, dt, mu, me, way, states, sizes, axis, radius, positions, rows
            )
            done = _advance(me, way, acceleration, dt)
            next_present[row] = not done or me[_STAYS] > 0.0
        else:
            next_present[row] = me[_PHASE] == _DONE and me[_STAYS] > 0.0
        if next_present[row] and me[_WAITED] > PATIENCE and _waits_in_ring(f, places, followers):
            me[_PHASE], me[_STAYS] = _DONE, 0.0
            next_present[row] = False
        if next_present[row]:
            _write_pose(me, way, next_states[row])


@compiled
def _waits_in_ring(f: int, places: IntArray, followers: FloatArray) -> bool:
    """Returns whether a follower is part of a ring of followers that wait for each other."""
    at = f
    for _ in range(places.shape[0]):
        if followers[at, _PHASE] != _MOVING or followers[at, _WAITED] <= PATIENCE:
            return False
        ahead, at = followers[at, _WAITS_FOR], -1
        for g in range(places.shape[0]):
            if places[g, 0] == ahead:
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
    axis: int,
    radius: float,
    positions: FloatArray,
    rows: IntArray,
) -> float:
    """Returns the follower's acceleration, m/s², and stores the row that it waits for."""
    grip = friction * GRAVITY
    v = me[_SPEED]
    cursor = int(me[_CURSOR])
    target = way[cursor, _WANTED]
    if me[_PLANNED] > 0.0:
        target = planned_speed(me, way, dt)
        grip = free_grip(me, way, grip)
    elif cursor + 1 < way.shape[0] and way[cursor + 1, _WANTED] < target:
        room = max(way[cursor + 1, _ARC] - me[_S], 0.0)
        target = min(
            target, math.sqrt(way[cursor + 1, _WANTED] ** 2 + 2.0 * 0.5 * me[_LEAST] * room)
        )
    most, least = min(me[_MOST], grip), -min(me[_LEAST], grip)
    acceleration = (target - v) / dt
    if me[_REACTION] == _BRAKES:
        reach = look_ahead(v, me[_LEAST])
        gap, other, ahead = gap_ahead(
            row, way, cursor, me[_S], reach, 0.5 * me[_LENGTH], 0.5 * me[_WIDTH],
            states, sizes, axis, radius, positions, rows,
        )  # fmt: skip
        is_waiting = gap < reach and v < STANDING_SPEED
        me[_WAITED] = me[_WAITED] + dt if is_waiting else 0.0
        me[_WAITS_FOR] = ahead
        if gap < reach:
            a, b = most, 0.35 * me[_LEAST]
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
    v = me[_SPEED]
    v_next = max(v + acceleration * dt, 0.0)
    me[_S] += 0.5 * (v + v_next) * dt
    me[_SPEED] = v_next
    end = way[count - 1, _ARC]
    cursor = int(me[_CURSOR])
    while cursor + 2 < count and way[cursor + 1, _ARC] <= me[_S]:
        cursor += 1
    me[_CURSOR] = cursor
    done = count > 1 and (me[_S] >= end or (end - me[_S] < 0.5 and v_next < 0.2))
    if me[_PLANNED] > 0.0:
        done = stand_at_stop(me, way, dt)
    if done:
        me[_S] = min(me[_S], end)
        me[_SPEED] = 0.0
        me[_PHASE] = _DONE
    return bool(done)


@compiled
def _write_pose(me: FloatArray, way: FloatArray, state: FloatArray) -> None:
    i = int(me[_CURSOR])
    if way.shape[0] < 2:
        state[0], state[1], heading = way[i, _X], way[i, _Y], way[i, _YAW]
    else:
        t = min(max((me[_S] - way[i, _ARC]) / (way[i + 1, _ARC] - way[i, _ARC]), 0.0), 1.0)
        state[0] = way[i, _X] + t * (way[i + 1, _X] - way[i, _X])
        state[1] = way[i, _Y] + t * (way[i + 1, _Y] - way[i, _Y])
        heading = way[i, _YAW] + t * (way[i + 1, _YAW] - way[i, _YAW])
    state[2] = wrap_to_pi(heading)
    state[3] = me[_SPEED] * math.cos(heading)
    state[4] = me[_SPEED] * math.sin(heading)
    state[8] = way[i, _HEIGHT]
