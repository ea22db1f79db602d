"""Tracking of the egos on their routes: distance, next signal, time stuck, arrival."""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray, IntArray
from drivora_service.networks.routes.line_tracking import track_line
from drivora_service.observations.trace import Col, EgoCol, Light, SizeCol, TerminalEvent
from drivora_service.simulation.motion.vehicle_dynamics import Body
from drivora_service.simulation.world import WorldFrames

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


class PartEnd(IntEnum):
    """Why an ego's part ends with a frame."""

    NONE = 0
    """It does not."""
    ARRIVED = 1
    STUCK = 2
    TIME_LIMIT = 3
    ROUTE_DEVIATION = 4


ENDS = (
    None,
    TerminalEvent.ARRIVED,
    TerminalEvent.STUCK,
    TerminalEvent.TIME_LIMIT,
    TerminalEvent.ROUTE_DEVIATION,
)
"""The events of ``PartEnd``, in order."""
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


class RouteCol(IntEnum):
    """Columns of ``RouteArrays.points``; metres, m/s."""

    X = 0
    Y = 1
    ARC = 2
    HEIGHT = 3
    SPEED_LIMIT = 4


class SignalCol(IntEnum):
    """First columns of ``RouteArrays.signals``."""

    STOP_LINE = 0
    """Arc length of the stop line on the route, metres; ascending."""
    OFFSET = 1
    """Offset of the programme, seconds."""
    STAGES = 2
    """The first of the columns of the stages."""


class PartCol(IntEnum):
    """Columns of ``RouteArrays.parts``: rows of an ego in ``points`` and in ``signals``."""

    BEGIN = 0
    END = 1
    SIGNALS_BEGIN = 2
    SIGNALS_END = 3


class RouteArrays(NamedTuple):
    """The egos' routes and signals, concatenated.

    Attributes:
        points: (n, 5) points of all reference lines, columns ``RouteCol``.
        signals: (S, 2 + 2 p) columns ``SignalCol``; then the ends of the p stages within the cycle,
            padded with the cycle; then the state of each stage: ``Light`` or ``PERMISSIVE``.
        parts: (M, 4), columns ``PartCol``.
    """

    points: FloatArray
    signals: FloatArray
    parts: IntArray


class EgoProgress(NamedTuple):
    """The egos on their routes.

    Attributes:
        bodies: (M, 10), columns ``Body``.
        active: (M,) egos that are driving.
        progress: (M, 11), columns ``Progress``.
        values: (capacity, M, 8) of the frames, columns ``EgoCol``.
        lights: (capacity, M) of the frames, ``Light`` of the next signal.
        ends: (M,) ``PartEnd`` of the last frame.
    """

    bodies: FloatArray
    active: BoolArray
    progress: FloatArray
    values: FloatArray
    lights: ByteArray
    ends: IntArray


# As the numbers in the columns: a compiled function compares no enum with a float.
_NO_LIGHT, _GREEN, _YELLOW = float(Light.NONE), float(Light.GREEN), float(Light.YELLOW)


@compiled
def _code_shown(signal: FloatArray, time: float) -> int:
    """Returns ``Light`` or ``PERMISSIVE`` of a signal at a time, seconds."""
    stages = (signal.shape[0] - SignalCol.STAGES) // 2
    codes_from = SignalCol.STAGES + stages
    ends, codes = signal[SignalCol.STAGES : codes_from], signal[codes_from:]
    # A stage begins with the frame at its time, although the product of step and length may be a
    # rounding error below it.
    in_cycle = (time - signal[SignalCol.OFFSET] + 1e-9) % ends[stages - 1]
    for p in range(stages):
        if in_cycle < ends[p]:
            return int(codes[p])
    return int(codes[stages - 1])


@compiled
def follow_egos(
    step: int,
    time: float,
    dt: float,
    frames: WorldFrames,
    egos: EgoProgress,
    routes: RouteArrays,
) -> int:
    """Tracks every active ego along its route.

    Args:
        step: Index of the frame.
        time: Seconds of the frame.
        dt: Step length, seconds.
        frames: All frames; the egos' heights are filled in that of the step.
        egos: Changed in place: progress, ends, heights of the bodies, values and lights of the
            step.
        routes: The routes.

    Returns:
        The number of egos whose parts end with this frame.
    """
    frame, present, sizes = frames.states[step], frames.present[step], frames.sizes
    bodies, active, progress, ends = egos.bodies, egos.active, egos.progress, egos.ends
    values, lights = egos.values[step], egos.lights[step]
    points, signals, parts = routes.points, routes.signals, routes.parts
    ended = 0
    for m in range(active.shape[0]):
        ends[m] = PartEnd.NONE
        if not active[m]:
            continue
        if not present[m]:
            # SUMO removes its vehicles at the end of their last edge, beyond the goal.
            ends[m] = PartEnd.ARRIVED
            ended += 1
            continue
        mine, part = progress[m], parts[m]
        route = points[part[PartCol.BEGIN] : part[PartCol.END]]
        x, y = frame[m, Col.X], frame[m, Col.Y]
        speed = math.hypot(frame[m, Col.VX], frame[m, Col.VY])
        before = int(mine[Progress.CURSOR])
        ahead = 1
        furthest = route[before, RouteCol.ARC] + speed * dt + _SEARCH_AHEAD
        while (
            before + ahead < route.shape[0] - 1 and route[before + ahead, RouteCol.ARC] < furthest
        ):
            ahead += 1
        cursor, s, lateral = track_line(
            route[:, : RouteCol.ARC], route[:, RouteCol.ARC], before, _SEARCH_BEHIND, ahead, x, y
        )
        frame[m, Col.Z] = route[cursor, RouteCol.HEIGHT]
        bodies[m, Body.HEIGHT] = route[cursor, RouteCol.HEIGHT]
        mine[Progress.CURSOR] = cursor
        mine[Progress.ROUTE_S] = s
        mine[Progress.ROUTE_LATERAL] = lateral
        mine[Progress.SPEED_LIMIT] = route[cursor, RouteCol.SPEED_LIMIT]
        ahead_of = signals[part[PartCol.SIGNALS_BEGIN] : part[PartCol.SIGNALS_END]]
        _look_for_signal(time, s, 0.5 * sizes[m, SizeCol.LENGTH], ahead_of, mine)
        values[m, EgoCol.ROUTE_S] = s
        values[m, EgoCol.ROUTE_LATERAL] = lateral
        to_line = mine[Progress.LIGHT_DISTANCE]
        values[m, EgoCol.LIGHT_DISTANCE] = to_line if to_line < np.inf else np.nan
        lights[m] = int(mine[Progress.LIGHT])
        if abs(lateral) > BESIDE:
            mine[Progress.BESIDE] += speed * dt
        if speed >= STUCK_SPEED:
            mine[Progress.STUCK] = 0.0
        elif not (mine[Progress.LIGHT] >= _YELLOW and to_line < QUEUE_REACH):
            mine[Progress.STUCK] += dt
        else:
            # Waiting at signals does not count towards the time limit.
            mine[Progress.TIME_LIMIT] += dt
        last = route[route.shape[0] - 1]
        goal = math.hypot(x - last[RouteCol.X], y - last[RouteCol.Y])
        if s > ARRIVED_SHARE * last[RouteCol.ARC] and goal < ARRIVED_DISTANCE:
            ends[m] = PartEnd.ARRIVED
        elif abs(lateral) > FAR or mine[Progress.BESIDE] > BESIDE_SHARE * last[RouteCol.ARC]:
            ends[m] = PartEnd.ROUTE_DEVIATION
        elif mine[Progress.STUCK] >= mine[Progress.STUCK_AFTER] - 1e-9:
            ends[m] = PartEnd.STUCK
        elif time >= mine[Progress.TIME_LIMIT]:
            ends[m] = PartEnd.TIME_LIMIT
        if ends[m] != PartEnd.NONE:
            ended += 1
    return ended


@compiled
def _look_for_signal(
    time: float, s: float, half_length: float, signals: FloatArray, mine: FloatArray
) -> None:
    """Writes the next signal on the route into an ego's row of ``progress``."""
    mine[Progress.LIGHT] = _NO_LIGHT
    mine[Progress.PROTECTED] = 0.0
    mine[Progress.LIGHT_DISTANCE] = np.inf
    for i in range(signals.shape[0]):
        if s - half_length <= signals[i, SignalCol.STOP_LINE]:
            code = _code_shown(signals[i], time)
            mine[Progress.LIGHT] = _GREEN if code == PERMISSIVE else float(code)
            mine[Progress.PROTECTED] = 1.0 if code == Light.GREEN else 0.0
            mine[Progress.LIGHT_DISTANCE] = signals[i, SignalCol.STOP_LINE] - (s + half_length)
            return
