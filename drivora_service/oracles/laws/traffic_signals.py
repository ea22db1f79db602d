"""Signals of the actors around an ego."""

from __future__ import annotations

import math
from weakref import WeakKeyDictionary

import numpy as np

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.leaders import SAME_WAY, VEHICLES, Leaders, leaders
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import LEVEL_GAP, Col, Role
from drivora_service.oracles.laws.lane_signals import lane_change

_AFTER_CHANGE = 2.0
"""Seconds after a change of lanes in which the vehicle behind counts."""

_LEADERS: WeakKeyDictionary[EgoView, Leaders] = WeakKeyDictionary()


def leader_gap(ego: EgoView) -> FloatArray:
    """Returns the (n,) metres to the vehicle ahead that goes the same way; NaN without one."""
    ahead = _ahead(ego)
    return np.where(ahead.same_way, ahead.room, np.nan)


def leader_speed(ego: EgoView) -> FloatArray:
    """Returns the (n,) speed of that vehicle along the ego's heading, m/s; NaN without one."""
    ahead = _ahead(ego)
    return np.where(ahead.same_way, ahead.speed, np.nan)


def closing_from_behind(ego: EgoView) -> FloatArray:
    """Returns the (n,) seconds until the vehicle behind would touch an ego that changed lanes.

    NaN more than 2 s after a change of lanes, and without a vehicle behind that is faster.
    """
    times = np.full(ego.count, np.nan)
    recent = np.zeros(ego.count, dtype=np.bool_)
    changed = np.flatnonzero(lane_change(ego, to_left=True) + lane_change(ego, to_left=False))
    for row in changed.tolist():
        recent[row : row + round(_AFTER_CHANGE / ego.step_length) + 1] = True
    rows = np.flatnonzero(recent)
    if not len(rows):
        return times
    trace = ego.trace
    others = [a for a in trace.actors if a.row != ego.row and a.role in VEHICLES]
    yaw = ego.states[rows, Col.YAW]
    cos, sin = elementary.cos(yaw), elementary.sin(yaw)
    soonest = np.full(len(rows), np.inf)
    for other in others:
        states = trace.states[ego.first + rows, other.row]
        dx = states[:, Col.X] - ego.states[rows, Col.X]
        dy = states[:, Col.Y] - ego.states[rows, Col.Y]
        behind, across = -(dx * cos + dy * sin), np.abs(dy * cos - dx * sin)
        turn = states[:, Col.YAW] - yaw
        along, aside = np.abs(elementary.cos(turn)), np.abs(elementary.sin(turn))
        half_width = 0.5 * (ego.actor.width + other.length * aside + other.width * along)
        room = behind - 0.5 * (ego.actor.length + other.length * along + other.width * aside)
        closing = states[:, Col.VX] * cos + states[:, Col.VY] * sin - ego.forward_speed[rows]
        # Comparisons with the NaN of an absent actor are false.
        follows = (behind > 0.0) & (across < half_width)
        follows &= elementary.cos(turn) > math.cos(SAME_WAY)
        follows &= np.abs(states[:, Col.Z] - ego.states[rows, Col.Z]) <= LEVEL_GAP
        follows &= closing > 1e-6
        seconds = np.maximum(room, 0.0) / np.where(follows, closing, 1.0)
        soonest = np.where(follows, np.minimum(soonest, seconds), soonest)
    times[rows] = np.where(np.isinf(soonest), np.nan, soonest)
    return times


def time_to_collision(ego: EgoView) -> FloatArray:
    """Returns the (n,) seconds to the first contact with an actor not behind; NaN without one."""
    soonest = ego.proximity.forward_time_to_collision
    return np.where(np.isinf(soonest), np.nan, soonest)


def required_braking(ego: EgoView) -> FloatArray:
    """Returns the (n,) deceleration that keeps the ego from the actor ahead, m/s²; NaN if none."""
    needed = ego.proximity.required_deceleration
    return np.where(np.isinf(needed), np.nan, needed)


def walker_distance(ego: EgoView) -> FloatArray:
    """Returns the (n,) metres between the circles around ego and nearest walker; NaN if none."""
    trace = ego.trace
    nearest = np.full(ego.count, np.inf)
    own = 0.5 * np.hypot(ego.actor.length, ego.actor.width)
    for walker in trace.actors:
        if walker.role is not Role.NPC_WALKER:
            continue
        states = trace.states[ego.first : ego.first + ego.count, walker.row]
        away = np.hypot(
            states[:, Col.X] - ego.states[:, Col.X], states[:, Col.Y] - ego.states[:, Col.Y]
        )
        away = away - own - 0.5 * np.hypot(walker.length, walker.width)
        level = np.abs(states[:, Col.Z] - ego.states[:, Col.Z]) <= LEVEL_GAP
        nearest = np.where(level, np.fmin(nearest, np.maximum(away, 0.0)), nearest)
    return np.where(np.isinf(nearest), np.nan, nearest)


def _ahead(ego: EgoView) -> Leaders:
    if ego not in _LEADERS:
        _LEADERS[ego] = leaders(ego, vehicles_only=True)
    return _LEADERS[ego]
