"""The present state of a running episode, for callers that step it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.observations.trace import Col, Role
from drivora_service.simulation.world import World


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
