"""Slippery patches under the vehicles that SUMO drives.

SUMO has friction by lane, and lets it change only the speed that drivers wish for. A patch is
smaller than a lane, and what it takes is braking and acceleration: while the centre of a vehicle is
on one, SUMO is told that the vehicle has no more of both than the grip there.
"""

from __future__ import annotations

from collections.abc import Sequence

from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.observations.ground import friction_at
from drivora_service.observations.trace import Col
from drivora_service.simulation.motion.vehicle_dynamics import GRAVITY
from drivora_service.simulation.sumo import DrivenActor, SumoWorld

_X, _Y, _Z = int(Col.X), int(Col.Y), int(Col.Z)


class SumoPatches:
    """Keeps the grip of SUMO's vehicles that of the place where they are."""

    def __init__(self, sumo: SumoWorld, friction: float, patches: FloatArray) -> None:
        """Takes the road's friction coefficient and the (P, 8) patches, at least one."""
        self._sumo, self._friction, self._patches = sumo, friction, patches
        self._on_patch: dict[str, float] = {}

    def tend(self, driven: Sequence[DrivenActor], frame: FloatArray, present: BoolArray) -> None:
        """Tells SUMO of the vehicles that have come on a patch, or have left one.

        Args:
            driven: Vehicles that SUMO drives.
            frame: (N, 9) their states now, columns ``Col``.
            present: (N,) whether they are on the road.
        """
        for actor in driven:
            if not present[actor.row]:
                continue
            state = frame[actor.row]
            here = friction_at(state[_X], state[_Y], state[_Z], self._friction, self._patches)
            if here == self._on_patch.get(actor.id, self._friction):
                continue
            self._on_patch[actor.id] = here
            self._sumo.limit_grip(actor.id, here * GRAVITY)
