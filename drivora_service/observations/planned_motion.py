"""The motion of an actor as its scenario plans it, before any run."""

from __future__ import annotations

from dataclasses import dataclass

from drivora_service.geometry.array_shapes import BoolArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlannedMotion:
    """The poses of an actor at even times.

    Attributes:
        id: Id of the actor.
        length: Metres along the heading.
        width: Metres.
        times: (n,) seconds.
        poses: (n, 3) x, y (m) and heading (rad).
        present: (n,) whether it is in the world.
        may_be_late: Whether it brakes for other actors, so that it may be at each place later than
            planned, but never earlier.
    """

    id: str
    length: float
    width: float
    times: FloatArray
    poses: FloatArray
    present: BoolArray
    may_be_late: bool
