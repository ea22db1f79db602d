"""Whether another vehicle brakes because of an ego, or for reasons of its own way.

Vehicles brake all the time: before bends and turns, for their own signals, behind others. SUMO's
drivers brake at 4 m/s² and more about twice a vehicle-minute with no ego near. So a braking is the
ego's doing only if three things hold: at its speed the vehicle would have come into the ego's way
within a short time; no other actor ahead explains it; and it becomes slower than its own way asks.
A queue is an actor ahead that explains it, also if the ego is the last vehicle of that queue.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.geometry.boxes import overlap_depth
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import LEVEL_GAP, Col
from drivora_service.observations.yielding.exit_queue import (
    asks_more_than,
    is_last_of_queue,
)
from drivora_service.observations.yielding.own_course import (
    BESIDE,
    COMFORT,
    SLOWER,
    Course,
    allowed_speeds,
    follow_course,
    lane_course,
)

_EASED = 1.0
"""m/s² below which a vehicle does not brake: its braking begins after the last such row."""

_WITHIN = 1.0
"""Seconds between the ego's being at a place and the vehicle's being there, at its speed before it
braked, up to which the two are in each other's way."""

_FORESIGHT = 4.0
"""Seconds after the begin of a braking within which the two must come into each other's way: a
driver farther away has no need to brake yet (UN Regulation No. 152 tests emergency braking from 4 s
before a meeting on)."""

_STOOD = (10.0, 1.0)
"""Seconds in which an ego that drove less than these metres blocked the way rather than went first:
vehicles that come later wait as behind any standing vehicle, and ``junction_blocking`` judges the
ego, from the same time and with the same distance."""

_SOON = 1.0
"""Seconds ahead of a vehicle in which bends, signals and signs are reasons for its speed: few
drivers brake at the last moment that their comfort allows."""

_EARLIER = 1.0
"""Seconds before the ego is in the way in which another driver may brake for it."""

_MEASURED = 0.5
"""Seconds over which braking is measured."""

_UNSLOWED = 0.95
"""Share of a vehicle's speed up to which its own way asks for no slowing."""

_HEADWAY = 3.0
"""Seconds ahead of a vehicle within which another actor is the reason for its braking."""

_ALONE = 20.0
"""The same in metres, at low speeds."""

_SAMPLES = 40
"""Places on a vehicle's way at which actors ahead are looked for, closer than cars are long."""


class Passage(NamedTuple):
    """The ego's rows of a passage through a junction.

    Attributes:
        first: The row from which on it may be in the way.
        leaves: The first row after the junction.
        last: The last row in which it may be in the way.
    """

    first: int
    leaves: int
    last: int


def hindered_braking(
    ego: EgoView, other: int, passage: Passage, lanes: frozenset[int]
) -> tuple[float, int]:
    """Returns the hardest braking of a vehicle that the ego caused, m/s², and its row of the trace.

    0 and -1 if the ego caused none.

    Args:
        ego: The ego.
        other: Row of the vehicle in the trace.
        passage: The ego's.
        lanes: Lanes inside the junction on which the vehicle goes before the ego.
    """
    trace = ego.trace
    first = max(passage.first - round(_EARLIER / ego.step_length), 0)
    passage = passage._replace(first=first)
    rows = slice(ego.first + first, ego.first + passage.last + 1)
    braking = _braking(trace.states[rows, other], trace.present[rows, other], ego.step_length)
    # Each braking has its own reason: the hardest may be that for a bend behind the junction.
    caused, row = 0.0, -1
    for begun, ended in stretches(braking >= _EASED):
        worst = begun + int(np.argmax(braking[begun:ended]))
        hardest = float(braking[worst])
        if hardest > caused and _is_caused(
            ego, other, ego.first + first + worst, hardest, passage, lanes
        ):
            caused, row = hardest, ego.first + first + worst
    return caused, row


def _is_caused(
    ego: EgoView,
    other: int,
    worst: int,
    hardest: float,
    passage: Passage,
    lanes: frozenset[int],
) -> bool:
    """Returns whether the ego caused a braking of ``hardest`` m/s² in a row of the trace."""
    trace = ego.trace
    onset = _onset(ego, other, worst)
    course = follow_course(ego, other, onset)
    speed = math.hypot(*trace.states[onset, other, [Col.VX, Col.VY]])
    straight = lane_course(ego, other, onset, lanes)
    courses = (course,) if straight is None else (course, straight)
    met = [each for each in courses if _would_meet(ego, other, each, onset, speed, passage)]
    if not met:
        return False
    allowed = allowed_speeds(ego, course, onset, lanes)
    if _follows(ego, other, course, onset, worst):
        return False
    is_out = worst >= ego.first + passage.leaves
    if is_out and any(is_last_of_queue(ego, other, each, onset, worst) for each in met):
        return False
    asked = float(np.interp(course.arc_at(trace.states[worst, other]), course.arc, allowed))
    # Where its way asks for no slowing, no driver brakes that hard without a reason.
    is_harsh = hardest > COMFORT and asked >= _UNSLOWED * speed
    return is_harsh or _is_too_slow(ego, other, course, allowed, worst)


def _braking(states: FloatArray, present: BoolArray, step: float) -> FloatArray:
    """Returns (n,) m/s² of braking along the heading, 0 where a vehicle does not go forwards.

    The mean over ``_MEASURED``: SUMO's drivers brake for a step, and let go for the next.

    Args:
        states: (n, 9) of the vehicle, columns ``Col``.
        present: (n,) flags of the vehicle.
        step: Seconds between two rows.
    """
    yaw = states[:, Col.YAW]
    cos, sin = elementary.cos(yaw), elementary.sin(yaw)
    along = states[:, Col.AX] * cos + states[:, Col.AY] * sin
    speed = states[:, Col.VX] * cos + states[:, Col.VY] * sin
    slowing = np.where(present & (speed > 0.0), -along, 0.0)
    if not len(slowing):
        return slowing
    # A window longer than the record would lengthen the result.
    count = min(max(round(_MEASURED / step), 1), len(slowing))
    # By sums, which are the same bits on every processor.
    summed = np.concatenate(([0.0], np.cumsum(slowing)))
    first = np.clip(np.arange(len(slowing)) - count // 2, 0, len(slowing))
    last = np.clip(np.arange(len(slowing)) + (count + 1) // 2, 0, len(slowing))
    braking: FloatArray = (summed[last] - summed[first]) / count
    return np.where(present, np.maximum(braking, 0.0), 0.0)


def _onset(ego: EgoView, other: int, worst: int) -> int:
    """Returns the row of the trace in which a braking began that is hardest in row ``worst``."""
    trace = ego.trace
    braking = _braking(
        trace.states[: worst + 1, other], trace.present[: worst + 1, other], trace.step_length
    )
    eased = np.flatnonzero((braking < _EASED) | ~trace.present[: worst + 1, other])
    begun = int(eased[-1]) if len(eased) else 0
    return begun if trace.present[begun, other] else min(begun + 1, worst)


def _would_meet(
    ego: EgoView,
    other: int,
    course: Course,
    onset: int,
    speed: float,
    passage: Passage,
) -> bool:
    """Returns whether a vehicle that keeps its speed is at the ego's place at about its time.

    By their boxes: a driver also brakes for an ego that has only a corner in the way.
    """
    trace = ego.trace
    begin, last = passage.first, passage.last
    margin = round(_WITHIN / ego.step_length)
    times = np.arange(ego.first + begin - margin, ego.first + last + margin + 1)
    arcs = speed * ego.step_length * (times - onset)
    soon = times - onset <= round(_FORESIGHT / ego.step_length)
    known = (arcs >= 0.0) & (arcs <= course.arc[-1]) & soon
    driven = np.cumsum(ego.moved)
    seconds, metres = _STOOD
    ago = np.maximum(np.arange(begin, last + 1) - round(seconds / ego.step_length), 0)
    went = (driven[begin : last + 1] - driven[ago] >= metres) | (ago == 0)
    places = np.column_stack(
        [np.interp(arcs, course.arc, values) for values in (course.x, course.y, course.yaw)]
    )
    actor = trace.actors[other]
    return _boxes_meet(
        ego.states[begin : last + 1],
        went,
        places,
        known,
        margin,
        (ego.actor.length, ego.actor.width),
        (actor.length, actor.width),
    )


@compiled
def _boxes_meet(
    ego: FloatArray,
    went: BoolArray,
    places: FloatArray,
    known: BoolArray,
    margin: int,
    own_box: tuple[float, float],
    box: tuple[float, float],
) -> bool:
    """Returns whether a box is at a place of the ego, up to some rows earlier or later.

    Args:
        ego: (n, 9) states of the ego, columns ``Col``.
        went: (n,) flags of the ego's rows that count.
        places: (n + 2 margin, 3) x, y and heading of the other, from ``margin`` rows earlier on.
        known: (n + 2 margin,) flags of the places that count.
        margin: Rows.
        own_box: Length and width of the ego, metres.
        box: Length and width of the other.
    """
    reach = 0.5 * (math.hypot(own_box[0], own_box[1]) + math.hypot(box[0], box[1]))
    for k in range(len(ego)):
        if not went[k]:
            continue
        for j in range(k, k + 2 * margin + 1):
            if not known[j]:
                continue
            dx, dy = places[j, 0] - ego[k, Col.X], places[j, 1] - ego[k, Col.Y]
            if math.hypot(dx, dy) > reach:
                continue
            depth = overlap_depth(
                dx, dy, ego[k, Col.YAW], own_box[0], own_box[1], places[j, 2], box[0], box[1]
            )
            if depth > 0.0:
                return True
    return False


def _follows(ego: EgoView, other: int, course: Course, onset: int, row: int) -> bool:
    """Returns whether another actor than the ego is ahead on a vehicle's way in a row.

    One beyond the ego is no reason for braking that only the ego asks for.

    Args:
        ego: The ego.
        other: Row of the vehicle in the trace.
        course: Its way.
        onset: Row of the trace in which its braking began.
        row: Row of the trace in which it brakes hardest.
    """
    trace = ego.trace
    state = trace.states[row, other]
    speed = math.hypot(state[Col.VX], state[Col.VY])
    reach = max(_ALONE, _HEADWAY * speed)
    arc = course.arc_at(state)
    samples = np.linspace(arc, min(arc + reach, float(course.arc[-1])), _SAMPLES)
    way = np.column_stack(
        (np.interp(samples, course.arc, course.x), np.interp(samples, course.arc, course.y))
    )
    for actor in trace.actors:
        if actor.row in (ego.row, other) or not trace.present[row, actor.row]:
            continue
        theirs = trace.states[row, actor.row]
        if abs(theirs[Col.Z] - state[Col.Z]) > LEVEL_GAP:
            continue
        away = np.hypot(*(way - theirs[[Col.X, Col.Y]]).T)
        nearest = int(np.argmin(away))
        # The first sample is the vehicle's own place: what is nearest to it is beside or behind.
        if nearest == 0 or float(away[nearest]) >= BESIDE:
            continue
        if not asks_more_than(ego, other, course, actor.row, onset, row):
            return True
    return False


def _is_too_slow(ego: EgoView, other: int, course: Course, allowed: FloatArray, worst: int) -> bool:
    """Returns whether a vehicle becomes slower than its own way asks while it brakes.

    Args:
        ego: The ego.
        other: Row of the vehicle in the trace.
        course: Its way.
        allowed: (p,) m/s that its way allows at the places of its course.
        worst: Row of the trace in which it brakes hardest.
    """
    trace = ego.trace
    # Until it no longer brakes: what brakes for its own way stops at the speed that this asks for.
    states, present = trace.states[worst:, other], trace.present[worst:, other]
    braking = _braking(states, present, trace.step_length)
    eased = np.flatnonzero((braking < _EASED) | ~present)
    last = worst + (int(eased[0]) if len(eased) else len(states) - 1)
    share, less = SLOWER
    for row in range(worst, last + 1):
        state = trace.states[row, other]
        if not trace.present[row, other]:
            break
        arc, speed = course.arc_at(state), math.hypot(state[Col.VX], state[Col.VY])
        ahead = np.linspace(arc, arc + _SOON * speed, _SAMPLES)
        may = float(np.interp(ahead, course.arc, allowed).min())
        if speed < share * may - less:
            return True
    return False
