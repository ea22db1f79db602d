"""The present state of a running episode, for callers that step it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import BoolArray, ByteArray, FloatArray
from drivora_service.observations.trace import Col, Role
from drivora_service.simulation.world import World

_Item = TypeVar("_Item", bound=np.generic)


@dataclass(frozen=True, slots=True, kw_only=True)
class ActorState:
    """The present state of an actor: metres, radians, m/s."""

    id: str
    role: Role
    model: str
    x: float
    y: float
    yaw: float
    speed: float
    length: float
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """The present state of the episode.

    Attributes:
        time: Simulation time, seconds.
        step: Row of the trace.
        actors: Actors in the world, egos first.
        done: Whether the episode has ended.
    """

    time: float
    step: int
    actors: tuple[ActorState, ...]
    done: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frames:
    """The last n frames of a running episode; columns and rows as in its trace.

    Read-only views, which the next step may leave behind. What only a finished trace has, such as
    the lanes of the egos, is missing.

    Attributes:
        first: Row of the first frame in the trace.
        states: (n, N, 9), columns ``Col``.
        present: (n, N).
        ego_values: (n, M, 8), columns ``EgoCol``.
        ego_lights: (n, M), values ``Light``.
    """

    first: int
    states: FloatArray
    present: BoolArray
    ego_values: FloatArray
    ego_lights: ByteArray


def frames_of(world: World, first: int, last: int) -> Frames:
    """Returns the frames of a world from one row to another, both included."""
    first = max(first, 0)
    rows = slice(first, last + 1)
    return Frames(
        first=first,
        states=_view(world.states[rows]),
        present=_view(world.present[rows]),
        ego_values=_view(world.ego_values[rows]),
        ego_lights=_view(world.ego_lights[rows]),
    )


def _view(frames: NDArray[_Item]) -> NDArray[_Item]:
    frames = frames.view()
    frames.setflags(write=False)
    return frames


def look_at(world: World, step: int, time: float, *, done: bool) -> Look:
    """Returns a frame of the world with all present actors."""
    frame, present = world.states[step], world.present[step]
    return Look(
        time=time,
        step=step,
        actors=tuple(
            ActorState(
                id=actor.id,
                role=actor.role,
                model=actor.model,
                x=float(frame[actor.row, Col.X]),
                y=float(frame[actor.row, Col.Y]),
                yaw=float(frame[actor.row, Col.YAW]),
                speed=float(np.hypot(frame[actor.row, Col.VX], frame[actor.row, Col.VY])),
                length=actor.length,
                width=actor.width,
            )
            for actor in world.actors
            if present[actor.row]
        ),
        done=done,
    )
