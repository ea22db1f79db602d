"""Random draws of perception: the same for the same seed, ego and step."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.simulation.perception.ego_perception import Draw, Sense

_STREAM = 2
"""Number of the egos' random draws among those of a seed."""


def ego_seeds(seed: int, egos: int) -> list[np.random.SeedSequence]:
    """Returns the seeds of a run's egos: first of their perception, then of their agents."""
    return np.random.SeedSequence([seed, _STREAM]).spawn(2 * egos)


def is_noisy(senses: FloatArray) -> bool:
    """Returns whether perception with some (6,) senses needs random draws."""
    return bool(np.any(senses[Sense.POSITION_NOISE : Sense.LAG] > 0.0))


class SensorNoise:
    """The random draws of an ego's perception, step by step."""

    def __init__(self, seed: np.random.SeedSequence) -> None:
        self._random = np.random.default_rng(seed)

    def draw(self, draws: FloatArray) -> None:
        """Fills the (N, 5) draws of ``perceive``, columns ``Draw``, for the next step."""
        normal = self._random.standard_normal((len(draws), Draw.DROPOUT))
        draws[:, : Draw.DROPOUT] = normal
        draws[:, Draw.DROPOUT] = self._random.random(len(draws))
