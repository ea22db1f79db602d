"""The energy of a seed: its expected value for further mutation."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.selection import draw_by_probability

INITIAL_GAIN = INITIAL_NOVELTY = 0.5
"""Assumed gain and novelty of the first seeds, which have no parent."""

_FAILURE_WEIGHT = 0.1
"""Weight of the failure rate, 1 minus the success rate, in a seed's energy."""

_COST = 0.05
"""Energy that every child takes from its parent."""

_EPSILON = 1e-10
"""Keeps the gain's divisor from 0 if a child's behaviour is entirely new."""


def initial_energy(gain: float, novelty: float) -> float:
    """Returns the initial energy of a seed.

    Args:
        gain: Its parent's degree of violation minus its own, -1..1.
        novelty: Distance of its behaviour to the nearest of the archive, 0..1.
    """
    return 1.0 + 0.5 * (gain + novelty)


@dataclass(slots=True, kw_only=True, eq=False)
class Seed:
    """A candidate of the corpus.

    Attributes:
        number: Number of its evaluation.
        values: (d,) genes.
        without_effect: (d,) genes without effect in its run.
        degree: Degree of violation, 0..1, smaller is nearer to a failure.
        energy: Not negative.
        children: Number of told mutants of it.
        successes: Number of those that failed or had new behaviour.
    """

    number: int
    values: FloatArray
    without_effect: BoolArray
    degree: float
    energy: float
    children: int = 0
    successes: int = 0

    def learn(self, *, is_success: bool, gain: float, novelty: float) -> None:
        """Updates the energy after the evaluation of a mutant.

        Args:
            is_success: Whether it failed or had new behaviour.
            gain: This seed's degree of violation minus the mutant's.
            novelty: Distance of the mutant's behaviour to the nearest of the archive.
        """
        self.children += 1
        self.successes += is_success
        rate = self.successes / self.children
        success = rate if is_success else -_FAILURE_WEIGHT * (1.0 - rate)
        slope = math.tanh(gain / (1.0 - novelty + _EPSILON))
        self.spend(_COST - 0.5 * success - 0.5 * slope)

    def spend(self, energy: float) -> None:
        """Subtracts energy; the result is not negative."""
        self.energy = max(self.energy - energy, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergySelection:
    """Draws seeds with a probability in proportion to their energy.

    The only objective is the negated energy, as objectives are minimised.
    """

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        """Chooses seeds; uniformly if none has energy left."""
        energies = -objectives[:, 0]
        total = float(energies.sum())
        if total > 0.0:
            return draw_by_probability(energies / total, count, random)
        return random.integers(len(energies), size=count)
