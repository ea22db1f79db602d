"""The models that a document may name: sizes, mass and limits of vehicles, walkers, obstacles.

Sizes of the CARLA blueprints are the bounding boxes of CARLA 0.9.15 (twice the extents that the
simulator reports), rounded to the centimetre.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class ActorKind(StrEnum):
    """What an actor is."""

    VEHICLE = "vehicle"
    WALKER = "walker"
    OBSTACLE = "obstacle"


@dataclass(frozen=True, slots=True, kw_only=True)
class ActorModel:
    """Size and limits of a model.

    Attributes:
        length: Metres, along the heading.
        width: Metres.
        wheelbase: Metres between the axles (vehicles).
        mass: Kilograms (vehicles).
        max_acceleration: m/s², from standstill on a dry road.
        max_deceleration: m/s², full braking on a dry road, positive.
        max_steer: Radians at the front wheels.
        max_speed: m/s.
    """

    name: str
    kind: ActorKind
    length: float
    width: float
    wheelbase: float = 0.0
    mass: float = 0.0
    max_acceleration: float = 0.0
    max_deceleration: float = 0.0
    max_steer: float = 0.0
    max_speed: float = 0.0
