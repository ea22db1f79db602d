"""What happens to all actors between two frames, besides the models that move them.

SI units, radians, box centres; columns as in ``observations.trace``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drivora_service.compilation import compiled
from drivora_service.networks.line_tracking import track_line
from drivora_service.observations.trace import TerminalEvent

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ByteArray = NDArray[np.uint8]

STUCK_SPEED = 0.1
STUCK_AFTER = 60.0
"""Seconds below ``STUCK_SPEED`` after which an ego counts as stuck (Bench2Drive)."""
ARRIVED_SHARE = 0.99
ARRIVED_DISTANCE = 10.0
ENDS = (None, TerminalEvent.ARRIVED, TerminalEvent.STUCK, TerminalEvent.TIME_LIMIT)
"""What the codes mean that ``follow_egos`` writes."""
QUEUE_REACH = 100.0
"""A standing ego with a red signal at most this many metres ahead is waiting, not stuck."""
PERMISSIVE = 4
"""Code of a green signal whose traffic yields to others with priority."""
_SEARCH_BEHIND = 5
_SEARCH_AHEAD = 40


@compiled
def begin_frame(
    frame: FloatArray,
    present: BoolArray,
    next_frame: FloatArray,
    next_present: BoolArray,
    static: BoolArray,
) -> None:
    """Starts the next frame: static actors stay, others are absent until someone writes them."""
    for j in range(frame.shape[0]):
        keep = static[j] and present[j]
        next_present[j] = keep
        for k in range(next_frame.shape[1]):
            next_frame[j, k] = frame[j, k] if keep else np.nan


@compiled
def write_egos(
    bodies: FloatArray,
    in_world: BoolArray,
    next_frame: FloatArray,
    next_present: BoolArray,
) -> None:
    """Writes the egos' poses and velocities from their bodies."""
    for m in range(bodies.shape[0]):
        next_present[m] = in_world[m]
        if not in_world[m]:
            continue
        x, y, yaw, v, side = bodies[m, 0], bodies[m, 1], bodies[m, 2], bodies[m, 3], bodies[m, 4]
        cos, sin = math.cos(yaw), math.sin(yaw)
        next_frame[m, 0] = x
        next_frame[m, 1] = y
        next_frame[m, 2] = yaw
        next_frame[m, 3] = v * cos - side * sin
        next_frame[m, 4] = v * sin + side * cos
        next_frame[m, 8] = bodies[m, 8]


@compiled
def write_placements(
    frame: FloatArray,
    present: BoolArray,
    next_frame: FloatArray,
    next_present: BoolArray,
    sizes: FloatArray,
    is_moved: BoolArray,
    known: BoolArray,
    placements: FloatArray,
) -> int:
    """Writes what SUMO is told of each moved row.

    Args:
        frame: (N, 9) this frame.
        present: (N,) of this frame.
        next_frame: (N, 9) next frame.
        next_present: (N,) of the next frame.
        sizes: (N, 2) metres.
        is_moved: (N,) rows that the service moves.
        known: (N,) rows that SUMO knows of.
        placements: (N, 4) filled: front bumper x, y, SUMO's angle, 1.0 if the pose changed.

    Returns:
        How many moved rows enter or leave with the next frame.
    """
    changes = 0
    for j in range(next_frame.shape[0]):
        if not is_moved[j]:
            continue
        if next_present[j] != known[j]:
            changes += 1
        if not next_present[j]:
            continue
        x, y, yaw = next_frame[j, 0], next_frame[j, 1], next_frame[j, 2]
        half = 0.5 * sizes[j, 0]
        placements[j, 0] = x + half * math.cos(yaw)
        placements[j, 1] = y + half * math.sin(yaw)
        placements[j, 2] = (90.0 - math.degrees(yaw)) % 360.0
        same = present[j] and frame[j, 0] == x and frame[j, 1] == y and frame[j, 2] == yaw
        placements[j, 3] = 0.0 if same else 1.0
    return changes


@compiled
def write_rates(
    frame: FloatArray,
    present: BoolArray,
    next_frame: FloatArray,
    next_present: BoolArray,
    dt: float,
) -> None:
    """Writes accelerations and yaw rates as differences; 0 on first appearance."""
    for j in range(next_frame.shape[0]):
        if not next_present[j]:
            for k in range(next_frame.shape[1]):
                next_frame[j, k] = np.nan
            continue
        if not present[j]:
            next_frame[j, 5] = 0.0
            next_frame[j, 6] = 0.0
            next_frame[j, 7] = 0.0
            continue
        next_frame[j, 5] = (next_frame[j, 3] - frame[j, 3]) / dt
        next_frame[j, 6] = (next_frame[j, 4] - frame[j, 4]) / dt
        turn = (next_frame[j, 2] - frame[j, 2] + math.pi) % (2.0 * math.pi) - math.pi
        next_frame[j, 7] = turn / dt


@compiled
def take_over_driven(
    bodies: FloatArray, driven: BoolArray, next_frame: FloatArray, dt: float
) -> None:
    """Copies the state of egos that SUMO drives into their bodies."""
    for m in range(bodies.shape[0]):
        if not driven[m] or math.isnan(next_frame[m, 0]):
            continue
        before = bodies[m, 3]
        bodies[m, 0] = next_frame[m, 0]
        bodies[m, 1] = next_frame[m, 1]
        bodies[m, 2] = next_frame[m, 2]
        cos, sin = math.cos(next_frame[m, 2]), math.sin(next_frame[m, 2])
        bodies[m, 3] = next_frame[m, 3] * cos + next_frame[m, 4] * sin
        bodies[m, 4] = 0.0
        bodies[m, 5] = next_frame[m, 7]
        bodies[m, 7] = (bodies[m, 3] - before) / dt


@compiled
def _signal_shown(
    signal: int, time: float, ends: FloatArray, codes: ByteArray, offsets: FloatArray
) -> int:
    cycle = ends[signal, ends.shape[1] - 1]
    in_cycle = (time - offsets[signal] + 1e-9) % cycle
    for p in range(ends.shape[1]):
        if in_cycle < ends[signal, p]:
            return int(codes[signal, p])
    return int(codes[signal, ends.shape[1] - 1])


@compiled
def follow_egos(
    time: float,
    dt: float,
    frame: FloatArray,
    bodies: FloatArray,
    sizes: FloatArray,
    active: BoolArray,
    first_point: IntArray,
    lines: FloatArray,
    arcs: FloatArray,
    heights: FloatArray,
    cursors: IntArray,
    first_signal: IntArray,
    signal_s: FloatArray,
    signal_ends: FloatArray,
    signal_codes: ByteArray,
    signal_offsets: FloatArray,
    values: FloatArray,
    lights: ByteArray,
    protected: BoolArray,
    stuck: FloatArray,
    present: BoolArray,
    time_limits: FloatArray,
    ends: IntArray,
) -> int:
    """Tracks every active ego along its route: distance, next signal, time it has been stuck.

    Args:
        time: Seconds of this frame.
        dt: Seconds a step.
        frame: (N, 9) this frame; the egos' heights are filled in.
        bodies: (M, 9); their heights are filled in too.
        sizes: (N, 2) metres.
        active: (M,) egos that are driving.
        first_point: (M + 1,) where each route begins in ``lines`` and ``arcs``.
        lines: (n, 2) reference lines end to end, metres.
        arcs: (n,) arc lengths.
        heights: (n,) metres up.
        cursors: (M,) segment found last, relative; changed in place.
        first_signal: (M + 1,) where each route's signals begin in the arrays below.
        signal_s: (S,) arc length of the stop lines, ascending a route.
        signal_ends: (S, p) ends of the stages within the cycle, seconds, padded with the cycle.
        signal_codes: (S, p) ``Light`` a stage, or ``PERMISSIVE``.
        signal_offsets: (S,) seconds.
        values: (M, 8) of this frame, columns ``EgoCol``; changed in place.
        lights: (M,) ``Light`` of the next signal; changed in place.
        protected: (M,) whether that signal is green with the right of way; changed in place.
        stuck: (M,) seconds stuck; changed in place.
        present: (N,) of this frame.
        time_limits: (M,) seconds by which each ego must have arrived.
        ends: (M,) filled with indices into ``ENDS``.

    Returns:
        How many egos' parts end with this frame.
    """
    ended = 0
    for m in range(active.shape[0]):
        ends[m] = 0
        if not active[m]:
            continue
        if not present[m]:
            # SUMO takes its own vehicles away at the end of their last edge, behind the goal.
            ends[m] = 1
            ended += 1
            continue
        a, b = first_point[m], first_point[m + 1]
        x, y = frame[m, 0], frame[m, 1]
        cursor, s, lateral = track_line(
            lines[a:b], arcs[a:b], cursors[m], _SEARCH_BEHIND, _SEARCH_AHEAD, x, y
        )
        cursors[m] = cursor
        frame[m, 8] = heights[a + cursor]
        bodies[m, 8] = frame[m, 8]
        values[m, 2] = s
        values[m, 3] = lateral
        half = 0.5 * sizes[m, 0]
        values[m, 7] = np.nan
        lights[m] = 0
        protected[m] = False
        for i in range(first_signal[m], first_signal[m + 1]):
            if s - half <= signal_s[i]:
                values[m, 7] = signal_s[i] - (s + half)
                code = _signal_shown(i, time, signal_ends, signal_codes, signal_offsets)
                protected[m] = code == 1
                lights[m] = 1 if code == PERMISSIVE else code
                break
        if math.hypot(frame[m, 3], frame[m, 4]) >= STUCK_SPEED:
            stuck[m] = 0.0
        elif not (lights[m] >= 2 and values[m, 7] < QUEUE_REACH):
            stuck[m] += dt
        goal = math.hypot(x - lines[b - 1, 0], y - lines[b - 1, 1])
        if s > ARRIVED_SHARE * arcs[b - 1] and goal < ARRIVED_DISTANCE:
            ends[m] = 1
        elif stuck[m] >= STUCK_AFTER - 1e-9:
            ends[m] = 2
        elif time >= time_limits[m]:
            ends[m] = 3
        if ends[m] > 0:
            ended += 1
    return ended
