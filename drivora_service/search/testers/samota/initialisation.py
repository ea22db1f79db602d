"""Adaptive random initialisation: every candidate is far from the previous ones."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.distance import candidate_distances
from drivora_service.search.genes import GeneSpace


class AdaptiveRandom:
    """Draws several candidates and returns the one farthest from all returned before.

    Source: Chen, Leung, Mak, "Adaptive random testing" (2004), with a candidate set of fixed size.
    """

    def __init__(self, space: GeneSpace, *, pool: int) -> None:
        """Takes the space and the number of draws a candidate."""
        self._space = space
        self._pool = pool
        self._given: FloatArray = np.empty((0, len(space)))

    def draw(self, random: np.random.Generator) -> FloatArray:
        """Returns the next candidate (d,)."""
        drawn = self._space.sample(random, self._pool)
        chosen = 0
        if len(self._given):
            nearest = candidate_distances(drawn, self._given, self._space).min(axis=1)
            chosen = int(np.argmax(nearest))
        self._given = np.concatenate((self._given, drawn[chosen : chosen + 1]))
        return np.array(drawn[chosen])
