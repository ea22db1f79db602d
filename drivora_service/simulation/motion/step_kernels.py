"""The two compiled calls of a step, which advance all actors from one frame to the next.

``make_frame`` writes the rows that the service moves, before SUMO steps; ``finish_frame`` detects
contacts and terminal events. Each is one compiled call, since entering a call takes longer than
most of its parts.

SI units, radians, box centres; columns as in ``observations.trace``.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from drivora_service.compilation import compiled
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.geometry.kernels import wrap_to_pi
from drivora_service.observations.trace import Col, EgoCol, SizeCol
from drivora_service.simulation.followers.followers import Followers, advance_followers
from drivora_service.simulation.motion.contacts import find_contacts
from drivora_service.simulation.motion.route_tracking import EgoProgress, RouteArrays, follow_egos
from drivora_service.simulation.motion.vehicle_dynamics import (
    Body,
    CommandMode,
    DriveCommand,
    EgoBodies,
    drive_vehicles,
)
from drivora_service.simulation.world import WorldFrames


class GroundCol(IntEnum):
    """Columns of the first row of the ground; the others are patches, ``ground.PatchCol``."""

    FRICTION = 0
    """Tyre-road friction coefficient beside patches."""
    WIND_X = 1
    """Acceleration by the wind, m/s²."""
    WIND_Y = 2


class ObstacleCol(IntEnum):
    """Columns of static actors."""

    START_TIME = 0
    """Seconds; inf for rows of other actors."""
    STATE = 1
    """The first of the columns ``Col``."""


class Surroundings(NamedTuple):
    """What acts on the actors of an episode, and its step.

    Attributes:
        dt: Step length, seconds.
        ground: (1 + P, 8) a row of columns ``GroundCol`` and patches, columns ``ground.PatchCol``:
            one array, since each adds time to a call.
        static: (N, 10) actors that stand, columns ``ObstacleCol``.
    """

    dt: float
    ground: FloatArray
    static: FloatArray


class PlacementCol(IntEnum):
    """Columns of ``MovedRows.placements``."""

    X = 0
    """Of the front bumper, metres."""
    Y = 1
    ANGLE = 2
    """SUMO's: degrees clockwise from north."""
    MOVED = 3
    """1 if the pose differs from the one before, else 0; negative if the row need not be placed."""


class MovedRows(NamedTuple):
    """The rows that the service moves, for SUMO.

    Attributes:
        is_moved: (N,) rows that the service moves.
        known: (N,) rows that SUMO knows of.
        placements: (N, 4), columns ``PlacementCol``.
    """

    is_moved: BoolArray
    known: BoolArray
    placements: FloatArray


@compiled
def make_frame(
    before: int,
    after: int,
    time: float,
    for_sumo: bool,
    around: Surroundings,
    frames: WorldFrames,
    egos: EgoBodies,
    followers: Followers,
    moved: MovedRows,
) -> int:
    """Writes the rows of a frame that the service moves, and their placements for SUMO.

    Args:
        before: Index of the frame before.
        after: Index of the frame to write; 0 is the start, before any motion.
        time: Seconds of the frame to write.
        for_sumo: Whether SUMO gets the frame; else no placements are written.
        around: Ground, wind and static actors.
        frames: The frames of the world.
        egos: Moved; their commands are written into the values of the frame before.
        followers: Moved.
        moved: Placements are written.

    Returns:
        The number of moved rows that enter or leave with the frame; -1 without placements.
    """
    dt, ground, static = around.dt, around.ground, around.static
    sizes, bodies, modes, commands = frames.sizes, egos.bodies, egos.modes, egos.commands
    frame, next_frame = frames.states[before], frames.states[after]
    present, next_present = frames.present[before], frames.present[after]
    friction, patches = ground[0, GroundCol.FRICTION], ground[1:]
    wind = ground[0, GroundCol.WIND_X : GroundCol.WIND_Y + 1]
    for j in range(static.shape[0]):
        next_present[j] = static[j, ObstacleCol.START_TIME] <= time + 1e-9
        if next_present[j]:
            for k in range(next_frame.shape[1]):
                next_frame[j, k] = static[j, ObstacleCol.STATE + k]
    if after > 0:
        values = egos.values[before]
        for m in range(bodies.shape[0]):
            if modes[m] == CommandMode.DRIVE:
                values[m, EgoCol.ACCELERATION] = commands[m, DriveCommand.ACCELERATION]
                values[m, EgoCol.STEER] = commands[m, DriveCommand.STEER]
        drive_vehicles(bodies, egos.limits, modes, commands, friction, patches, wind, dt)
    _write_egos(bodies, egos.in_world, next_frame, next_present)
    # Followers react to the frame before, in which no actor has moved yet: the order of rows does
    # not matter.
    advance_followers(
        time - dt, dt, friction, patches, followers, frame, sizes, present, next_frame, next_present
    )
    if not for_sumo:
        return -1
    return write_placements(frame, present, next_frame, next_present, sizes, moved)


@compiled
def finish_frame(
    before: int,
    after: int,
    time: float,
    dt: float,
    frames: WorldFrames,
    egos: EgoProgress,
    routes: RouteArrays,
    seen: BoolArray,
    found: IntArray,
) -> tuple[int, int]:
    """Completes a frame with final poses, and detects contacts and terminal events.

    Args:
        before: Index of the frame before.
        after: Index of the frame to complete.
        time: Seconds of that frame.
        dt: Step length, seconds.
        frames: The frames of the world; rates are written.
        egos, routes: As in ``route_tracking.follow_egos``.
        seen, found: As in ``contacts.find_contacts``.

    Returns:
        The number of filled rows of ``found``, and of egos whose parts end with this frame.
    """
    frame, present, sizes = frames.states[after], frames.present[after], frames.sizes
    # SUMO's own vehicles have been written in between: rates are differences of final poses.
    _write_rates(frames.states[before], frames.present[before], frame, present, dt)
    contacts = find_contacts(frame, sizes, present, egos.active, seen, found)
    ended = follow_egos(after, time, dt, frames, egos, routes)
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
        next_frame[m, Col.X] = bodies[m, Body.X]
        next_frame[m, Col.Y] = bodies[m, Body.Y]
        next_frame[m, Col.YAW] = bodies[m, Body.YAW]
        write_velocity(bodies[m], next_frame[m])
        next_frame[m, Col.Z] = bodies[m, Body.HEIGHT]


@compiled
def write_velocity(body: FloatArray, state: FloatArray) -> None:
    """Writes a body's velocity into its row of a frame."""
    v, side = body[Body.SPEED], body[Body.SIDE_SPEED]
    cos, sin = math.cos(body[Body.YAW]), math.sin(body[Body.YAW])
    state[Col.VX] = v * cos - side * sin
    state[Col.VY] = v * sin + side * cos


@compiled
def write_placements(
    frame: FloatArray,
    present: BoolArray,
    next_frame: FloatArray,
    next_present: BoolArray,
    sizes: FloatArray,
    moved: MovedRows,
) -> int:
    """Writes the placement of each moved row for SUMO.

    Args:
        frame: (N, 9) this frame.
        present: (N,) of this frame.
        next_frame: (N, 9) next frame.
        next_present: (N,) of the next frame.
        sizes: (N, 2), columns ``SizeCol``.
        moved: Its placements are filled for the present rows.

    Returns:
        The number of moved rows that enter or leave with the next frame.
    """
    is_moved, known, placements = moved.is_moved, moved.known, moved.placements
    changes = 0
    for j in range(next_frame.shape[0]):
        if not is_moved[j]:
            continue
        if next_present[j] != known[j]:
            changes += 1
        if not next_present[j]:
            continue
        x, y, yaw = next_frame[j, Col.X], next_frame[j, Col.Y], next_frame[j, Col.YAW]
        half = 0.5 * sizes[j, SizeCol.LENGTH]
        placements[j, PlacementCol.X] = x + half * math.cos(yaw)
        placements[j, PlacementCol.Y] = y + half * math.sin(yaw)
        placements[j, PlacementCol.ANGLE] = (90.0 - math.degrees(yaw)) % 360.0
        was = frame[j]
        same = present[j] and was[Col.X] == x and was[Col.Y] == y and was[Col.YAW] == yaw
        placements[j, PlacementCol.MOVED] = 0.0 if same else 1.0
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
            next_frame[j, Col.AX] = 0.0
            next_frame[j, Col.AY] = 0.0
            next_frame[j, Col.YAW_RATE] = 0.0
            continue
        next_frame[j, Col.AX] = (next_frame[j, Col.VX] - frame[j, Col.VX]) / dt
        next_frame[j, Col.AY] = (next_frame[j, Col.VY] - frame[j, Col.VY]) / dt
        turn = wrap_to_pi(next_frame[j, Col.YAW] - frame[j, Col.YAW])
        next_frame[j, Col.YAW_RATE] = turn / dt


@compiled
def take_over_driven(
    bodies: FloatArray, driven: BoolArray, next_frame: FloatArray, dt: float
) -> None:
    """Copies the state of egos that SUMO drives into their bodies."""
    for m in range(bodies.shape[0]):
        if not driven[m] or math.isnan(next_frame[m, Col.X]):
            continue
        before = bodies[m, Body.SPEED]
        bodies[m, Body.X] = next_frame[m, Col.X]
        bodies[m, Body.Y] = next_frame[m, Col.Y]
        bodies[m, Body.YAW] = next_frame[m, Col.YAW]
        cos, sin = math.cos(next_frame[m, Col.YAW]), math.sin(next_frame[m, Col.YAW])
        bodies[m, Body.SPEED] = next_frame[m, Col.VX] * cos + next_frame[m, Col.VY] * sin
        bodies[m, Body.SIDE_SPEED] = 0.0
        bodies[m, Body.YAW_RATE] = next_frame[m, Col.YAW_RATE]
        bodies[m, Body.ACCELERATION] = (bodies[m, Body.SPEED] - before) / dt
