"""Making many candidates at once, for searches on surrogates.

The operators of ``search.mutation`` take one candidate; on surrogates their calls would cost more
than the predictions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from drivora_service.geometry.arrays import FloatArray, IntArray
from drivora_service.search.components import Mutation
from drivora_service.search.genes import Block, GeneSpace


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Region:
    """The region of a search.

    Attributes:
        space: The bounds.
        members: (k, d) candidates; only their categories are used; ``None``: all categories.
    """

    space: GeneSpace
    members: FloatArray | None = None

    @staticmethod
    def around(space: GeneSpace, members: FloatArray) -> Region:
        """Returns the smallest region that contains the members (k, d)."""
        lows, highs = members.min(axis=0), members.max(axis=0)
        blocks = tuple(_narrowed(block, lows, highs) for block in space.blocks)
        return Region(space=GeneSpace(blocks), members=members)

    def sample(self, random: np.random.Generator, count: int) -> FloatArray:
        """Draws candidates (count, d)."""
        genes = np.tile(np.arange(len(self.space)), count)
        return self.draw(genes, random).reshape(count, len(self.space))

    def draw(self, genes: IntArray, random: np.random.Generator) -> FloatArray:
        """Draws a value (k,) for each of some genes (k,); a category is that of a random member."""
        space = self.space
        unit = random.random(len(genes))
        lows, highs, is_whole = space.lows[genes], space.highs[genes], space.is_whole[genes]
        whole = np.minimum(np.floor(lows + unit * (highs - lows + 1.0)), highs)
        drawn: FloatArray = np.where(is_whole, whole, lows + unit * (highs - lows))
        if self.members is not None:
            chosen = self.members[random.integers(len(self.members), size=len(genes)), genes]
            drawn = np.where(space.is_category[genes], chosen, drawn)
        return drawn


def _narrowed(block: Block, lows: FloatArray, highs: FloatArray) -> Block:
    bounds = zip(block.genes, lows[block.slice], highs[block.slice], strict=True)
    genes = tuple(replace(gene, low=float(low), high=float(high)) for gene, low, high in bounds)
    return replace(block, genes=genes)


@dataclass(frozen=True, slots=True, kw_only=True)
class Breeding:
    """The operators.

    Attributes:
        crossover: Probability with which two parents exchange genes.
        tournament: Number of candidates of which a parent is the best.
        step: Standard deviation of a magnitude's change as a share of its range.
        mutation: Mutation in place of the own one; ``None`` keeps it.
    """

    crossover: float
    tournament: int
    step: float
    mutation: Mutation | None = None

    def children(
        self, parents: FloatArray, region: Region, random: np.random.Generator
    ) -> FloatArray:
        """Returns as many children (n, d) as there are parents (n, d), sorted best first."""
        couples = (len(parents) + 1) // 2
        drawn = random.integers(len(parents), size=(2 * couples, self.tournament)).min(axis=1)
        first, second = parents[drawn[:couples]], parents[drawn[couples:]]
        cuts = random.choice(_cuts(region.space), size=couples)
        behind = np.arange(parents.shape[1]) >= cuts[:, None]
        exchanged = behind & (random.random(couples) < self.crossover)[:, None]
        one, other = np.where(exchanged, second, first), np.where(exchanged, first, second)
        children = np.concatenate((one, other))[: len(parents)]
        if self.mutation is not None:
            return np.stack([self.mutation.mutate(c, region.space, random) for c in children])
        return self._mutated(children, region, random)

    def _mutated(
        self, values: FloatArray, region: Region, random: np.random.Generator
    ) -> FloatArray:
        """Changes each gene with probability 1 over their number, and at least one.

        Half of the changed magnitudes are redrawn, the others moved by a normal draw. Values are
        clipped to the bounds, so that both bounds occur.
        """
        space = region.space
        varying = np.flatnonzero(space.varies)
        if not len(varying):
            return values
        which = random.random(values.shape) < 1.0 / len(varying)
        which[np.arange(len(values)), random.choice(varying, size=len(values))] = True
        rows, genes = np.nonzero(which)
        changed = np.array(values)
        changed[rows, genes] = region.draw(genes, random)
        near = ~space.is_whole[genes] & (random.random(len(genes)) < 0.5)
        rows, genes = rows[near], genes[near]
        lows, highs = space.lows[genes], space.highs[genes]
        steps = self.step * (highs - lows) * random.standard_normal(len(genes))
        changed[rows, genes] = np.clip(values[rows, genes] + steps, lows, highs)
        return changed


def _cuts(space: GeneSpace) -> IntArray:
    """Returns the cut points for exchanges between parents; actors stay whole."""
    starts = [block.start for block in space.blocks[1:]]
    return np.array(starts or range(1, max(len(space), 2)), dtype=np.int64)
