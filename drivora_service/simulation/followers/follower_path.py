"""The path of an NPC vehicle or walker: its line and the desired speeds.

The desired speed between two waypoints is that of the one ahead, reached with the follower's
comfortable limits; cornering and braking stay within the friction of the road.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from drivora_service.agents.speed_profile import slow_down_in_time, slow_down_within
from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.sampled_lines import distinct_points, sample_line
from drivora_service.scenario.waypoint_speeds import SIDE_GRIP_SHARE, most_lateral
from drivora_service.simulation.motion.vehicle_dynamics import GRAVITY

_PLANNED_SHARE = 0.98
"""Share of the grip with which braking is planned: the rest is for keeping to the plan."""

_ROUNDS = 4
"""Corrections of the braking on a stretch of path; after an even number it is on the safe side."""


class PathCol(IntEnum):
    """Columns of the path in ``followers.Followers``, as in ``FollowerPath``."""

    X = 0
    Y = 1
    YAW = 2
    ARC = 3
    WANTED = 4
    HEIGHT = 5
    COS = 6
    """Of the heading."""
    SIN = 7
    WAIT = 8
    """Seconds for which the follower stands at the point; 0: it drives through."""


_YAW, _COS, _SIN = int(PathCol.YAW), int(PathCol.COS), int(PathCol.SIN)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowerPath:
    """A path to follow.

    Attributes:
        line: (n, 2) metres, n >= 1; a single point is a place to stand at.
        yaw: (n,) unwrapped heading, radians.
        arc: (n,) arc length, metres.
        wanted: (n,) desired speed at each point, m/s.
        height: (n,) height, metres.
        wait: (n,) seconds for which the follower stands at each point; 0: it drives through.
    """

    line: FloatArray
    yaw: FloatArray
    arc: FloatArray
    wanted: FloatArray
    height: FloatArray
    wait: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathPlan:
    """What a path plans within the grip of the road, beside the speeds.

    Attributes:
        waits: (w,) seconds for which the follower stands at each waypoint.
        stops_at_end: Whether it brakes to a standstill at the last one.
        lateral_acceleration: m/s² in bends; ``None``: a share of the grip.
    """

    waits: FloatArray
    stops_at_end: bool
    lateral_acceleration: float | None


def planned_grip(friction: float) -> float:
    """Returns the grip with which paths plan, m/s²."""
    return _PLANNED_SHARE * friction * GRAVITY


def build_path(
    line: FloatArray,
    speeds: FloatArray,
    speed_arcs: FloatArray,
    first_yaw: float | None,
    friction: float,
    deceleration: float,
    is_vehicle: bool,
    plan: PathPlan | None = None,
) -> FollowerPath:
    """Returns the path along a line, with the speed at each of its points.

    Args:
        line: (k, 2) polyline through the waypoints, metres.
        speeds: (w,) speed of each waypoint, m/s.
        speed_arcs: (w,) arc length of each waypoint on ``line``, metres, ascending.
        first_yaw: Heading where the line has a single point, radians.
        friction: Friction coefficient.
        deceleration: Planned braking, m/s², positive.
        is_vehicle: Whether grip limits the speed in bends.
        plan: Of a vehicle, stops, and braking within the grip.

    Returns:
        The path, resampled to at most one metre between points.
    """
    line, arc = distinct_points(line)
    if len(line) < 2:
        yaw = np.array([first_yaw or 0.0])
        zero = np.zeros(1)
        return FollowerPath(line=line[:1], yaw=yaw, arc=zero, wanted=zero, height=zero, wait=zero)
    sampled = sample_line(line, arc)
    fine, bend = sampled.arc, sampled.bend
    # Between two waypoints the speed of the one ahead applies.
    ahead = np.minimum(np.searchsorted(speed_arcs, fine - 1e-6, side="left"), len(speeds) - 1)
    wanted = speeds[np.maximum(ahead, min(1, len(speeds) - 1))].astype(np.float64)
    wait = np.zeros(len(fine))
    if is_vehicle:
        side = most_lateral(None if plan is None else plan.lateral_acceleration, friction)
        wanted = np.minimum(wanted, np.sqrt(side / np.maximum(bend, 1e-4)))
    if plan is None:
        slow_down_in_time(wanted, fine, deceleration)
    else:
        for place, seconds in zip(speed_arcs, plan.waits, strict=True):
            wait[int(np.argmin(np.abs(fine - place)))] += seconds
        wanted[wait > 0.0] = 0.0
        if plan.stops_at_end:
            wanted[-1] = 0.0
        slow_down_within_grip(wanted, fine, bend, deceleration, planned_grip(friction))
    return FollowerPath(
        line=sampled.line,
        yaw=sampled.yaw,
        arc=fine,
        wanted=wanted,
        height=np.zeros(len(fine)),
        wait=wait,
    )


def slower_on(
    path: FollowerPath, frictions: FloatArray, road: float, deceleration: float
) -> FollowerPath:
    """Returns a path on which speeds and braking keep to the friction of slippery places.

    Args:
        path: A vehicle's path, made for the friction of the road.
        frictions: (n,) coefficient at each point.
        road: Coefficient of the road.
        deceleration: Comfortable braking where the road is not slippery, m/s², positive.
    """
    if len(path.arc) < 2:
        return path
    grip = frictions * GRAVITY
    slippery = frictions < road
    bend = np.abs(np.gradient(path.yaw, path.arc))
    in_bend = np.sqrt(SIDE_GRIP_SHARE * grip / np.maximum(bend, 1e-4))
    wanted = np.where(slippery, np.minimum(path.wanted, in_bend), path.wanted)
    # What bends leave of the friction circle.
    left = math.sqrt(1.0 - SIDE_GRIP_SHARE**2) * grip
    slow_down_within(
        wanted, path.arc, np.where(slippery, np.minimum(left, deceleration), deceleration)
    )
    return replace(path, wanted=wanted)


@compiled
def write_directions(path: FloatArray) -> None:
    """Fills the columns ``PathCol.COS`` and ``SIN`` of (n, 9) points as kernels compute them.

    NumPy's cosine and sine may differ from theirs in the last bit.
    """
    for i in range(path.shape[0]):
        path[i, _COS], path[i, _SIN] = math.cos(path[i, _YAW]), math.sin(path[i, _YAW])


@compiled
def slow_down_within_grip(
    wanted: FloatArray, arc: FloatArray, bend: FloatArray, deceleration: float, grip: float
) -> None:
    """Lowers desired speeds in place, so that braking and cornering together stay within the grip.

    Args:
        wanted: (n,) m/s; no greater than the grip allows in the bends.
        arc: (n,) arc length, metres.
        bend: (n,) curvature, 1/m.
        deceleration: Braking on a straight, m/s², no greater than ``grip``.
        grip: The friction circle's radius, m/s².
    """
    for i in range(wanted.shape[0] - 2, -1, -1):
        step, turn = arc[i + 1] - arc[i], max(bend[i], bend[i + 1])
        before = wanted[i + 1]
        reach = before
        for _ in range(_ROUNDS):
            side = min(turn * reach * reach, grip)
            along = min(deceleration, math.sqrt(grip * grip - side * side))
            reach = min(math.sqrt(before * before + 2.0 * along * step), wanted[i])
        wanted[i] = reach
