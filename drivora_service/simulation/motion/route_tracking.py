"""Tracking of the egos on their routes: distance, next signal, time stuck, arrival."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import TerminalEvent

STUCK_SPEED = 0.1
STUCK_AFTER = 60.0
"""Seconds below ``STUCK_SPEED`` after which an ego counts as stuck (Bench2Drive), unless the
scenario sets another."""
FAR = 30.0
"""Metres from the route at which an ego has deviated (CARLA Leaderboard)."""
BESIDE = 15.0
"""Metres from the route from which on an ego is beside it (CARLA Leaderboard)."""
BESIDE_SHARE = 0.3
"""Share of the route's length which an ego may drive beside it (CARLA Leaderboard)."""
ARRIVED_SHARE = 0.99
ARRIVED_DISTANCE = 10.0
ENDS = (
    None,
    TerminalEvent.ARRIVED,
    TerminalEvent.STUCK,
    TerminalEvent.TIME_LIMIT,
    TerminalEvent.ROUTE_DEVIATION,
)
"""The events for the codes that ``follow_egos`` writes."""
QUEUE_REACH = 100.0
"""A standing ego with a red signal at most this many metres ahead is waiting, not stuck."""
PERMISSIVE = 4
"""Code of a green signal whose traffic yields to others with priority."""
_SEARCH_BEHIND = 5
_SEARCH_AHEAD = 5.0
"""Metres by which the progress may exceed the distance driven since the last frame: a
route that passes the same place twice, such as a lap or a return, is not cut short."""


class Progress(IntEnum):
    """Columns of ``progress``: an ego on its route at the last tracked frame."""

    CURSOR = 0
    """Last segment on the route, relative to its beginning."""
    STUCK = 1
    """Seconds stuck."""
    TIME_LIMIT = 2
    """Time limit in seconds, extended by the time waited at signals."""
    ROUTE_S = 3
    """Metres along the route; NaN before the start."""
    ROUTE_LATERAL = 4
    """Metres beside the route, positive to the left; NaN before the start."""
    LIGHT = 5
    """``Light`` of the next signal."""
    PROTECTED = 6
    """1 if that signal is green with the right of way."""
    LIGHT_DISTANCE = 7
    """Metres from the front bumper to its stop line; inf where there is none."""
    SPEED_LIMIT = 8
    """m/s."""
    STUCK_AFTER = 9
    """Seconds stuck after which its part ends."""
    BESIDE = 10
    """Metres driven beside the route."""


# The columns as plain integers, which compiled functions use as indices.
_CURSOR, _STUCK, _TIME_LIMIT, _ROUTE_S, _ROUTE_LATERAL = (int(c) for c in tuple(Progress)[:5])
_LIGHT, _PROTECTED, _LIGHT_DISTANCE, _SPEED_LIMIT = (int(c) for c in tuple(Progress)[5:9])
_STUCK_AFTER, _BESIDE = int(Progress.STUCK_AFTER), int(Progress.BESIDE)


@compiled
def _code_shown(signal: FloatArray, time: float) -> int:
    stages = (signal.shape[0] - 2) // 2
    ends, codes = signal[2 : 2 + stages], signal[2 + stages :]
    in_cycle = (time - signal[1] + 1e-9) % ends[stages - 1]
    for p in range(stages):
        if in_cycle < ends[p]:
            return int(codes[p])
    return int(codes[stages - 1])


@compiled
def follow_egos(
    time: float,
    dt: float,
    frame: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    bodies: FloatArray,
    active: BoolArray,
    points: FloatArray,
    signals: FloatArray,
    parts: IntArray,
    progress: FloatArray,
    values: FloatArray,
    lights: ByteArray,
    ends: IntArray,
) -> int:
    """Tracks every active ego along its route.

    Args:
        time: Seconds of this frame.
        dt: Step length, seconds.
        frame: (N, 9) this frame; the egos' heights are filled.
        present: (N,) of this frame.
        sizes: (N, 2) metres.
        bodies: (M, 10); their heights are filled too.
        active: (M,) egos that are driving.
        points, signals, parts: As in ``arrays.RouteArrays``.
        progress: (M, 11), columns ``Progress``; changed in place.
        values: (M, 8) of this frame, columns ``EgoCol``; changed in place.
        lights: (M,) ``Light`` of the next signal; changed in place.
        ends: (M,) filled with indices into ``ENDS``.

    Returns:
        The number of egos whose parts end with this frame.
    """
    ended = 0
    for m in range(active.shape[0]):
        ends[m] = 0
        if not active[m]:
            continue
        if not present[m]:
            # SUMO removes its vehicles at the end of their last edge, beyond the goal.
            ends[m] = 1
            ended += 1
            continue
        mine, route = progress[m], points[parts[m, 0] : parts[m, 1]]
        x, y = frame[m, 0], frame[m, 1]
        speed = math.hypot(frame[m, 3], frame[m, 4])
        before = int(mine[_CURSOR])
        ahead = 1
        furthest = route[before, 2] + speed * dt + _SEARCH_AHEAD
        while before + ahead < route.shape[0] - 1 and route[before + ahead, 2] < furthest:
            ahead += 1
        cursor, s, lateral = track_line(
            route[:, :2], route[:, 2], before, _SEARCH_BEHIND, ahead, x, y
        )
        frame[m, 8] = route[cursor, 3]
        bodies[m, 8] = route[cursor, 3]
        mine[_CURSOR] = cursor
        mine[_ROUTE_S] = s
        mine[_ROUTE_LATERAL] = lateral
        mine[_SPEED_LIMIT] = route[cursor, 4]
        _look_for_signal(time, s, 0.5 * sizes[m, 0], signals[parts[m, 2] : parts[m, 3]], mine)
        values[m, 2] = s
        values[m, 3] = lateral
        values[m, 7] = mine[_LIGHT_DISTANCE] if mine[_LIGHT_DISTANCE] < np.inf else np.nan
        lights[m] = int(mine[_LIGHT])
        if abs(lateral) > BESIDE:
            mine[_BESIDE] += speed * dt
        if speed >= STUCK_SPEED:
            mine[_STUCK] = 0.0
        elif not (mine[_LIGHT] >= 2.0 and mine[_LIGHT_DISTANCE] < QUEUE_REACH):
            mine[_STUCK] += dt
        else:
            # Waiting at signals does not count towards the time limit.
            mine[_TIME_LIMIT] += dt
        last = route[route.shape[0] - 1]
        goal = math.hypot(x - last[0], y - last[1])
        if s > ARRIVED_SHARE * last[2] and goal < ARRIVED_DISTANCE:
            ends[m] = 1
        elif abs(lateral) > FAR or mine[_BESIDE] > BESIDE_SHARE * last[2]:
            ends[m] = 4
        elif mine[_STUCK] >= mine[_STUCK_AFTER] - 1e-9:
            ends[m] = 2
        elif time >= mine[_TIME_LIMIT]:
            ends[m] = 3
        if ends[m] > 0:
            ended += 1
    return ended


@compiled
def _look_for_signal(
    time: float, s: float, half_length: float, signals: FloatArray, mine: FloatArray
) -> None:
    """Writes the next signal on the route into an ego's row of ``progress``."""
    mine[_LIGHT] = 0.0
    mine[_PROTECTED] = 0.0
    mine[_LIGHT_DISTANCE] = np.inf
    for i in range(signals.shape[0]):
        if s - half_length <= signals[i, 0]:
            code = _code_shown(signals[i], time)
            mine[_LIGHT] = 1.0 if code == PERMISSIVE else float(code)
            mine[_PROTECTED] = 1.0 if code == 1 else 0.0
            mine[_LIGHT_DISTANCE] = signals[i, 0] - (s + half_length)
            return
