"""The energy of a seed: how much is expected of going on from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.arrays import FloatArray, IntArray

INITIAL_GAIN = INITIAL_NOVELTY = 0.5
"""What the first seeds, which have no parent, are taken to have gained and to have been new."""

_BARREN = 0.1
"""Share of the rate of barren children that counts against a seed."""

_COST = 0.05
"""Energy that a child takes from its parent, however it turns out."""

_TINY = 1e-10
"""Keeps the gain's divisor from 0 where a child's behaviour is entirely new."""


def initial_energy(gain: float, novelty: float) -> float:
    """Returns the energy that a seed starts with.

    Args:
        gain: Its parent's degree of violation less its own, -1..1.
        novelty: Distance of its behaviour to the nearest of the archive, 0..1.
    """
    return 1.0 + 0.5 * (gain + novelty)


@dataclass(slots=True, kw_only=True, eq=False)
class Seed:
    """A candidate of the corpus.

    Attributes:
        number: Of its evaluation.
        values: (d,) genes.
        degree: Degree of violation, 0..1, smaller is nearer to a failure.
        energy: Not negative.
        children: Mutants of it that were told.
        fruitful: Those of them that failed or behaved anew.
    """

    number: int
    values: FloatArray
    degree: float
    energy: float
    children: int = 0
    fruitful: int = 0

    def learn(self, *, is_fruitful: bool, gain: float, novelty: float) -> None:
        """Changes the energy by what became of a mutant.

        Args:
            is_fruitful: Whether it failed or behaved anew.
            gain: This seed's degree of violation less the mutant's.
            novelty: Distance of the mutant's behaviour to the nearest of the archive.
        """
        self.children += 1
        self.fruitful += is_fruitful
        rate = self.fruitful / self.children
        success = rate if is_fruitful else -_BARREN * (1.0 - rate)
        slope = float(np.tanh(gain / (1.0 - novelty + _TINY)))
        self.spend(_COST - 0.5 * success - 0.5 * slope)

    def spend(self, energy: float) -> None:
        """Takes energy away, but no more than there is."""
        self.energy = max(self.energy - energy, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergySelection:
    """Draws seeds with a probability in proportion to their energy.

    The only objective is the energy with its sign turned, as objectives are minimised.
    """

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        """Chooses seeds; all alike where none has energy left."""
        energies = -objectives[:, 0]
        total = float(energies.sum())
        chances = energies / total if total > 0.0 else None
        return random.choice(len(energies), size=count, p=chances)
