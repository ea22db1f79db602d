"""Proximity of an ego to other actors: gaps, time to collision, required braking, encroachment.

Times to collision assume that both boxes keep their velocity and heading (exact in time; nuPlan
samples the same model every 0.1 s). Braking and safe distances concern actors ahead, whose box
overlaps the strip that the ego's width sweeps along its heading. Actors on another level of a
bridge do not count.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, Int32Array
from drivora_service.geometry.boxes import box_gap, overlap_depth, time_to_contact
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.trace import LEVEL_GAP, Col, SizeCol, Trace

HORIZON = 10.0
"""Maximum computed time to collision, seconds."""

ENCROACHMENT_HORIZON = 5.0
"""Maximum computed post-encroachment time, seconds."""

ENCROACHMENT_STEP = 0.1
"""Seconds between the ego's places for the search for encroachments: an ego of 4.5 m below 45 m/s
covers with its boxes at these places all of its path."""

BEHIND = math.radians(150.0)
"""Bearing from which on an actor is behind the ego (nuPlan), radians."""

CROSSING_ANGLE = math.radians(30.0)
"""Difference of headings from which on paths cross, radians; below, one actor follows the other."""


class SafeDistance(NamedTuple):
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


class _Actors(NamedTuple):
    """All actors of a trace, for the kernels.

    Attributes:
        states: (T, N, 9), columns ``Col``.
        present: (T, N) flags.
        sizes: (N, 2), columns ``SizeCol``.
    """

    states: FloatArray
    present: BoolArray
    sizes: FloatArray


class _Series(NamedTuple):
    """The series of ``Proximity``, which the scan fills actor by actor."""

    time_to_collision: FloatArray
    time_to_collision_actor: Int32Array
    forward_time_to_collision: FloatArray
    drac: FloatArray
    required_deceleration: FloatArray
    rss_violated: BoolArray


def gaps_between(trace: Trace, first: int, second: int) -> FloatArray:
    """Returns the (T,) distance between two actors' boxes in metres, NaN if one is absent."""
    return _gaps(_Actors(trace.states, trace.present, _sizes(trace)), first, second)


def look_around(
    trace: Trace, row: int, start: int, stop: int, safe: SafeDistance | None = None
) -> Proximity:
    """Measures an ego's proximity to all actors in rows ``start`` to ``stop`` (exclusive)."""
    n = max(stop - start, 0)
    series = _Series(
        time_to_collision=np.full(n, np.inf),
        time_to_collision_actor=np.full(n, -1, dtype=np.int32),
        forward_time_to_collision=np.full(n, np.inf),
        drac=np.zeros(n),
        required_deceleration=np.zeros(n),
        rss_violated=np.zeros(n, dtype=np.bool_),
    )
    actors = _Actors(
        np.ascontiguousarray(trace.states), np.ascontiguousarray(trace.present), _sizes(trace)
    )
    gap, gap_row, gap_actor = _scan(actors, row, start, stop, safe or SafeDistance(), series)
    limit = round(ENCROACHMENT_HORIZON / trace.step_length)
    every = max(round(ENCROACHMENT_STEP / trace.step_length), 1)
    lag, lag_row, lag_actor = _least_lag(actors, row, start, stop, every, limit, gap <= 0.0)
    return Proximity(
        min_gap=None if math.isinf(gap) else gap,
        min_gap_row=gap_row,
        min_gap_actor=gap_actor,
        **series._asdict(),
        post_encroachment_time=None if lag > limit else lag * trace.step_length,
        post_encroachment_row=lag_row - start if lag_row >= 0 else -1,
        post_encroachment_actor=lag_actor,
    )


def _sizes(trace: Trace) -> FloatArray:
    return np.array([(actor.length, actor.width) for actor in trace.actors], dtype=np.float64)


_ROUNDING = 1e-6
"""Metres, and m/s, by which quick checks are wider than the exact ones."""


@compiled
def _gaps(actors: _Actors, first: int, second: int) -> FloatArray:
    states, present, sizes = actors
    gaps = np.full(states.shape[0], np.nan)
    for t in range(states.shape[0]):
        if present[t, first] and present[t, second]:
            a, b = states[t, first], states[t, second]
            gaps[t] = box_gap(
                b[Col.X] - a[Col.X], b[Col.Y] - a[Col.Y],
                a[Col.YAW], sizes[first, SizeCol.LENGTH], sizes[first, SizeCol.WIDTH],
                b[Col.YAW], sizes[second, SizeCol.LENGTH], sizes[second, SizeCol.WIDTH],
            )  # fmt: skip
    return gaps


@compiled
def _scan(
    actors: _Actors, row: int, start: int, stop: int, safe: SafeDistance, series: _Series
) -> tuple[float, int, int]:
    """Fills ``series`` and returns the least gap, its judged row, and its actor."""
    states, present, sizes = actors
    length, width = sizes[row, SizeCol.LENGTH], sizes[row, SizeCol.WIDTH]
    radius = 0.5 * math.hypot(length, width)
    least, least_row, least_actor = math.inf, -1, -1
    radii = 0.5 * np.hypot(sizes[:, SizeCol.LENGTH], sizes[:, SizeCol.WIDTH])
    for t in range(start, stop):
        if not present[t, row]:
            continue
        k = t - start
        ego = states[t, row]
        x, y, yaw, vx, vy = ego[Col.X], ego[Col.Y], ego[Col.YAW], ego[Col.VX], ego[Col.VY]
        cos, sin = math.cos(yaw), math.sin(yaw)
        forward = vx * cos + vy * sin
        for j in range(states.shape[1]):
            if j == row or not present[t, j]:
                continue
            other = states[t, j]
            if abs(other[Col.Z] - ego[Col.Z]) > LEVEL_GAP:
                continue
            other_length, other_width = sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH]
            dx, dy = other[Col.X] - x, other[Col.Y] - y
            dvx, dvy = other[Col.VX] - vx, other[Col.VY] - vy
            # Bounds instead of the exact values, which take longer and change nothing for most
            # actors. A box is within the circle around it, so the gap of two boxes is at least that
            # of their circles, and no contact is sooner than the circles' at the relative speed.
            # The larger coordinate is at most the distance, and the sum of both at least the speed.
            # A contact later than the forward one changes neither time: the forward one is that of
            # fewer actors, and so the later of the two.
            away = max(abs(dx), abs(dy)) - radius - radii[j] - _ROUNDING
            latest = min(HORIZON, series.forward_time_to_collision[k])
            in_time = (abs(dvx) + abs(dvy) + _ROUNDING) * latest
            clear = soonest = math.inf
            if away < least or away <= in_time:
                clear = math.hypot(dx, dy) - radius - radii[j]
                closing = math.hypot(dvx, dvy)
                if closing > 1e-9:
                    soonest = clear / closing
            if clear < least:
                gap = box_gap(dx, dy, yaw, length, width, other[Col.YAW], other_length, other_width)
                if gap < least:
                    least, least_row, least_actor = gap, k, j
            if clear <= 0.0 or soonest < latest:
                time = time_to_contact(
                    dx, dy, dvx, dvy, yaw, length, width, other[Col.YAW], other_length, other_width
                )
                if time <= HORIZON:
                    if time < series.time_to_collision[k]:
                        series.time_to_collision[k] = time
                        series.time_to_collision_actor[k] = j
                    bearing = abs(math.atan2(-dx * sin + dy * cos, dx * cos + dy * sin))
                    if bearing < BEHIND:
                        series.forward_time_to_collision[k] = min(
                            series.forward_time_to_collision[k], time
                        )
            ahead = dx * cos + dy * sin
            if ahead > 0.0 and forward > 0.0:
                # In the ego's strip if half their extents across its heading together reach further
                # than their centres are apart. At any angle that of the other is at most half its
                # length and width: for most actors no angle is needed.
                across = abs(-dx * sin + dy * cos)
                if across >= 0.5 * (width + other_length + other_width) + _ROUNDING:
                    continue
                c = abs(math.cos(other[Col.YAW] - yaw))
                s = abs(math.sin(other[Col.YAW] - yaw))
                if across >= 0.5 * (width + other_length * s + other_width * c):
                    continue
                room = ahead - 0.5 * (length + other_length * c + other_width * s)
                lead = max(other[Col.VX] * cos + other[Col.VY] * sin, 0.0)
                braking = max(-(other[Col.AX] * cos + other[Col.AY] * sin), 0.0)
                _keep_distance(k, room, forward, lead, braking, safe, series)
    return least, least_row, least_actor


@compiled
def _keep_distance(
    k: int,
    room: float,
    speed: float,
    lead: float,
    lead_braking: float,
    safe: SafeDistance,
    series: _Series,
) -> None:
    """Updates DRAC, required deceleration and the safe-distance flag of row ``k``.

    Args:
        k: Row.
        room: Metres between the boxes along the ego's heading.
        speed: Speed of the ego along its heading, m/s.
        lead: Speed of the actor ahead along that heading, m/s; an oncoming actor counts as
            standing.
        lead_braking: Deceleration of the actor ahead, m/s², not negative.
        safe: Parameters of the safe distance.
        series: Changed in place.
    """
    room = max(room, 0.0)
    closing = speed - lead
    # DRAC, deceleration rate to avoid a crash (Almqvist, Hydén and Risser 1991): braking at a takes
    # closing² / 2a metres to remove the closing speed, of an actor ahead that keeps its speed.
    drac = _ratio(closing**2, 2.0 * room) if closing > 0.0 else 0.0
    series.drac[k] = max(series.drac[k], drac)
    required = drac
    if lead_braking > 0.0 and lead > 0.0:
        # In the frame of an actor ahead that brakes at b, braking at a removes the closing speed at
        # a - b, so that a = b + drac, in 2 room / closing seconds. This holds if the actor ahead,
        # which stands after lead / b seconds, still moves then. Otherwise the ego has to stop
        # behind the place where it stands: within room + lead² / 2b metres.
        if closing > 0.0 and 2.0 * room * lead_braking <= closing * lead:
            required = drac + lead_braking
        else:
            required = _ratio(speed**2, 2.0 * room + lead**2 / lead_braking)
    series.required_deceleration[k] = max(series.required_deceleration[k], required)
    # RSS, definition 1: the worst case in which the ego gains speed for the response time and then
    # brakes weakly, while the actor ahead brakes strongly at once.
    reached = speed + safe.response_time * safe.acceleration
    needed_room = (
        speed * safe.response_time
        + 0.5 * safe.acceleration * safe.response_time**2
        + reached**2 / (2.0 * safe.own_braking)
        - lead**2 / (2.0 * safe.other_braking)
    )
    if room < needed_room:
        series.rss_violated[k] = True


@compiled
def _ratio(value: float, by: float) -> float:
    return value / by if by > 0.0 else math.inf


@compiled
def _least_lag(
    actors: _Actors, row: int, start: int, stop: int, every: int, limit: int, touched: bool
) -> tuple[int, int, int]:
    """Finds the least number of steps between two boxes being at the same place on crossing paths.

    This is the post-encroachment time (Allen, Shin and Cooper 1978) without a given conflict area:
    the place is any where the ego's box at one row overlaps the other's box at another row. For
    every place of the ego, the rows of the other are searched forwards and backwards, since either
    may have been there first.

    Args:
        actors: All actors.
        row: The ego.
        start: First row.
        stop: Row behind the last.
        every: Rows from one place of the ego to the next that is compared.
        limit: Largest number of steps.
        touched: Whether boxes touch, so that the least number is 0.

    Returns:
        The steps, ``limit + 1`` if there is no such place; the ego's row there; and the other
        actor. Both are -1 if there is none, and if ``touched``.
    """
    states, present, sizes = actors
    best = 0 if touched else limit + 1
    best_row, best_actor = -1, -1
    # No actor gets further in a step than its stride, so that it needs at least gap / stride steps
    # to close a gap. All that follows from this bound is skipped: most actors are never near.
    strides = _longest_steps(states, present, start, stop)
    length, width = sizes[row, SizeCol.LENGTH], sizes[row, SizeCol.WIDTH]
    for j in range(states.shape[1]):
        if j == row or best == 0:
            continue
        other_length, other_width = sizes[j, SizeCol.LENGTH], sizes[j, SizeCol.WIDTH]
        reach = 0.5 * (math.hypot(length, width) + math.hypot(other_length, other_width))
        stride = strides[j]
        following = start
        while following < stop:
            t = following
            following += every
            if present[t, row] and present[t, j]:
                room = (
                    math.hypot(states[t, j, Col.X] - states[t, row, Col.X],
                               states[t, j, Col.Y] - states[t, row, Col.Y])
                    - reach - stride * best - _ROUNDING
                )  # fmt: skip
                if room >= 0.0:
                    # In fewer than the best number of steps the other reaches neither this place
                    # nor those that the ego is at before they have closed the room between them.
                    following += every * int(room / ((strides[row] + stride) * every))
                    continue
            for direction in (1, -1):
                lag = 0
                # Only fewer steps than the best improve it: each find makes the search shorter.
                while lag < best:
                    u = t + direction * lag
                    if u < start or u >= stop:
                        break
                    if not present[u, j] or not present[t, row]:
                        lag += 1
                        continue
                    ego, other = states[t, row], states[u, j]
                    dx, dy = other[Col.X] - ego[Col.X], other[Col.Y] - ego[Col.Y]
                    away = math.hypot(dx, dy) - reach
                    if away > 0.0:
                        if stride * (best - lag) <= away:
                            break
                        lag += max(1, int(away / stride))
                        continue
                    turn = wrap_to_pi(other[Col.YAW] - ego[Col.YAW])
                    level = abs(other[Col.Z] - ego[Col.Z]) <= LEVEL_GAP
                    if level and abs(turn) >= CROSSING_ANGLE and (
                        overlap_depth(
                            dx, dy, ego[Col.YAW], length, width,
                            other[Col.YAW], other_length, other_width,
                        ) > 0.0
                    ):  # fmt: skip
                        best, best_row, best_actor = lag, t, j
                        break
                    lag += 1
    return best, best_row, best_actor


@compiled
def _longest_steps(states: FloatArray, present: BoolArray, start: int, stop: int) -> FloatArray:
    """Returns the (N,) longest step of each actor between two rows, metres; at least 1e-6.

    A break in its presence counts as one step: too long is a bound, too, and slower only.
    """
    longest = np.full(states.shape[1], 1e-6)
    last = np.full(states.shape[1], -1)
    for t in range(start, stop):
        for j in range(states.shape[1]):
            if not present[t, j]:
                continue
            if last[j] >= 0:
                dx = states[t, j, Col.X] - states[last[j], j, Col.X]
                dy = states[t, j, Col.Y] - states[last[j], j, Col.Y]
                # The exact length takes longer; it is needed where it may be the longest.
                if dx * dx + dy * dy > (1.0 - 1e-9) * longest[j] * longest[j]:
                    longest[j] = max(longest[j], math.hypot(dx, dy))
            last[j] = t
    return longest
