"""The boxes that an ego perceived in the last steps, and its own."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.agents.interface import Observation
from drivora_service.agents.raster.raster_drawing import BoxCol, BoxKind
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import LEVEL_GAP, Col
from drivora_service.scenario.models.actor_models import ActorModel

_ROOM = 64
"""Boxes of a step at first; more are made when they are needed."""


class PerceivedBoxes:
    """Keeps the boxes of as many steps as a raster shows."""

    def __init__(self, model: ActorModel, step_length: float, longest: float) -> None:
        """Keeps nothing yet.

        Args:
            model: The ego's vehicle.
            step_length: Seconds.
            longest: Seconds before now that can be asked for.
        """
        self._size = model.length, model.width
        self._tolerance = 0.5 * step_length + 1e-9
        steps = math.ceil(longest / step_length) + 2
        self._boxes = np.zeros((steps, _ROOM, len(BoxCol)))
        self._counts = np.zeros(steps, dtype=np.int64)
        self._times = np.full(steps, -np.inf)
        self._last = -1

    def forget(self) -> None:
        """Removes all steps."""
        self._times.fill(-np.inf)
        self._last = -1

    def record(self, observation: Observation) -> None:
        """Adds the boxes of a step; the same step again replaces them."""
        if self._last < 0 or self._times[self._last] != observation.time:
            self._last = (self._last + 1) % len(self._times)
        count = len(observation.objects)
        room = self._boxes.shape[1]
        if count + 1 > room:
            wider = np.zeros((len(self._times), max(2 * room, count + 1), len(BoxCol)))
            wider[:, :room] = self._boxes
            self._boxes = wider
        rows = self._boxes[self._last]
        rows[:count, BoxCol.X : BoxCol.YAW + 1] = observation.objects[:, Col.X : Col.YAW + 1]
        rows[:count, BoxCol.LENGTH : BoxCol.WIDTH + 1] = observation.object_sizes
        rows[:count, BoxCol.KIND] = observation.object_kinds
        # Perception leaves them out; an observation may come from elsewhere.
        apart = np.abs(observation.objects[:, Col.Z] - observation.ego[Col.Z]) > LEVEL_GAP
        if apart.any():
            kept = np.flatnonzero(~apart)
            rows[: len(kept)] = rows[kept]
            count = len(kept)
        rows[count, BoxCol.X : BoxCol.YAW + 1] = observation.ego[Col.X : Col.YAW + 1]
        rows[count, BoxCol.LENGTH], rows[count, BoxCol.WIDTH] = self._size
        rows[count, BoxCol.KIND] = BoxKind.EGO
        self._counts[self._last] = count + 1
        self._times[self._last] = observation.time

    def at(self, time: float) -> tuple[FloatArray, int] | None:
        """Returns the boxes of a step and their number; ``None`` if no step was at this time.

        Args:
            time: Seconds; a step is found within half a step of it.
        """
        nearest = int(np.argmin(np.abs(self._times - time)))
        if not abs(self._times[nearest] - time) <= self._tolerance:
            return None
        return self._boxes[nearest], int(self._counts[nearest])
