"""The two compiled calls of a step, which advance all actors from one frame to the next.

``make_frame`` writes the rows that the service moves, before SUMO steps; ``finish_frame`` detects
contacts and terminal events. Each is one compiled call, since entering a call takes longer than
most of its parts.

SI units, radians, box centres; columns as in ``observations.trace``.
"""

from __future__ import annotations

import math

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.simulation.followers.followers import advance_followers
from drivora_service.simulation.motion.contacts import find_contacts
from drivora_service.simulation.motion.route_tracking import follow_egos
from drivora_service.simulation.motion.vehicle_dynamics import drive_vehicles


@compiled
def make_frame(
    before: int,
    after: int,
    time: float,
    told: bool,
    dt: float,
    ground: FloatArray,
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    static: FloatArray,
    bodies: FloatArray,
    limits: FloatArray,
    modes: IntArray,
    commands: FloatArray,
    in_world: BoolArray,
    places: IntArray,
    path: FloatArray,
    followers: FloatArray,
    is_moved: BoolArray,
    known: BoolArray,
    placements: FloatArray,
    ego_values: FloatArray,
) -> int:
    """Writes the rows of a frame that the service moves, and their placements for SUMO.

    Args:
        before: Index of the frame before.
        after: Index of the frame to write; 0 is the start, before any motion.
        time: Seconds of the frame to write.
        told: Whether SUMO is told of the frame; else no placements are written.
        dt: Step length, seconds.
        ground: (1 + P, 8) as of ``arrays.lay_ground``: one array, since each adds time to a call.
        states: (rows, N, 9) frames of the world.
        present: (rows, N).
        sizes: (N, 2) metres.
        static: (N, 10) as of ``arrays.lay_obstacles``.
        bodies, limits, modes, commands: The egos', as in ``dynamics.drive_vehicles``.
        in_world: (M,) egos that are on the road.
        places, path, followers: As in ``followers.Followers``.
        is_moved, known, placements: As in ``write_placements``.
        ego_values: (rows, M, 8), columns ``EgoCol``; filled with the commands.

    Returns:
        The number of moved rows that enter or leave with the frame; -1 without placements.
    """
    frame, next_frame = states[before], states[after]
    next_present = present[after]
    friction, wind, patches = ground[0, 0], ground[0, 1:3], ground[1:]
    for j in range(static.shape[0]):
        next_present[j] = static[j, 0] <= time + 1e-9
        if next_present[j]:
            for k in range(next_frame.shape[1]):
                next_frame[j, k] = static[j, 1 + k]
    if after > 0:
        for m in range(bodies.shape[0]):
            if modes[m] == 1:
                ego_values[before, m, 0] = commands[m, 0]
                ego_values[before, m, 1] = commands[m, 1]
        drive_vehicles(bodies, limits, modes, commands, friction, patches, wind, dt)
    _write_egos(bodies, in_world, next_frame, next_present)
    advance_followers(
        time - dt, dt, friction, patches, places, path, followers, frame, sizes, present[before],
        next_frame, next_present,
    )  # fmt: skip
    if not told:
        return -1
    return write_placements(
        frame, present[before], next_frame, next_present, sizes, is_moved, known, placements
    )


@compiled
def finish_frame(
    before: int,
    after: int,
    time: float,
    dt: float,
    states: FloatArray,
    present: BoolArray,
    sizes: FloatArray,
    bodies: FloatArray,
    active: BoolArray,
    seen: BoolArray,
    found: IntArray,
    points: FloatArray,
    signals: FloatArray,
    parts: IntArray,
    progress: FloatArray,
    ego_values: FloatArray,
    ego_lights: ByteArray,
    ends: IntArray,
) -> tuple[int, int]:
    """Completes a frame with final poses, and detects contacts and terminal events.

    Args:
        before: Index of the frame before.
        after: Index of the frame to complete.
        time: Seconds of that frame.
        dt: Step length, seconds.
        states: (rows, N, 9) frames of the world.
        present: (rows, N).
        sizes: (N, 2) metres.
        bodies: (M, 10) of the egos.
        active: (M,) egos that are driving.
        seen, found: As in ``contacts.find_contacts``.
        points, signals, parts, progress, ends: As in ``route_tracking.follow_egos``.
        ego_values: (rows, M, 8), columns ``EgoCol``.
        ego_lights: (rows, M).

    Returns:
        The number of filled rows of ``found``, and of egos whose parts end with this frame.
    """
    frame = states[after]
    _write_rates(states[before], present[before], frame, present[after], dt)
    contacts = find_contacts(frame, sizes, present[after], active, seen, found)
    ended = follow_egos(
        time, dt, frame, present[after], sizes, bodies, active, points, signals, parts, progress,
        ego_values[after], ego_lights[after], ends,
    )  # fmt: skip
    return contacts, ended


@compiled
def _write_egos(
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
        next_frame[m, 0] = bodies[m, 0]
        next_frame[m, 1] = bodies[m, 1]
        next_frame[m, 2] = bodies[m, 2]
        write_velocity(bodies[m], next_frame[m])
        next_frame[m, 8] = bodies[m, 8]


@compiled
def write_velocity(body: FloatArray, state: FloatArray) -> None:
    """Writes a body's velocity into its row of a frame."""
    v, side = body[3], body[4]
    cos, sin = math.cos(body[2]), math.sin(body[2])
    state[3] = v * cos - side * sin
    state[4] = v * sin + side * cos


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
    """Writes the placement of each moved row for SUMO.

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
        The number of moved rows that enter or leave with the next frame.
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
def _write_rates(
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
        turn = wrap_to_pi(next_frame[j, 2] - frame[j, 2])
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
