"""Braking along the ego's recorded path, against the replayed motion of the others."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.observations.ground import vehicle_friction
from drivora_service.observations.trace import Col, SizeCol
from drivora_service.oracles.avoidability.careful_driver import CarefulDriver
from drivora_service.oracles.avoidability.replayed_contact import DrivenCol, Replay

_LEAST_SHARE = 0.2
"""Share of the grip that is left in bends for braking (as in the ego's dynamics)."""

WAIT = 2.0
"""Seconds after the ego's standstill in which collisions with others count; any time later does if
the actor that was hit comes towards the ego on its way (``is_run_into``)."""

_SWEEP_STEP = 0.5
"""Metres between the places at which an oncoming actor is tried: much less than its length."""

_FARTHEST = 300.0
"""Metres for which an oncoming actor is followed."""


class _Braking(NamedTuple):
    """A way of braking.

    Attributes:
        delay: Seconds until deceleration begins; until then the ego drives as recorded.
        full: The full deceleration, m/s².
        grip: Highest friction of the road times gravity, m/s².
        jerk: m/s³ with which the deceleration grows; inf: it is full at once.
    """

    delay: float
    full: float
    grip: float
    jerk: float


def latest_braking(
    replay: Replay, *, delay: float, full: float, grip: float, jerk: float, earliest: int
) -> int:
    """Returns the last row from which braking avoids a collision, -1 if none from ``earliest`` on.

    Args:
        replay: The collision.
        delay: Seconds until deceleration begins; until then the ego drives as recorded.
        full: The full deceleration, m/s².
        grip: Highest friction of the road times gravity, m/s²; slippery places and worse weather
            leave less, and what bends need of it is not available for braking.
        jerk: m/s³ with which the deceleration grows.
        earliest: First row to consider.
    """
    for row in range(replay.contact - 1, max(earliest, 0) - 1, -1):
        if brakes_clear(replay, row, delay=delay, full=full, grip=grip, jerk=jerk):
            return row
    return -1


def brakes_clear(
    replay: Replay, row: int, *, delay: float, full: float, grip: float, jerk: float
) -> bool:
    """Returns whether braking from ``row`` on avoids all actors; see ``latest_braking``."""
    return _brakes_clear(replay, row, _Braking(delay=delay, full=full, grip=grip, jerk=jerk))


def careful_braking(replay: Replay, driver: CarefulDriver, grip: float, brakes: float) -> int:
    """Returns the last row from which the careful driver avoids all actors, -1 if none."""
    return latest_braking(
        replay,
        delay=driver.delay,
        full=driver.full_braking(grip, brakes),
        grip=grip,
        jerk=driver.jerk,
        earliest=0,
    )


def instant_braking(replay: Replay, grip: float, brakes: float, earliest: int) -> int:
    """Returns the last row from which full braking without delay avoids all actors, -1 if none."""
    return latest_braking(
        replay,
        delay=0.0,
        full=min(grip, brakes),
        grip=grip,
        jerk=math.inf,
        earliest=earliest,
    )


@compiled
def meets(
    replay: Replay, row: int, x: float, y: float, yaw: float, spared: bool, followed: BoolArray
) -> bool:
    """Returns whether the ego's box overlaps the box of an actor that counts.

    The actor that was hit (the first) always counts. Of the others, those that approach from behind
    do not: they were recorded behind an ego that drove on, and do not brake for this one. They are
    marked in ``followed``, and ignored from then on. Walkers do not count where the ego stands and
    their motion is no longer recorded: they do not walk into it.

    Args:
        replay: The collision.
        row: Row of the replay.
        x, y, yaw: Pose of the ego there.
        spared: Whether walkers do not count.
        followed: (M,) flags of the others that approached from behind; changed in place.
    """
    length, width = replay.length, replay.width
    radius = 0.5 * math.hypot(length, width)
    for m in range(replay.others.shape[1]):
        if not replay.present[row, m] or followed[m] or (spared and replay.walks[m]):
            continue
        other = replay.others[row, m]
        other_length = replay.sizes[m, SizeCol.LENGTH]
        other_width = replay.sizes[m, SizeCol.WIDTH]
        dx, dy = other[Col.X] - x, other[Col.Y] - y
        if math.hypot(dx, dy) > radius + 0.5 * math.hypot(other_length, other_width):
            continue
        depth = overlap_depth(dx, dy, yaw, length, width, other[Col.YAW], other_length, other_width)
        if depth <= 0.0:
            continue
        if m > 0:
            behind = dx * math.cos(yaw) + dy * math.sin(yaw) < -0.5 * length
            if behind and math.cos(other[Col.YAW] - yaw) > 0.0:
                followed[m] = True
                continue
        return True
    return False


@compiled
def is_run_into(replay: Replay, x: float, y: float, yaw: float, arc: float) -> bool:
    """Returns whether the actor that was hit later runs into an ego that has come to a stand.

    Of an actor that came towards the ego, at whatever time: standing earlier only makes the contact
    later. It goes on straight; head on, it goes on along the ego's path, which may be a bend.

    Args:
        replay: The collision.
        x, y, yaw: Pose of the standing ego.
        arc: Its arc length on the path.
    """
    if replay.oncoming <= 0.0:
        return False
    length, width = replay.sizes[0, SizeCol.LENGTH], replay.sizes[0, SizeCol.WIDTH]
    if replay.head_on:
        # The last but one point of the path is the ego's place at the contact, when the two were
        # in one another by a step's way.
        end, other = replay.path[replay.path.shape[0] - 2], replay.others[replay.contact, 0]
        apart = math.hypot(other[Col.X] - end[DrivenCol.X], other[Col.Y] - end[DrivenCol.Y])
        room = apart - 0.5 * (replay.length + length)
        met = end[DrivenCol.ARC] - arc + room <= replay.oncoming
        on_x, on_y, _ = pose_on(replay.path, arc, place_on(replay.path, arc, 0))
        beside = math.hypot(x - on_x, y - on_y) < 0.5 * (replay.width + width)
        return bool(met and beside)
    state = replay.others[replay.contact, 0]
    cos, sin = math.cos(state[Col.YAW]), math.sin(state[Col.YAW])
    for k in range(int(min(replay.oncoming, _FARTHEST) / _SWEEP_STEP) + 1):
        depth = overlap_depth(
            state[Col.X] + k * _SWEEP_STEP * cos - x, state[Col.Y] + k * _SWEEP_STEP * sin - y,
            yaw, replay.length, replay.width, state[Col.YAW], length, width,
        )  # fmt: skip
        if depth > 0.0:
            return True
    return False


@compiled
def place_on(path: FloatArray, arc: float, near: int) -> int:
    """Returns the index of the path's segment that contains ``arc``, searched from ``near`` on."""
    i = int(min(max(near, 0), path.shape[0] - 2))
    while i > 0 and path[i, DrivenCol.ARC] > arc:
        i -= 1
    while i < path.shape[0] - 2 and path[i + 1, DrivenCol.ARC] <= arc:
        i += 1
    return i


@compiled
def pose_on(path: FloatArray, arc: float, i: int) -> tuple[float, float, float]:
    """Returns x, y and heading at ``arc``, which lies on the path's segment ``i``."""
    begin, end = path[i], path[i + 1]
    span = end[DrivenCol.ARC] - begin[DrivenCol.ARC]
    share = (arc - begin[DrivenCol.ARC]) / span if span > 1e-9 else 1.0
    share = min(max(share, 0.0), 1.0)
    return (
        begin[DrivenCol.X] + share * (end[DrivenCol.X] - begin[DrivenCol.X]),
        begin[DrivenCol.Y] + share * (end[DrivenCol.Y] - begin[DrivenCol.Y]),
        begin[DrivenCol.YAW] + share * (end[DrivenCol.YAW] - begin[DrivenCol.YAW]),
    )


@compiled
def _brakes_clear(replay: Replay, row: int, how: _Braking) -> bool:
    step, contact, path, recorded = replay.step, replay.contact, replay.path, replay.speed
    arc, speed = path[row, DrivenCol.ARC], recorded[row]
    x, y, yaw = path[row, DrivenCol.X], path[row, DrivenCol.Y], path[row, DrivenCol.YAW]
    i = row
    stood = 0.0
    followed = np.zeros(replay.sizes.shape[0], dtype=np.bool_)
    for t in range(row, replay.others.shape[0] - 1):
        # Time since the start at the end of this step. Braking may begin within the step.
        since = (t + 1 - row) * step - how.delay
        if since <= 1e-9 and t < contact:
            arc, speed = path[t + 1, DrivenCol.ARC], recorded[t + 1]
        else:
            wanted = how.full
            if how.jerk != math.inf:
                wanted = min(max(how.jerk * (since - 0.5 * step), 0.0), how.full)
            friction = vehicle_friction(
                x, y, 0.0, yaw, replay.wheelbase, replay.road[t], replay.patches
            )
            grip = how.grip * friction
            side = speed * speed * path[i, DrivenCol.CURVATURE]
            left = math.sqrt(max(grip * grip - side * side, (_LEAST_SHARE * grip) ** 2))
            braking = min(wanted, left)
            if t < contact:
                braking = max(braking, (recorded[t] - recorded[t + 1]) / step)
            slower = max(speed - braking * step, 0.0)
            arc += 0.5 * (speed + slower) * step
            speed = slower
        i = place_on(path, arc, i)
        x, y, yaw = pose_on(path, arc, i)
        standing = speed <= 0.0
        if meets(replay, t + 1, x, y, yaw, standing and t >= contact, followed):
            return False
        if standing:
            stood += step
            if t >= contact and stood >= WAIT:
                return not is_run_into(replay, x, y, yaw, arc)
    return speed > 0.0 or not is_run_into(replay, x, y, yaw, arc)
