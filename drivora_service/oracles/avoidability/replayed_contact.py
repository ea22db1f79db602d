"""The data for replaying a collision: the ego's recorded path and the others' recorded motion.

The record usually ends with the collision, which changes the motion of the actor that was hit. From
there on others keep their speed, or keep their deceleration until they stand; actors that went the
ego's way continue along the ego's heading.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.geometry.angles import wrap_angle
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.lines import arc_lengths
from drivora_service.observations.ground import PatchCol, wheelbase_of
from drivora_service.observations.recorded_conditions import road_frictions, trace_patches
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Col, Role, Trace

BEFORE = 20.0
"""Seconds before the contact that are considered."""

AFTER = 10.0
"""Seconds for which the replay goes on after the contact."""

NEAR = 150.0
"""Radius around the contact in which others are replayed, metres."""

SAME_WAY = math.radians(30.0)
"""Difference of headings up to which an actor goes the ego's way, radians."""

AGAINST = math.radians(115.0)
"""Difference of headings from which on an actor comes towards the ego, radians."""

_HEAD_ON = math.radians(10.0)
"""Radians from the opposite of the ego's heading up to which an actor comes head on: it follows the
same road. At larger angles one of the two turns, and leaves the way of the other."""

_CREEPS = 0.1
"""m/s up to which an actor has no direction of motion."""

_ONWARDS = 300.0
"""Metres of the straight extension of the ego's path beyond the contact."""

_SMOOTHING = 0.3
"""Seconds over which the braking of others is measured."""


class DrivenCol(IntEnum):
    """Columns of ``Replay.path``."""

    ARC = 0
    """Arc length, metres."""
    X = 1
    Y = 2
    YAW = 3
    """Continuous, without jumps by full turns, so that it can be interpolated."""
    CURVATURE = 4
    """1/m, not negative."""


class Replay(NamedTuple):
    """The rows of a trace around a collision: R rows, P points of the path, M others.

    Row ``i`` here is row ``first + i`` of the trace; the contact is in row ``contact``; rows after
    it are extrapolated. The actor that was hit is the first of the others.

    Attributes:
        step: Seconds between rows.
        first: Row of the trace at which the replay begins.
        contact: Row of the replay at the contact.
        length: Of the ego, metres.
        width: Of the ego, metres.
        path: (P, 5) the ego's path, columns ``DrivenCol``: its recorded positions up to the
            contact, and one point straight ahead.
        speed: (contact + 1,) m/s over ground of the ego.
        others: (R, M, 3), columns ``Col`` up to ``YAW``; NaN where absent.
        present: (R, M) flags.
        sizes: (M, 2), columns ``SizeCol``.
        walks: (M,) flags of walkers.
        rows: (M,) rows of the others in the trace.
        friction: Highest friction coefficient of the road in these rows; NaN if not recorded.
        road: (R,) friction of the road beside patches, as a share of ``friction``; less in worse
            weather, which after the record stays as it is.
        patches: (S, 8) slippery places on the ego's level, columns ``ground.PatchCol``, at height
            0 and with their friction as a share of ``friction``.
        wheelbase: Of the ego, metres.
        oncoming: Metres that the actor that was hit goes on against the ego's way after the
            contact; 0 if it does not come towards the ego.
        head_on: Whether it then comes straight towards the ego.
    """

    step: float
    first: int
    contact: int
    length: float
    width: float
    path: FloatArray
    speed: FloatArray
    others: FloatArray
    present: BoolArray
    sizes: FloatArray
    walks: BoolArray
    rows: IntArray
    friction: float
    road: FloatArray
    patches: FloatArray
    wheelbase: float
    oncoming: float
    head_on: bool


def cut_out(ego: EgoView, k: int, counterpart: int) -> Replay:
    """Returns the data for replaying a contact.

    Args:
        ego: The ego.
        k: Its row at the contact; at least 1.
        counterpart: Row of the other actor in the trace.
    """
    trace = ego.trace
    begin = max(k - round(BEFORE / trace.step_length), 0)
    states = ego.states[begin : k + 1]
    first, contact = ego.first + begin, k - begin
    rows = _near(trace, ego, k, counterpart)
    after = round(AFTER / trace.step_length)
    others, present = _motion(trace, rows, first, contact, after, float(states[-1, Col.YAW]))
    actors = [trace.actors[row] for row in rows]
    road = road_frictions(trace, first, len(others))
    friction = float(road.max())
    oncoming, head_on = _oncoming(trace, counterpart, first + contact, float(states[-1, Col.YAW]))
    return Replay(
        step=trace.step_length,
        first=first,
        contact=contact,
        length=ego.actor.length,
        width=ego.actor.width,
        path=_path(states),
        speed=np.ascontiguousarray(ego.speed[begin : k + 1]),
        others=others,
        present=present,
        sizes=np.array([(actor.length, actor.width) for actor in actors]),
        walks=np.array([actor.role is Role.NPC_WALKER for actor in actors]),
        rows=np.array(rows, dtype=np.int32),
        friction=friction,
        road=road / friction,
        patches=_patches(trace, float(states[-1, Col.Z]), friction),
        wheelbase=wheelbase_of(ego.actor),
        oncoming=oncoming,
        head_on=head_on,
    )


def slow_down(replay: Replay, row: int, limits: FloatArray) -> Replay:
    """Returns a replay in which the ego keeps within speed limits from a row on.

    It is on the same path, later. The others move as before.

    Args:
        replay: The collision.
        row: Row of the replay.
        limits: (contact + 1,) m/s; NaN where there is none.
    """
    # Sampled at the recorded rows: a limit of a place that the slower ego reaches later counts from
    # the row in which the recorded ego was there.
    share = np.ones(replay.contact + 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        slower = np.where(replay.speed > limits, limits / replay.speed, 1.0)
    share[row:] = slower[row:]
    driven, beyond = replay.path[: replay.contact + 1], replay.path[-1:]
    arcs = np.zeros(len(driven))
    arcs[1:] = np.cumsum(np.diff(driven[:, DrivenCol.ARC]) * share[:-1])
    places = np.column_stack(
        [np.interp(arcs, driven[:, DrivenCol.ARC], driven[:, column]) for column in DrivenCol]
    )
    ahead = driven[driven[:, DrivenCol.ARC] > arcs[-1] + 1e-9]
    path = np.ascontiguousarray(np.vstack((places, ahead, beyond)))
    return replay._replace(path=path, speed=replay.speed * share)


def _patches(trace: Trace, height: float, friction: float) -> FloatArray:
    patches = trace_patches(trace)
    here = patches[np.abs(patches[:, PatchCol.Z] - height) <= LEVEL_GAP]
    here[:, PatchCol.Z] = 0.0
    here[:, PatchCol.FRICTION] /= friction
    return here


def _near(trace: Trace, ego: EgoView, k: int, counterpart: int) -> list[int]:
    """Returns the rows of the relevant others on the ego's level, the actor that was hit first."""
    step = ego.first + k
    place = ego.states[k]
    window = trace.states[max(step - round(AFTER / trace.step_length), 0) : step + 1]
    with np.errstate(invalid="ignore"):
        away = np.hypot(window[:, :, Col.X] - place[Col.X], window[:, :, Col.Y] - place[Col.Y])
        level = np.abs(window[:, :, Col.Z] - place[Col.Z]) <= LEVEL_GAP
        near = ((away < NEAR) & level).any(axis=0)
    near[[ego.row, counterpart]] = False
    return [counterpart, *np.flatnonzero(near).tolist()]


def _path(states: FloatArray) -> FloatArray:
    """Returns the (P, 5) path through (n, 9) states."""
    path = np.zeros((len(states) + 1, len(DrivenCol)))
    driven, end, beyond = path[:-1], path[-2], path[-1]
    driven[:, DrivenCol.ARC] = arc_lengths(states[:, [Col.X, Col.Y]])
    driven[:, [DrivenCol.X, DrivenCol.Y]] = states[:, [Col.X, Col.Y]]
    driven[:, DrivenCol.YAW] = np.unwrap(states[:, Col.YAW])
    yaw = end[DrivenCol.YAW]
    beyond[DrivenCol.ARC] = end[DrivenCol.ARC] + _ONWARDS
    beyond[DrivenCol.X] = end[DrivenCol.X] + _ONWARDS * math.cos(yaw)
    beyond[DrivenCol.Y] = end[DrivenCol.Y] + _ONWARDS * math.sin(yaw)
    beyond[DrivenCol.YAW] = yaw
    speed = np.hypot(states[:, Col.VX], states[:, Col.VY])
    turning = np.abs(states[:, Col.YAW_RATE])
    driven[:, DrivenCol.CURVATURE] = np.where(speed > 1.0, turning / np.maximum(speed, 1.0), 0.0)
    return path


def _oncoming(trace: Trace, row: int, step: int, heading: float) -> tuple[float, bool]:
    """Returns how far an actor goes on against a heading after a row, and whether head on.

    Metres, 0 if it does not come towards the heading.
    """
    state = trace.states[step, row]
    speed, braking = _pace(trace, row, step)
    turn = abs(wrap_angle(math.atan2(state[Col.VY], state[Col.VX]) - heading))
    if speed <= _CREEPS or turn < AGAINST:
        return 0.0, False
    reach = speed * speed / (2.0 * braking) if braking > 0.0 else math.inf
    return reach, turn > math.pi - _HEAD_ON


def _pace(trace: Trace, row: int, step: int) -> tuple[float, float]:
    """Returns an actor's speed in a row, m/s, and its braking until then, m/s², at least 0."""
    back = max(step - max(round(_SMOOTHING / trace.step_length), 1), 0)
    speed = math.hypot(*trace.states[step, row, [Col.VX, Col.VY]])
    if not trace.present[back, row] or back >= step:
        return speed, 0.0
    before = math.hypot(*trace.states[back, row, [Col.VX, Col.VY]])
    return speed, max((before - speed) / ((step - back) * trace.step_length), 0.0)


def _motion(
    trace: Trace, rows: list[int], first: int, contact: int, after: int, heading: float
) -> tuple[FloatArray, BoolArray]:
    """Returns (R, M, 3) poses and (R, M) presence of the others, extrapolated after the record."""
    count = contact + after + 1
    others = np.full((count, len(rows), Col.YAW + 1), np.nan)
    present = np.zeros((count, len(rows)), dtype=np.bool_)
    kept = min(trace.step_count - first, count)
    others[:kept] = trace.states[first : first + kept][:, rows, : Col.YAW + 1]
    present[:kept] = trace.present[first : first + kept][:, rows]
    for m, row in enumerate(rows):
        last = contact if m == 0 else kept - 1
        if not present[last, m]:
            continue
        _carry_on(trace, first, row, last, heading, others[:, m])
        present[last:, m] = True
    return others, present


def _carry_on(
    trace: Trace, first: int, row: int, last: int, heading: float, poses: FloatArray
) -> None:
    """Fills the (R, 3) poses of an actor after row ``last``."""
    state = trace.states[first + last, row]
    speed, braking = _pace(trace, row, first + last)
    way = math.atan2(state[Col.VY], state[Col.VX]) if speed > _CREEPS else float(state[Col.YAW])
    yaw = float(state[Col.YAW])
    if abs(wrap_angle(way - heading)) < SAME_WAY:
        yaw = way = heading
    times = trace.step_length * np.arange(1, len(poses) - last)
    if braking > 0.0:
        times = np.minimum(times, speed / braking)
    distance = speed * times - 0.5 * braking * times**2
    poses[last + 1 :, Col.X] = state[Col.X] + distance * math.cos(way)
    poses[last + 1 :, Col.Y] = state[Col.Y] + distance * math.sin(way)
    poses[last + 1 :, Col.YAW] = yaw
