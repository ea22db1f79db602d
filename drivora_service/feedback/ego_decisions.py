"""Decisions of egos, inferred from the trace.

DoppelTest reads the decisions from the messages of the planner under test. For an ADS that shows
only its controls they are inferred from the trace: a decision is a pattern of driving.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.networks.routes.route_meetings import Meeting
from drivora_service.observations.run_view import EgoView, RunView
from drivora_service.observations.stretches import stretches
from drivora_service.observations.trace import LEVEL_GAP, Col, EgoCol, Light, Role
from drivora_service.oracles.blocked import STANDING_SPEED

_SAMPLE_TIME = 0.5
_WALKER_ROOM = 4.0
_SIDE_ROOM = 0.5
_VEHICLES = (Role.EGO, Role.NPC_VEHICLE, Role.BACKGROUND)


class Decision(IntEnum):
    """A decision of an ego about another actor, a signal, or its lane."""

    STOP_AT_SIGNAL = 1
    """Stopped before a stop line whose signal was not green, with no actor ahead."""
    STOP_BEHIND_VEHICLE = 2
    """Stopped with a vehicle or an obstacle ahead."""
    STOP_FOR_WALKER = 3
    """Stopped with a walker ahead, or beside its path."""
    STOP_ELSEWHERE = 4
    """Stopped for another reason, as at a junction without lights."""
    YIELD = 5
    """Slowed down or stood before a place where its route meets that of an ego that went first."""
    GO_FIRST = 6
    """Passed such a place while the other ego was near it and free to go."""
    OVERTAKE = 7
    """Drove past a vehicle that had been ahead in its lane."""
    CHANGE_LEFT = 8
    """Changed to the lane on its left."""
    CHANGE_RIGHT = 9
    """Changed to the lane on its right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionThresholds:
    """The thresholds of the decisions.

    Attributes:
        stop_time: Seconds for which an ego must stand for a stop.
        stop_reach: Metres ahead of its bumper within which the reason of a stop is searched.
        speed_loss: m/s that an ego must lose to have slowed down for another.
        look_back: Seconds before the other's passage from which on the loss counts.
        approach: Metres before the meeting place within which an ego is near it; metres ahead and
            behind within which an ego sees the vehicle that it overtakes.
        lane_half_width: Metres to either side within which a vehicle is in the ego's lane.
        beside: Metres to either side within which a vehicle has been overtaken, not left.
        same_heading: Radians up to which two headings are the same.
    """

    stop_time: float = 1.0
    stop_reach: float = 10.0
    speed_loss: float = 2.0
    look_back: float = 5.0
    approach: float = 30.0
    lane_half_width: float = 1.6
    beside: float = 6.0
    same_heading: float = math.radians(30.0)


def find_decisions(
    run: RunView, meetings: Sequence[Meeting], thresholds: DecisionThresholds
) -> tuple[tuple[int, Decision], ...]:
    """Finds the decisions of every ego.

    Args:
        run: The run.
        meetings: Meeting places of the egos' routes; routes are numbered as the egos.
        thresholds: The thresholds.

    Returns:
        (row of the ego, decision), each once, sorted.
    """
    found: set[tuple[int, Decision]] = set()
    for ego in run.egos:
        if ego.count:
            found.update((ego.row, decision) for decision in _stops(ego, thresholds))
            found.update((ego.row, decision) for decision in _lane_changes(ego))
            if _overtakes(ego, thresholds):
                found.add((ego.row, Decision.OVERTAKE))
    for meeting in meetings:
        found.update(_precedence(run, meeting, thresholds))
    return tuple(sorted(found))


def _stops(ego: EgoView, thresholds: DecisionThresholds) -> Iterator[Decision]:
    """Yields a decision for every time that the ego came to a stand."""
    for first, stop in stretches(ego.speed < STANDING_SPEED):
        # An ego stands at its start, which is no decision.
        if first > 0 and (stop - first) * ego.step_length >= thresholds.stop_time:
            yield _reason(ego, first, thresholds)


def _reason(ego: EgoView, k: int, thresholds: DecisionThresholds) -> Decision:
    """Returns why an ego stopped at its row ``k``: the nearest actor ahead, else the signal."""
    trace = ego.trace
    step = ego.first + k
    nearest, decision = math.inf, Decision.STOP_ELSEWHERE
    x, y, yaw = ego.states[k, [Col.X, Col.Y, Col.YAW]]
    cos, sin = math.cos(yaw), math.sin(yaw)
    for other in trace.actors:
        if other.row == ego.row or not trace.present[step, other.row]:
            continue
        state = trace.states[step, other.row]
        if abs(state[Col.Z] - ego.states[k, Col.Z]) > LEVEL_GAP:
            continue
        dx, dy = state[Col.X] - x, state[Col.Y] - y
        ahead, across = dx * cos + dy * sin, abs(dy * cos - dx * sin)
        c, s = abs(math.cos(state[Col.YAW] - yaw)), abs(math.sin(state[Col.YAW] - yaw))
        gap = ahead - 0.5 * (ego.actor.length + other.length * c + other.width * s)
        aside = across - 0.5 * (ego.actor.width + other.length * s + other.width * c)
        is_walker = other.role is Role.NPC_WALKER
        near = ahead > 0.0 and gap <= min(thresholds.stop_reach, nearest)
        if near and aside <= (_WALKER_ROOM if is_walker else _SIDE_ROOM):
            nearest = gap
            decision = Decision.STOP_FOR_WALKER if is_walker else Decision.STOP_BEHIND_VEHICLE
    if decision is Decision.STOP_ELSEWHERE and _is_held(ego, k, thresholds.stop_reach):
        return Decision.STOP_AT_SIGNAL
    return decision


def _is_held(ego: EgoView, k: int, reach: float) -> bool:
    """Returns whether a signal within reach of an ego's bumper at its row ``k`` is not green."""
    distance = float(ego.value(EgoCol.LIGHT_DISTANCE)[k])
    return bool(0.0 <= distance <= reach and ego.lights[k] >= Light.YELLOW)


def _lane_changes(ego: EgoView) -> Iterator[Decision]:
    lanes = ego.network.lanes
    for k in np.flatnonzero(np.diff(ego.lanes)):
        before, behind = int(ego.lanes[k]), int(ego.lanes[k + 1])
        if before < 0 or behind < 0:
            continue
        if lanes[before].left == behind:
            yield Decision.CHANGE_LEFT
        elif lanes[before].right == behind:
            yield Decision.CHANGE_RIGHT


def _overtakes(ego: EgoView, thresholds: DecisionThresholds) -> bool:
    """Returns whether any vehicle was ahead of the ego in its lane and later behind it."""
    trace = ego.trace
    rows = [a.row for a in trace.actors if a.role in _VEHICLES and a.row != ego.row]
    every = max(round(_SAMPLE_TIME / trace.step_length), 1)
    own = ego.states[::every, None]
    others = trace.states[ego.first : ego.first + ego.count : every, rows]
    offsets = others - own
    cos, sin = elementary.cos(own[..., Col.YAW]), elementary.sin(own[..., Col.YAW])
    ahead = offsets[..., Col.X] * cos + offsets[..., Col.Y] * sin
    across = np.abs(offsets[..., Col.Y] * cos - offsets[..., Col.X] * sin)
    lengths = 0.5 * (ego.actor.length + np.array([trace.actors[row].length for row in rows]))
    # Comparisons with NaN, where an actor is absent, are false.
    along = elementary.cos(offsets[..., Col.YAW]) >= math.cos(thresholds.same_heading)
    along &= (np.abs(ahead) <= thresholds.approach) & (np.abs(offsets[..., Col.Z]) <= LEVEL_GAP)
    before = along & (ahead > 0.0) & (across <= thresholds.lane_half_width)
    behind = along & (ahead < -lengths) & (across <= thresholds.beside)
    was_before = np.logical_or.accumulate(before, axis=0)
    return bool((was_before & behind).any())


def _precedence(
    run: RunView, meeting: Meeting, thresholds: DecisionThresholds
) -> Iterator[tuple[int, Decision]]:
    """Yields the ego that went first and the one that yielded, if both were near."""
    pair = [run.egos[meeting.first], run.egos[meeting.second]]
    entries = [
        _step_at(ego, zone[0] - 0.5 * ego.actor.length)
        for ego, zone in zip(pair, meeting.zones, strict=True)
    ]
    if entries[0] == entries[1]:
        return
    earlier = 0 if entries[0] < entries[1] else 1
    first, second = pair[earlier], pair[1 - earlier]
    place = meeting.zones[1 - earlier][0] - 0.5 * second.actor.length
    begin = int(entries[earlier])
    left = _step_at(first, meeting.zones[earlier][1] + 0.5 * first.actor.length)
    end = int(min(left, entries[1 - earlier], first.first + first.count - 1))
    end = min(end, second.first + second.count - 1)
    if begin < second.first or end < begin:
        return
    passing = slice(begin - second.first, end - second.first + 1)
    way = place - second.value(EgoCol.ROUTE_S)[passing]
    if not way[-1] <= thresholds.approach or _is_held(second, passing.start, thresholds.approach):
        return
    yield first.row, Decision.GO_FIRST
    slowest = passing.start + int(np.argmin(second.speed[passing]))
    since = max(passing.start - round(thresholds.look_back / second.step_length), 0)
    loss = float(second.speed[since : slowest + 1].max() - second.speed[slowest])
    stood = second.speed[slowest] < STANDING_SPEED and bool(second.moved[: slowest + 1].any())
    if stood or loss >= thresholds.speed_loss:
        yield second.row, Decision.YIELD


def _step_at(ego: EgoView, route_s: float) -> float:
    """Returns the row of the trace at which an ego's centre reached ``route_s``; inf if never."""
    driven: FloatArray = ego.value(EgoCol.ROUTE_S)
    come = driven >= route_s
    return float(ego.first + int(np.argmax(come))) if come.any() else math.inf
