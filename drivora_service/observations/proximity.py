"""Proximity of an ego to other actors: gaps, time to collision, required braking, encroachment.

Times to collision assume that both boxes keep their velocity and heading (exact in time; nuPlan
samples the same model every 0.1 s). Braking and safe distances concern actors ahead, whose box
overlaps the strip that the ego's width sweeps along its heading. Actors on another level of a
bridge do not count.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, Int32Array
from drivora_service.geometry.boxes import box_gap, overlap_depth, time_to_contact
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.trace import LEVEL_GAP, Col, Trace

HORIZON = 10.0
"""Maximum computed time to collision, seconds."""

ENCROACHMENT_HORIZON = 5.0
"""Maximum computed post-encroachment time, seconds."""

ENCROACHMENT_STEP = 0.1
"""Seconds between the ego's places for the search for encroachments."""

BEHIND = math.radians(150.0)
"""Bearing from which on an actor is behind the ego (nuPlan), radians."""

CROSSING_ANGLE = math.radians(30.0)
"""Difference of headings from which on paths cross, radians; below, one actor follows the other."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SafeDistance:
    """Parameters of the longitudinal safe distance of RSS.

    Source: Shalev-Shwartz, Shammah, Shashua, "On a formal model of safe and scalable self-driving
    cars" (2017), definition 1; the values are the defaults of the ad-rss library.

    Attributes:
        response_time: Seconds.
        acceleration: m/s² that the ego may gain during the response time.
        own_braking: m/s² of the ego's weakest braking.
        other_braking: m/s² of the strongest braking of the actor ahead.
    """

    response_time: float = 1.0
    acceleration: float = 3.5
    own_braking: float = 4.0
    other_braking: float = 8.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Proximity:
    """Proximity of an ego to other actors, over its n judged rows.

    Attributes:
        min_gap: Least distance between its box and another, metres; None without other actors.
        min_gap_row: Row of ``min_gap`` among the judged rows, -1 without others.
        min_gap_actor: Row of that actor in the trace, -1 without others.
        time_to_collision: (n,) seconds to the first contact with any actor, inf beyond ``HORIZON``.
        time_to_collision_actor: (n,) row of that actor in the trace, -1 if there is none.
        forward_time_to_collision: (n,) the same for actors that are not behind.
        drac: (n,) deceleration to avoid a crash, m/s²: squared closing speed over twice the gap; 0
            if no gap closes, inf without a gap.
        required_deceleration: (n,) the same, with the actor ahead braking on until it stands.
        rss_violated: (n,) whether the distance to an actor ahead was below the safe distance.
        post_encroachment_time: Least seconds between one box leaving a place and the other, on a
            crossing path, being there; 0 if they touch, None if no paths cross in time.
        post_encroachment_row: Row among the judged rows at which the ego is at that place, -1 if
            there is none or boxes touch.
        post_encroachment_actor: Row of the other in the trace, -1 if there is none.
    """

    min_gap: float | None
    min_gap_row: int
    min_gap_actor: int
    time_to_collision: FloatArray
    time_to_collision_actor: Int32Array
    forward_time_to_collision: FloatArray
    drac: FloatArray
    required_deceleration: FloatArray
    rss_violated: BoolArray
    post_encroachment_time: float | None
    post_encroachment_row: int
    post_encroachment_actor: int


def gaps_between(trace: Trace, first: int, second: int) -> FloatArray:
    """Returns the (T,) distance between two actors' boxes in metres, NaN if one is absent."""
    return _gaps(
        trace.states,
        trace.present,
        first,
        second,
        _sizes(trace),
    )


def look_around(
    trace: Trace, row: int, start: int, stop: int, safe: SafeDistance | None = None
) -> Proximity:
    """Measures an ego's proximity to all actors in rows ``start`` to ``stop`` (exclusive)."""
    safe = safe or SafeDistance()
    n = max(stop - start, 0)
    sizes = _sizes(trace)
    series = np.zeros((6, n))
    series[:2] = np.inf
    series[5] = -1.0
    states = np.ascontiguousarray(trace.states)
    present = np.ascontiguousarray(trace.present)
    gap, gap_row, gap_actor = _scan(
        states,
        present,
        sizes,
        row,
        start,
        stop,
        HORIZON,
        BEHIND,
        (safe.response_time, safe.acceleration, safe.own_braking, safe.other_braking),
        series,
    )
    limit = round(ENCROACHMENT_HORIZON / trace.step_length)
    every = max(round(ENCROACHMENT_STEP / trace.step_length), 1)
    lag, lag_row, lag_actor = _least_lag(
        states, present, sizes, row, start, stop, every, limit, CROSSING_ANGLE, gap <= 0.0
    )
    return Proximity(
        min_gap=None if math.isinf(gap) else gap,
        min_gap_row=gap_row,
        min_gap_actor=gap_actor,
        time_to_collision=series[0],
        time_to_collision_actor=series[5].astype(np.int32),
        forward_time_to_collision=series[1],
        drac=series[2],
        required_deceleration=series[3],
        rss_violated=series[4] > 0.0,
        post_encroachment_time=None if lag > limit else lag * trace.step_length,
        post_encroachment_row=lag_row - start if lag_row >= 0 else -1,
        post_encroachment_actor=lag_actor,
    )


def _sizes(trace: Trace) -> FloatArray:
    return np.array([(actor.length, actor.width) for actor in trace.actors], dtype=np.float64)


_Z = int(Col.Z)
_ROUNDING = 1e-6
"""Metres, and m/s, by which quick checks are wider than the exact ones."""


@compiled
def _gaps(
    states: FloatArray, present: BoolArray, first: int, second: int, sizes: FloatArray
) -> FloatArray:
    gaps = np.full(states.shape[0], np.nan)
    for t in range(states.shape[0]):
        if present[t, first] and present[t, second]:
            a, b = states[t, first], states[t, second]
            gaps[t] = box_gap(
                b[0] - a[0], b[1] - a[1],
                a[2], sizes[first, 0], sizes[first, 1],
                b[2], sizes[second, 0], sizes[second, 1],
            )  # fmt: skip
    return gaps


@compiled
def _scan(
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    row: int,
    start: int,
    stop: int,
    horizon: float,
    behind: float,
    safe: tuple[float, float, float, float],
    series: FloatArray,
) -> tuple[float, int, int]:
    """Fills ``series`` (6, n) and returns the least gap, its judged row, and its actor."""
    actors = states.shape[1]
    length, width = sizes[row, 0], sizes[row, 1]
    radius = 0.5 * math.hypot(length, width)
    least, least_row, least_actor = math.inf, -1, -1
    radii = 0.5 * np.hypot(sizes[:, 0], sizes[:, 1])
    for t in range(start, stop):
        if not present[t, row]:
            continue
        k = t - start
        ego = states[t, row]
        x, y, yaw, vx, vy = ego[0], ego[1], ego[2], ego[3], ego[4]
        cos, sin = math.cos(yaw), math.sin(yaw)
        forward = vx * cos + vy * sin
        for j in range(actors):
            if j == row or not present[t, j]:
                continue
            other = states[t, j]
            if abs(other[_Z] - ego[_Z]) > LEVEL_GAP:
                continue
            dx, dy = other[0] - x, other[1] - y
            dvx, dvy = other[3] - vx, other[4] - vy
            # Not more than the distance, and not less than the closing speed: most actors are too
            # far away for both, whose computation takes longer.
            away = max(abs(dx), abs(dy)) - radius - radii[j] - _ROUNDING
            in_time = (abs(dvx) + abs(dvy) + _ROUNDING) * min(horizon, series[1, k])
            clear = soonest = math.inf
            if away < least or away <= in_time:
                clear = math.hypot(dx, dy) - radius - radii[j]
                closing = math.hypot(dvx, dvy)
                if closing > 1e-9:
                    soonest = clear / closing
            if clear < least:
                gap = box_gap(dx, dy, yaw, length, width, other[2], sizes[j, 0], sizes[j, 1])
                if gap < least:
                    least, least_row, least_actor = gap, k, j
            if clear <= 0.0 or soonest < min(horizon, series[1, k]):
                time = time_to_contact(
                    dx, dy, dvx, dvy, yaw, length, width, other[2], sizes[j, 0], sizes[j, 1]
                )
                if time <= horizon:
                    if time < series[0, k]:
                        series[0, k], series[5, k] = time, j
                    bearing = abs(math.atan2(-dx * sin + dy * cos, dx * cos + dy * sin))
                    if bearing < behind:
                        series[1, k] = min(series[1, k], time)
            ahead = dx * cos + dy * sin
            if ahead > 0.0 and forward > 0.0:
                across = abs(-dx * sin + dy * cos)
                if across >= 0.5 * (width + sizes[j, 0] + sizes[j, 1]) + _ROUNDING:
                    continue
                c = abs(math.cos(other[2] - yaw))
                s = abs(math.sin(other[2] - yaw))
                if across >= 0.5 * (width + sizes[j, 0] * s + sizes[j, 1] * c):
                    continue
                room = ahead - 0.5 * (length + sizes[j, 0] * c + sizes[j, 1] * s)
                lead = max(other[3] * cos + other[4] * sin, 0.0)
                braking = max(-(other[5] * cos + other[6] * sin), 0.0)
                _keep_distance(k, room, forward, lead, braking, safe, series)
    return least, least_row, least_actor


@compiled
def _keep_distance(
    k: int,
    room: float,
    speed: float,
    lead: float,
    lead_braking: float,
    safe: tuple[float, float, float, float],
    series: FloatArray,
) -> None:
    """Updates DRAC, required deceleration and the safe-distance flag of row ``k``.

    Args:
        k: Row.
        room: Metres between the boxes along the ego's heading.
        speed: Speed of the ego along its heading, m/s.
        lead: Speed of the actor ahead along that heading, m/s; an oncoming actor counts as
            standing.
        lead_braking: Deceleration of the actor ahead, m/s², not negative.
        safe: ``SafeDistance`` as numbers.
        series: (6, n) rows 2, 3 and 4 are changed in place.
    """
    room = max(room, 0.0)
    closing = speed - lead
    drac = _ratio(closing**2, 2.0 * room) if closing > 0.0 else 0.0
    series[2, k] = max(series[2, k], drac)
    required = drac
    if lead_braking > 0.0 and lead > 0.0:
        # As fast as the actor ahead after 2 room / closing: if that is before it stands, match its
        # braking and remove the closing speed; else stop behind its stopping place.
        if closing > 0.0 and 2.0 * room * lead_braking <= closing * lead:
            required = drac + lead_braking
        else:
            required = _ratio(speed**2, 2.0 * room + lead**2 / lead_braking)
    series[3, k] = max(series[3, k], required)
    response, acceleration, own, other = safe
    reached = speed + response * acceleration
    needed_room = (
        speed * response
        + 0.5 * acceleration * response**2
        + reached**2 / (2.0 * own)
        - lead**2 / (2.0 * other)
    )
    if room < needed_room:
        series[4, k] = 1.0


@compiled
def _ratio(value: float, by: float) -> float:
    return value / by if by > 0.0 else math.inf


@compiled
def _least_lag(
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    row: int,
    start: int,
    stop: int,
    every: int,
    limit: int,
    crossing: float,
    touched: bool,
) -> tuple[int, int, int]:
    """Finds the least number of steps between two boxes being at the same place on crossing paths.

    For every place of the ego, searches along the other's path; if the other is far, the search
    skips the least number of steps in which it can come near, and places of the ego that it cannot
    reach either.

    Returns:
        The steps, ``limit + 1`` if there is no such place; the ego's row there; and the other
        actor. Both are -1 if there is none, and if ``touched``.
    """
    best = 0 if touched else limit + 1
    best_row, best_actor = -1, -1
    strides = _longest_steps(states, present, start, stop)
    for j in range(states.shape[1]):
        if j == row or best == 0:
            continue
        reach = 0.5 * (
            math.hypot(sizes[row, 0], sizes[row, 1]) + math.hypot(sizes[j, 0], sizes[j, 1])
        )
        stride = strides[j]
        following = start
        while following < stop:
            t = following
            following += every
            if present[t, row] and present[t, j]:
                room = (
                    math.hypot(states[t, j, 0] - states[t, row, 0],
                               states[t, j, 1] - states[t, row, 1])
                    - reach - stride * best - _ROUNDING
                )  # fmt: skip
                if room >= 0.0:
                    # Neither at this place nor at those that the ego is at before they have closed
                    # the room between them.
                    following += every * int(room / ((strides[row] + stride) * every))
                    continue
            for direction in (1, -1):
                lag = 0
                while lag < best:
                    u = t + direction * lag
                    if u < start or u >= stop:
                        break
                    if not present[u, j] or not present[t, row]:
                        lag += 1
                        continue
                    ego, other = states[t, row], states[u, j]
                    dx, dy = other[0] - ego[0], other[1] - ego[1]
                    away = math.hypot(dx, dy) - reach
                    if away > 0.0:
                        if stride * (best - lag) <= away:
                            break
                        lag += max(1, int(away / stride))
                        continue
                    turn = wrap_to_pi(other[2] - ego[2])
                    level = abs(other[_Z] - ego[_Z]) <= LEVEL_GAP
                    if level and abs(turn) >= crossing and (
                        overlap_depth(
                            dx, dy, ego[2], sizes[row, 0], sizes[row, 1],
                            other[2], sizes[j, 0], sizes[j, 1],
                        ) > 0.0
                    ):  # fmt: skip
                        best, best_row, best_actor = lag, t, j
                        break
                    lag += 1
    return best, best_row, best_actor


@compiled
def _longest_steps(states: FloatArray, present: BoolArray, start: int, stop: int) -> FloatArray:
    """Returns the (N,) longest step of each actor between two rows, metres; at least 1e-6."""
    longest = np.full(states.shape[1], 1e-6)
    last = np.full(states.shape[1], -1)
    for t in range(start, stop):
        for j in range(states.shape[1]):
            if not present[t, j]:
                continue
            if last[j] >= 0:
                dx = states[t, j, 0] - states[last[j], j, 0]
                dy = states[t, j, 1] - states[last[j], j, 1]
                # The exact length takes longer; it is needed where it may be the longest.
                if dx * dx + dy * dy > (1.0 - 1e-9) * longest[j] * longest[j]:
                    longest[j] = max(longest[j], math.hypot(dx, dy))
            last[j] = t
    return longest
