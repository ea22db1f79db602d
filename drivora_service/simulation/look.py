"""A running episode as it is now, for whoever drives or watches it step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.observations.trace import Col, Role
from drivora_service.simulation.world import World


@dataclass(frozen=True, slots=True, kw_only=True)
class ActorState:
    """One actor as it is now: metres, radians, m/s."""

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
    """The episode as it is now.

    Attributes:
        time: Seconds of simulation.
        step: Row of the trace.
        actors: Who is in the world, egos first.
        done: Whether the episode has ended.
    """

    time: float
    step: int
    actors: tuple[ActorState, ...]
    done: bool


def look_at(world: World, step: int, time: float, *, done: bool) -> Look:
    """Returns a frame of the world with all who are in it."""
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
