"""The first generation: drawn at random, with at least one conflict of routes each."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.testers.doppeltest.chromosome import PATH, Chromosome

_ATTEMPTS = 100


def draw_seed(chromosome: Chromosome, random: np.random.Generator) -> FloatArray:
    """Draws a candidate: the numbers of egos and walkers, their genes, and all other genes.

    The egos are redrawn until two of their paths conflict; after too many draws, two conflicting
    paths are drawn for the first two.
    """
    values = chromosome.space.sample(random)
    _draw_egos(chromosome, values, random)
    walkers = chromosome.walkers
    count = int(random.integers(walkers.least, walkers.most + 1))
    walkers.fill(values, [walkers.draw(chromosome.space, random) for _ in range(count)])
    chromosome.start_early(values)
    return values


def _draw_egos(chromosome: Chromosome, values: FloatArray, random: np.random.Generator) -> None:
    egos = chromosome.egos
    count = int(random.integers(max(egos.least, 2), egos.most + 1))
    for _ in range(_ATTEMPTS):
        egos.fill(values, [egos.draw(chromosome.space, random) for _ in range(count)])
        if chromosome.conflicts.among(chromosome.paths(values)):
            return
    pairs = chromosome.conflicts.pairs()
    pair = pairs[random.choice(len(pairs))]
    for slot, path in zip(egos.taken_slots(values), pair, strict=False):
        values[egos.index(slot, PATH)] = path
