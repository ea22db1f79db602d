"""The risk perception point of a collision.

UN Regulation No. 157 states it for motorway traffic: an adjacent vehicle that has moved more than
0.375 m sideways is cutting in, and a vehicle ahead that brakes harder than 5 m/s² is a risk. For
everything else (walkers, crossing and oncoming vehicles, obstacles) it states none; there, and for
actors already ahead, it is the moment from which on the other, if it continues its motion, and the
ego, if it continues along its path at its speed, are about to meet. An actor that is hidden by
others, or further away than the sight in the weather, is no risk yet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.sight import is_hidden
from drivora_service.observations.trace import Col, SizeCol, Trace
from drivora_service.oracles.avoidability.braking_evasion import place_on, pose_on
from drivora_service.oracles.avoidability.careful_driver import CarefulDriver
from drivora_service.oracles.avoidability.replayed_contact import SAME_WAY, DrivenCol, Replay

_THINK_STEP = 0.1
"""Interval of the checks whether two actors will have met, seconds."""

_MEASURED = 0.2
"""Seconds over which the turning and braking of others is measured."""

_STANDS = 0.1
"""m/s below which an actor's direction is its heading."""

_TURNS = 1.0
"""m/s below which an actor is predicted to go straight on."""


class Risk(StrEnum):
    """The first perceptible risk."""

    MEETING = "meeting"
    """Both, continuing their motion, were about to meet."""
    CUTTING_IN = "cutting_in"
    """The other moved sideways out of its lane, towards the ego's path."""
    LEADER_BRAKING = "leader_braking"
    """The vehicle in front braked hard."""


RISK_IN_WORDS = {
    Risk.MEETING: "both were about to meet",
    Risk.CUTTING_IN: "the other cut in",
    Risk.LEADER_BRAKING: "the other braked hard",
}
"""The danger, by the risk that was perceptible."""


class _CourseCol(IntEnum):
    """Columns of the course of an actor."""

    SPEED = 0
    """m/s."""
    DIRECTION = 1
    """Of its motion; its heading where it stands."""
    TURN_RATE = 2
    """rad/s."""
    DECELERATION = 3
    """m/s²."""


_COURSE_COLUMNS = len(_CourseCol)


class _Beside(NamedTuple):
    """Positions of an actor relative to the ego's path, (n,) each; NaN where it was absent.

    Attributes:
        along: Arc length of the nearest point of the path, metres.
        across: Metres to the left of it.
        turned: Radians from the direction of the path to its heading.
    """

    along: FloatArray
    across: FloatArray
    turned: FloatArray


class _Horizon(NamedTuple):
    """How far ahead the motion of both is predicted; see ``CarefulDriver``.

    Attributes:
        foresight: Seconds, at least.
        margin: Factor on the braking time, if that is longer.
        ready: Seconds of the braking time before the full deceleration.
        full: The full deceleration, m/s².
    """

    foresight: float
    margin: float
    ready: float
    full: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Perceived:
    """The risk perception point.

    Attributes:
        row: Row of the replay; that of the contact if no risk was perceptible before.
        risk: The perceptible risk; ``None`` if there was none before the contact.
        hidden: Whether the other was hidden, or out of sight, in the row before.
    """

    row: int
    risk: Risk | None
    hidden: bool


def perceive_risk(
    replay: Replay,
    trace: Trace,
    ego_row: int,
    driver: CarefulDriver,
    *,
    grip: float,
    heights: FloatArray,
    sight: float | FloatArray,
) -> Perceived:
    """Returns the moment from which on the actor that was hit was a risk without a pause.

    Pauses no longer than the evaluation time do not count.

    Args:
        replay: The collision.
        trace: The run.
        ego_row: Row of the ego in the trace.
        driver: The driver with the thresholds.
        grip: Friction times gravity, m/s².
        heights: (N,) metres, of all actors of the trace.
        sight: Range of sight, metres; or (contact,) of them, one for each row.
    """
    rows = replay.contact
    poses = np.ascontiguousarray(replay.others[:rows, 0])
    there = np.ascontiguousarray(replay.present[:rows, 0])
    back = max(round(_MEASURED / replay.step), 1)
    course = _course(poses, there, replay.step, back)
    kinds: dict[Risk, BoolArray] = {
        Risk.MEETING: _flag_meeting(replay, driver, grip, poses, course)
    }
    if not replay.walks[0]:
        beside = _beside(replay.path, poses, there)
        # An actor that goes the ego's way is predicted to keep to its lane: it is no risk while it
        # wanders beside the ego, and one that comes over will not continue across the lane.
        same_way = np.abs(beside.turned) < SAME_WAY
        closing = _flag_closing_in(replay, driver, grip, course, beside)
        kinds[Risk.MEETING] = np.where(same_way, closing, kinds[Risk.MEETING])
        kinds[Risk.LEADER_BRAKING] = _flag_leader_braking(replay, driver, course, beside)
        kinds[Risk.CUTTING_IN] = _flag_cutting_in(replay, driver, beside)
    seen = _flag_seen(replay, trace, ego_row, heights, sight)
    risky = seen & np.logical_or.reduce(list(kinds.values()))
    pause = round(driver.evaluation_time / replay.step)
    first = rows
    for row in range(rows - 1, -1, -1):
        if risky[row]:
            first = row
        elif first - row > pause:
            break
    if first == rows:
        return Perceived(row=rows, risk=None, hidden=rows > 0 and not seen[rows - 1])
    named = next(kind for kind, flags in kinds.items() if flags[first])
    return Perceived(row=first, risk=named, hidden=first > 0 and not seen[first - 1])


def _flag_seen(
    replay: Replay, trace: Trace, ego_row: int, heights: FloatArray, sight: float | FloatArray
) -> BoolArray:
    """Returns (contact,) whether the actor that was hit was in sight."""
    other = int(replay.rows[0])
    sizes = np.array([(actor.length, actor.width) for actor in trace.actors])
    part = slice(replay.first, replay.first + replay.contact)
    states = np.ascontiguousarray(trace.states[part])
    present = np.ascontiguousarray(trace.present[part])
    away = np.hypot(
        states[:, other, Col.X] - states[:, ego_row, Col.X],
        states[:, other, Col.Y] - states[:, ego_row, Col.Y],
    )
    with np.errstate(invalid="ignore"):
        near = present[:, other] & (away <= sight)
    return near & ~_flag_hidden(ego_row, other, near, states, present, sizes, heights)


@compiled
def _flag_hidden(
    ego: int,
    other: int,
    asked: BoolArray,
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    heights: FloatArray,
) -> BoolArray:
    hidden = np.zeros(states.shape[0], dtype=np.bool_)
    for t in range(states.shape[0]):
        if asked[t]:
            hidden[t] = is_hidden(ego, other, states[t], present[t], sizes, heights)
    return hidden


@compiled
def _course(poses: FloatArray, present: BoolArray, step: float, back: int) -> FloatArray:
    """Returns the (n, 4) course of an actor, columns ``_CourseCol``.

    Measured over the ``back`` preceding rows; NaN where it was absent.
    """
    course = np.full((poses.shape[0], _COURSE_COLUMNS), np.nan)
    for t in range(poses.shape[0]):
        if not present[t]:
            continue
        begin = t
        while begin > max(t - back, 0) and present[begin - 1]:
            begin -= 1
        course[t] = 0.0
        course[t, _CourseCol.DIRECTION] = poses[t, Col.YAW]
        if begin == t:
            continue
        span = (t - begin) * step
        way_x = poses[t, Col.X] - poses[t - 1, Col.X]
        way_y = poses[t, Col.Y] - poses[t - 1, Col.Y]
        speed = math.hypot(way_x, way_y) / step
        first_x = poses[begin + 1, Col.X] - poses[begin, Col.X]
        first_y = poses[begin + 1, Col.Y] - poses[begin, Col.Y]
        first = math.hypot(first_x, first_y) / step
        course[t, _CourseCol.SPEED] = speed
        if speed > _STANDS:
            course[t, _CourseCol.DIRECTION] = math.atan2(way_y, way_x)
        if speed > _TURNS:
            turn = wrap_to_pi(poses[t, Col.YAW] - poses[begin, Col.YAW])
            course[t, _CourseCol.TURN_RATE] = turn / span
        if t - begin > 1:
            course[t, _CourseCol.DECELERATION] = (first - speed) / (span - step)
    return course


def _flag_meeting(
    replay: Replay, driver: CarefulDriver, grip: float, poses: FloatArray, course: FloatArray
) -> BoolArray:
    """Returns (contact,) whether both, continuing their motion, were about to meet."""
    horizon = _Horizon(
        foresight=driver.foresight,
        margin=driver.margin,
        ready=float(driver.time_for(0.0, grip)),
        full=driver.full_braking(grip, math.inf),
    )
    return _will_meet(replay, horizon, poses, course)


@compiled
def _will_meet(
    replay: Replay, horizon: _Horizon, poses: FloatArray, course: FloatArray
) -> BoolArray:
    path, speeds, size = replay.path, replay.speed, replay.sizes[0]
    meeting = np.zeros(replay.contact, dtype=np.bool_)
    for t in range(replay.contact):
        speed = course[t, _CourseCol.SPEED]
        if math.isnan(speed):
            continue
        way, turn = course[t, _CourseCol.DIRECTION], course[t, _CourseCol.TURN_RATE]
        heading = path[t, DrivenCol.YAW]
        closing = math.hypot(
            speeds[t] * math.cos(heading) - speed * math.cos(way),
            speeds[t] * math.sin(heading) - speed * math.sin(way),
        )
        braking_time = horizon.ready + 0.5 * closing / horizon.full
        ahead = max(horizon.foresight, horizon.margin * braking_time)
        x, y, yaw = poses[t, Col.X], poses[t, Col.Y], poses[t, Col.YAW]
        i = t
        arc = path[t, DrivenCol.ARC]
        for _ in range(int(ahead / _THINK_STEP)):
            arc += speeds[t] * _THINK_STEP
            i = place_on(path, arc, i)
            ego_x, ego_y, ego_yaw = pose_on(path, arc, i)
            middle = way + 0.5 * turn * _THINK_STEP
            x += speed * math.cos(middle) * _THINK_STEP
            y += speed * math.sin(middle) * _THINK_STEP
            way += turn * _THINK_STEP
            yaw += turn * _THINK_STEP
            if (
                overlap_depth(
                    x - ego_x, y - ego_y, ego_yaw, replay.length, replay.width,
                    yaw, size[SizeCol.LENGTH], size[SizeCol.WIDTH],
                ) > 0.0
            ):  # fmt: skip
                meeting[t] = True
                break
    return meeting


def _flag_closing_in(
    replay: Replay, driver: CarefulDriver, grip: float, course: FloatArray, beside: _Beside
) -> BoolArray:
    """Returns (contact,) whether both, on one path in one direction, were about to meet.

    Each keeps its speed and the path; the actor behind closes in on the actor in front.
    """
    along, across, turned = beside
    ahead = along - replay.path[: replay.contact, DrivenCol.ARC]
    room = np.abs(ahead) - 0.5 * (replay.length + replay.sizes[0, SizeCol.LENGTH])
    speed = course[:, _CourseCol.SPEED] * elementary.cos(turned)
    closing = np.sign(ahead) * (replay.speed[:-1] - speed)
    reach = 0.5 * (replay.width + replay.sizes[0, SizeCol.WIDTH])
    thought = np.maximum(
        driver.foresight, driver.margin * driver.time_for(np.maximum(closing, 0.0), grip)
    )
    flags: BoolArray = (np.abs(across) < reach) & (
        (room <= 0.0) | ((closing > 0.0) & (room <= closing * thought))
    )
    return flags


def _flag_leader_braking(
    replay: Replay, driver: CarefulDriver, course: FloatArray, beside: _Beside
) -> BoolArray:
    """Returns (contact,) whether the actor hit braked hard, in front and within the headway."""
    along, across, turned = beside
    reach = 0.5 * (replay.width + replay.sizes[0, SizeCol.WIDTH])
    lengths = replay.length + replay.sizes[0, SizeCol.LENGTH]
    room = along - replay.path[: replay.contact, DrivenCol.ARC] - 0.5 * lengths
    flags: BoolArray = (
        (course[:, _CourseCol.DECELERATION] > driver.leader_braking)
        & (np.abs(across) < reach)
        & (np.abs(turned) < SAME_WAY)
        & (room > 0.0)
        & (room < driver.headway * replay.speed[:-1])
    )
    return flags


def _flag_cutting_in(replay: Replay, driver: CarefulDriver, beside: _Beside) -> BoolArray:
    """Returns (contact,) whether the actor hit was on its way into the ego's path from beside it.

    It is from the row in which it has moved towards the path by more than the wander until it is in
    it.
    """
    flags = np.zeros(replay.contact, dtype=np.bool_)
    away, turned = np.abs(beside.across), np.abs(beside.turned)
    reach = 0.5 * (replay.width + replay.sizes[0, SizeCol.WIDTH])
    entered = replay.contact
    while entered > 0 and away[entered - 1] < reach:
        entered -= 1
    begun = entered
    while (
        begun > 0
        and turned[begun - 1] < SAME_WAY
        and (begun == replay.contact or away[begun - 1] >= away[begun] - 1e-6)
    ):
        begun -= 1
    if begun < entered:
        flags[begun:entered] = away[begun] - away[begun:entered] > driver.wander
    return flags


@compiled
def _beside(path: FloatArray, poses: FloatArray, present: BoolArray) -> _Beside:
    """Returns the positions of an actor relative to the nearest point of the path."""
    count = poses.shape[0]
    along, across = np.full(count, np.nan), np.full(count, np.nan)
    turned = np.full(count, np.nan)
    for t in range(poses.shape[0]):
        if not present[t]:
            continue
        least = math.inf
        for i in range(path.shape[0] - 1):
            way_x = path[i + 1, DrivenCol.X] - path[i, DrivenCol.X]
            way_y = path[i + 1, DrivenCol.Y] - path[i, DrivenCol.Y]
            squared = way_x * way_x + way_y * way_y
            if squared < 1e-9:
                continue
            x = poses[t, Col.X] - path[i, DrivenCol.X]
            y = poses[t, Col.Y] - path[i, DrivenCol.Y]
            share = min(max((x * way_x + y * way_y) / squared, 0.0), 1.0)
            off = (x - share * way_x) ** 2 + (y - share * way_y) ** 2
            if off >= least:
                continue
            least = off
            piece = math.sqrt(squared)
            turn = poses[t, Col.YAW] - math.atan2(way_y, way_x)
            along[t] = path[i, DrivenCol.ARC] + share * piece
            across[t] = (way_x * y - way_y * x) / piece
            turned[t] = wrap_to_pi(turn)
    return _Beside(along, across, turned)
