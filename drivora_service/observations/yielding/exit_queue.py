"""The queue in an ego's exit, which another vehicle has to brake for without the ego as well.

An ego that has left the junction as the last of a queue takes one place in it. A vehicle that comes
into the same exit stops, or slows down to the queue's speed, one place earlier than without it.
"""

from __future__ import annotations

import math

from drivora_service.observations.leaders import leaders
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import Col
from drivora_service.observations.yielding.own_course import BESIDE, COMFORT, SLOWER, Course

_STANDSTILL = 2.5
"""Metres between the vehicles of a queue that stands (SUMO's ``minGap``)."""


def is_last_of_queue(ego: EgoView, other: int, course: Course, onset: int, row: int) -> bool:
    """Returns whether an ego asks a vehicle behind it for no more than the ego's own leader does.

    Each of the two asks for the speed from which the vehicle slows comfortably to theirs until it
    has closed up. The ego's place in the queue, its length and a gap, is no difference, unless the
    ego takes it right before the vehicle (``asks_more_than``).

    Args:
        ego: The ego, which has left the junction.
        other: Row of the vehicle in the trace.
        course: Its way.
        onset: Row of the trace in which its braking began.
        row: Row of the trace in which it is hardest.
    """
    ahead = leaders(ego, vehicles_only=True)
    k = row - ego.first
    gap = _gap(ego, other, course, ego.row, row, row)
    if gap is None or ahead.actor[k] < 0 or not ahead.same_way[k]:
        return False
    asked = _asked_speed(float(ego.speed[k]), gap)
    queue = _asked_speed(float(ahead.speed[k]), gap + float(ahead.room[k]) - _STANDSTILL)
    share, less = SLOWER
    if asked < share * queue - less:
        return False
    return not asks_more_than(ego, other, course, int(ahead.actor[k]), onset, row)


def asks_more_than(
    ego: EgoView, other: int, course: Course, actor: int, onset: int, row: int
) -> bool:
    """Returns whether an ego asks for uncomfortable braking, and an actor beyond it does not.

    Args:
        ego: The ego.
        other: Row of the vehicle that brakes in the trace.
        course: Its way.
        actor: Row of the actor in the trace.
        onset: Row of the trace in which the braking began.
        row: Row of the trace in which it is hardest.
    """
    to_ego = _gap(ego, other, course, ego.row, onset, row)
    to_actor = _gap(ego, other, course, actor, onset, row)
    if to_ego is None or to_actor is None or to_actor <= to_ego:
        return False
    states = ego.trace.states
    speed, own, theirs = (
        math.hypot(*states[when, which, [Col.VX, Col.VY]])
        for when, which in ((onset, other), (row, ego.row), (row, actor))
    )
    return _needed(speed, own, to_ego) > COMFORT >= _needed(speed, theirs, to_actor)


def _needed(speed: float, ahead: float, gap: float) -> float:
    """Returns the m/s² that slow a vehicle to the speed of an actor ahead before it closes up."""
    room = max(gap - _STANDSTILL, 0.1)
    return max(speed * speed - ahead * ahead, 0.0) / (2.0 * room)


def _gap(
    ego: EgoView, other: int, course: Course, actor: int, since: int, row: int
) -> float | None:
    """Returns the metres on a vehicle's way from its front to the rear of an actor ahead.

    None if that is not ahead on the way.

    Args:
        ego: The ego.
        other: Row of the vehicle in the trace.
        course: Its way.
        actor: Row of the actor in the trace.
        since: Row of the trace of the vehicle's place.
        row: Row of the trace of the actor's place.
    """
    trace = ego.trace
    arc, away = course.locate(trace.states[row, actor])
    own_arc, _ = course.locate(trace.states[since, other])
    if away > BESIDE or arc <= own_arc:
        return None
    return max(arc - own_arc - 0.5 * (trace.actors[actor].length + trace.actors[other].length), 0.0)


def _asked_speed(ahead: float, gap: float) -> float:
    return math.sqrt(max(ahead, 0.0) ** 2 + 2.0 * COMFORT * max(gap, 0.0))
