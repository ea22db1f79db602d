"""NPC vehicles and walkers that follow a path at the speeds of its waypoints.

A follower's state is its arc length on its path and its speed; its pose is read off the path. The
wanted speed between two waypoints is that of the one ahead, reached with the follower's comfortable
limits; cornering and braking stay within the friction of the road. A reactive vehicle also brakes,
by the intelligent driver model (Treiber, Hennecke, Helbing 2000), for what stands or moves in the
corridor ahead of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from drivora_service.agents.speed_profile import slow_down_in_time
from drivora_service.compilation import compiled
from drivora_service.geometry import arc_lengths
from drivora_service.observations.trace import LEVEL_GAP
from drivora_service.simulation.dynamics import GRAVITY

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_SPACING = 1.0
_SIDE_GRIP_SHARE = 0.6
"""Share of the grip that a follower uses in bends."""


class Phase(IntEnum):
    """Where a follower is in its life."""

    WAITING = 0
    MOVING = 1
    DONE = 2


class Reaction(IntEnum):
    """What a follower does about others."""

    NONE = 0
    BRAKES = 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowerPath:
    """A path to follow.

    Attributes:
        line: (n, 2) metres, n >= 1; one point is a place to stand at.
        yaw: (n,) unwrapped heading, radians.
        arc: (n,) arc length, metres.
        wanted: (n,) speed wanted at each point, m/s.
        height: (n,) metres up.
    """

    line: FloatArray
    yaw: FloatArray
    arc: FloatArray
    wanted: FloatArray
    height: FloatArray


def build_path(
    line: FloatArray,
    speeds: FloatArray,
    speed_arcs: FloatArray,
    first_yaw: float | None,
    friction: float,
    deceleration: float,
    is_vehicle: bool,
) -> FollowerPath:
    """Prepares a path for following.

    Args:
        line: (k, 2) polyline through the waypoints, metres.
        speeds: (w,) speed of each waypoint, m/s.
        speed_arcs: (w,) arc length of each waypoint on ``line``, metres, ascending.
        first_yaw: Heading where the line has a single point, radians.
        friction: Friction coefficient.
        deceleration: Comfortable braking, m/s², positive.
        is_vehicle: Whether grip limits the speed in bends.

    Returns:
        The path, resampled to at most one metre between points.
    """
    arc = arc_lengths(line)
    keep = np.concatenate(([True], np.diff(arc) > 1e-6))
    line, arc = line[keep], arc[keep]
    if len(line) < 2:
        yaw = np.array([first_yaw or 0.0])
        zero = np.zeros(1)
        return FollowerPath(line=line[:1], yaw=yaw, arc=zero, wanted=zero, height=zero)
    fine = np.union1d(arc, np.linspace(0.0, arc[-1], max(2, math.ceil(arc[-1] / _SPACING) + 1)))
    fine = fine[np.concatenate(([True], np.diff(fine) > 1e-6))]
    x, y = np.interp(fine, arc, line[:, 0]), np.interp(fine, arc, line[:, 1])
    yaw = np.unwrap(np.arctan2(np.gradient(y, fine), np.gradient(x, fine)))
    # The speed that counts between two waypoints is that of the one ahead.
    ahead = np.minimum(np.searchsorted(speed_arcs, fine - 1e-6, side="left"), len(speeds) - 1)
    wanted = speeds[np.maximum(ahead, min(1, len(speeds) - 1))].astype(np.float64)
    if is_vehicle:
        bend = np.abs(np.gradient(yaw, fine))
        wanted = np.minimum(
            wanted, np.sqrt(_SIDE_GRIP_SHARE * friction * GRAVITY / np.maximum(bend, 1e-4))
        )
    slow_down_in_time(wanted, fine, deceleration)
    return FollowerPath(
        line=np.column_stack((x, y)),
        yaw=yaw,
        arc=fine,
        wanted=wanted,
        height=np.zeros(len(fine)),
    )


@dataclass(slots=True, kw_only=True, eq=False)
class Followers:
    """All followers of an episode, one row each, their paths laid end to end.

    Attributes:
        rows: (F,) row of each follower in the world's arrays.
        first: (F + 1,) where each path begins in the arrays below.
        line, yaw, arc, wanted, height: Paths end to end, as in ``FollowerPath``.
        s: (F,) arc length, metres.
        speed: (F,) m/s; before the start, the speed to start with.
        cursor: (F,) index of the path point at or before ``s``, relative to the path's beginning.
        phase: (F,) ``Phase``.
        start_time: (F,) seconds.
        reaction: (F,) ``Reaction``.
        stays: (F,) whether it stays at its last point instead of leaving.
        max_acceleration, max_deceleration: (F,) m/s².
        width, length: (F,) metres.
    """

    rows: IntArray
    first: IntArray
    line: FloatArray
    yaw: FloatArray
    arc: FloatArray
    wanted: FloatArray
    height: FloatArray
    s: FloatArray
    speed: FloatArray
    cursor: IntArray
    phase: IntArray
    start_time: FloatArray
    reaction: IntArray
    stays: BoolArray
    max_acceleration: FloatArray
    max_deceleration: FloatArray
    length: FloatArray
    width: FloatArray


@compiled
def _gap_ahead(
    row: int,
    base: int,
    count: int,
    cursor: int,
    s: float,
    reach: float,
    half_length: float,
    half_width: float,
    line: FloatArray,
    yaw: FloatArray,
    arc: FloatArray,
    states: FloatArray,
    sizes: FloatArray,
    present: BoolArray,
) -> tuple[float, float]:
    """Gives the free metres in the corridor ahead, and the speed along it of what ends it."""
    best, best_speed = np.inf, 0.0
    x0, y0 = line[base + cursor, 0], line[base + cursor, 1]
    for j in range(states.shape[0]):
        if j == row or not present[j] or abs(states[j, 8] - states[row, 8]) > LEVEL_GAP:
            continue
        x, y = states[j, 0], states[j, 1]
        size = 0.5 * math.hypot(sizes[j, 0], sizes[j, 1])
        if math.hypot(x - x0, y - y0) > reach + half_length + size + 2.0:
            continue
        cos, sin = math.cos(states[j, 2]), math.sin(states[j, 2])
        for i in range(cursor, count):
            at = arc[base + i] - s
            if at > reach + half_length + size:
                break
            if at < 0.0:
                continue
            dx, dy = x - line[base + i, 0], y - line[base + i, 1]
            pcos, psin = math.cos(yaw[base + i]), math.sin(yaw[base + i])
            along = dx * pcos + dy * psin
            if abs(along) > 0.75:
                continue
            side = abs(-dx * psin + dy * pcos)
            # Half extents of the other box along and across the path.
            c, d = abs(cos * pcos + sin * psin), abs(sin * pcos - cos * psin)
            across = 0.5 * (sizes[j, 0] * d + sizes[j, 1] * c)
            if side > half_width + across + 0.2:
                continue
            extent = 0.5 * (sizes[j, 0] * c + sizes[j, 1] * d)
            gap = at + along - half_length - extent
            if gap < best:
                best = gap
                best_speed = states[j, 3] * pcos + states[j, 4] * psin
            break
    return best, best_speed


@compiled
def advance_followers(
    time: float,
    dt: float,
    friction: float,
    rows: IntArray,
    first: IntArray,
    line: FloatArray,
    yaw: FloatArray,
    arc: FloatArray,
    wanted: FloatArray,
    height: FloatArray,
    s: FloatArray,
    speed: FloatArray,
    cursor: IntArray,
    phase: IntArray,
    start_time: FloatArray,
    reaction: IntArray,
    stays: BoolArray,
    max_acceleration: FloatArray,
    max_deceleration: FloatArray,
    length: FloatArray,
    width: FloatArray,
    states: FloatArray,
    sizes: FloatArray,
    present: BoolArray,
    next_states: FloatArray,
    next_present: BoolArray,
) -> None:
    """Moves every follower from ``time`` to ``time + dt``.

    Reads the world at ``time`` from ``states`` (N, 9), ``sizes`` (N, 2) and ``present`` (N,);
    writes the poses and velocities at ``time + dt`` into ``next_states`` and ``next_present``.
    """
    grip = friction * GRAVITY
    for f in range(rows.shape[0]):
        row, base = rows[f], first[f]
        count = first[f + 1] - base
        if phase[f] == 0 and time + dt >= start_time[f] - 1e-9:
            phase[f] = 1
            s[f] = 0.0
            cursor[f] = 0
            speed[f] = min(speed[f], wanted[base])
            next_present[row] = True
            _write_pose(f, row, base, count, line, yaw, arc, height, s, speed, cursor, next_states)
            continue
        if phase[f] != 1:
            next_present[row] = phase[f] == 2 and stays[f]
            if next_present[row]:
                _write_pose(
                    f, row, base, count, line, yaw, arc, height, s, speed, cursor, next_states
                )
            continue
        v = speed[f]
        target = wanted[base + cursor[f]]
        if cursor[f] + 1 < count:
            target = (
                min(
                    target,
                    math.sqrt(
                        wanted[base + cursor[f] + 1] ** 2
                        + 2.0
                        * 0.5
                        * max_deceleration[f]
                        * max(arc[base + cursor[f] + 1] - s[f], 0.0)
                    ),
                )
                if wanted[base + cursor[f] + 1] < target
                else target
            )
        most, least = min(max_acceleration[f], grip), -min(max_deceleration[f], grip)
        acceleration = (target - v) / dt
        if reaction[f] == 1:
            reach = 8.0 + 1.5 * v + v * v / (2.0 * 0.5 * max_deceleration[f])
            gap, other = _gap_ahead(
                row,
                base,
                count,
                cursor[f],
                s[f],
                reach,
                0.5 * length[f],
                0.5 * width[f],
                line,
                yaw,
                arc,
                states,
                sizes,
                present,
            )
            if gap < reach:
                a, b = most, 0.35 * max_deceleration[f]
                space = 2.0 + max(0.0, v * 1.0 + v * (v - other) / (2.0 * math.sqrt(a * b)))
                free = 1.0 - (v / max(target, 0.1)) ** 4 if target > 0.0 else -1.0
                following = a * (free - (space / max(gap, 0.1)) ** 2)
                if gap < 0.5:
                    following = least
                acceleration = min(acceleration, following)
        acceleration = min(max(acceleration, least), most)
        v_next = max(v + acceleration * dt, 0.0)
        s[f] += 0.5 * (v + v_next) * dt
        speed[f] = v_next
        end = arc[base + count - 1]
        while cursor[f] + 2 < count and arc[base + cursor[f] + 1] <= s[f]:
            cursor[f] += 1
        done = count > 1 and (s[f] >= end or (end - s[f] < 0.5 and v_next < 0.2))
        if done:
            s[f] = min(s[f], end)
            speed[f] = 0.0
            phase[f] = 2
        next_present[row] = not done or stays[f]
        if next_present[row]:
            _write_pose(f, row, base, count, line, yaw, arc, height, s, speed, cursor, next_states)


@compiled
def _write_pose(
    f: int,
    row: int,
    base: int,
    count: int,
    line: FloatArray,
    yaw: FloatArray,
    arc: FloatArray,
    height: FloatArray,
    s: FloatArray,
    speed: FloatArray,
    cursor: IntArray,
    states: FloatArray,
) -> None:
    i = base + cursor[f]
    if count < 2:
        states[row, 0], states[row, 1], heading = line[i, 0], line[i, 1], yaw[i]
    else:
        t = min(max((s[f] - arc[i]) / (arc[i + 1] - arc[i]), 0.0), 1.0)
        states[row, 0] = line[i, 0] + t * (line[i + 1, 0] - line[i, 0])
        states[row, 1] = line[i, 1] + t * (line[i + 1, 1] - line[i, 1])
        heading = yaw[i] + t * (yaw[i + 1] - yaw[i])
    states[row, 2] = (heading + math.pi) % (2.0 * math.pi) - math.pi
    states[row, 3] = speed[f] * math.cos(heading)
    states[row, 4] = speed[f] * math.sin(heading)
    states[row, 8] = height[i]
