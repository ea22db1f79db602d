"""The crossover of actors: two candidates made from two others."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.genes import GeneSpace

Children = tuple[FloatArray, FloatArray]


def exchange_block(
    first: FloatArray, second: FloatArray, space: GeneSpace, random: np.random.Generator
) -> Children:
    """Exchanges one actor among those in which the parents differ; does not change the parents."""
    differ = [b for b in space.blocks if not np.array_equal(first[b.slice], second[b.slice])]
    which = np.zeros(len(space), dtype=np.bool_)
    if differ:
        which[differ[random.integers(len(differ))].slice] = True
    return np.where(which, second, first), np.where(which, first, second)
