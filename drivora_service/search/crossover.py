"""The crossover of actors: two candidates made from two others."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import GeneSpace

Children = tuple[FloatArray, FloatArray]


def one_point(
    first: FloatArray, second: FloatArray, space: GeneSpace, random: np.random.Generator
) -> Children:
    """Exchanges all genes after a point between two in which the parents differ.

    Parents that differ in at most one gene that varies are returned as they are.
    """
    differing = np.flatnonzero((first != second) & space.varies)
    one, other = first.copy(), second.copy()
    if len(differing) > 1:
        point = int(differing[random.integers(1, len(differing))])
        one[point:], other[point:] = second[point:], first[point:]
    return one, other


def exchange_block(
    first: FloatArray, second: FloatArray, space: GeneSpace, random: np.random.Generator
) -> Children:
    """Exchanges one actor among those in which the parents differ; does not change the parents."""
    blocks = np.logical_or.reduceat(first != second, space.starts).nonzero()[0]
    one, other = first.copy(), second.copy()
    if len(blocks):
        which = space.blocks[blocks[random.integers(len(blocks))]].slice
        one[which], other[which] = second[which], first[which]
    return one, other
