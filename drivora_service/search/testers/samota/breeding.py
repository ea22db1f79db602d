"""Making many candidates at once, for searches on surrogates.

The operators of ``search.mutation`` take one candidate; on surrogates their calls would cost more
than the predictions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.components import Mutation
from drivora_service.search.genes import Block, GeneSpace


class Region:
    """The region of a search.

    Attributes:
        lows: (d,) least values.
        highs: (d,) greatest values.
        is_whole: (d,) genes whose values are whole numbers.
        varying: Indices of the genes that can have more than one value.
        cuts: Points at which parents may exchange genes; actors stay whole.
    """

    def __init__(self, *, space: GeneSpace, members: FloatArray | None = None) -> None:
        """Takes a space and candidates in it.

        Args:
            space: All genes.
            members: (k, d) candidates: the region is the smallest one that contains them, and only
                their categories are drawn; ``None``: the whole space.
        """
        self._whole_space = space
        self._members = members
        self.lows = space.lows if members is None else members.min(axis=0)
        self.highs = space.highs if members is None else members.max(axis=0)
        self.is_whole = space.is_whole
        self._is_category = space.is_category
        self.varying: IntArray = np.flatnonzero(self.lows < self.highs)
        starts = [block.start for block in space.blocks[1:]]
        self.cuts: IntArray = np.array(starts or range(1, max(len(space), 2)), dtype=np.int64)

    @cached_property
    def space(self) -> GeneSpace:
        """The gene space with the bounds of the region."""
        if self._members is None:
            return self._whole_space
        narrowed = (_narrow_block(one, self.lows, self.highs) for one in self._whole_space.blocks)
        return GeneSpace(tuple(narrowed))

    def sample(self, random: np.random.Generator, count: int) -> FloatArray:
        """Draws candidates (count, d)."""
        genes = np.tile(np.arange(len(self.lows)), count)
        return self.draw(genes, random).reshape(count, len(self.lows))

    def draw(self, genes: IntArray, random: np.random.Generator) -> FloatArray:
        """Draws a value (k,) for each of some genes (k,); a category is that of a random member."""
        unit = random.random(len(genes))
        lows, highs = self.lows[genes], self.highs[genes]
        spans = highs - lows
        whole = np.minimum(np.floor(lows + unit * (spans + 1.0)), highs)
        drawn: FloatArray = np.where(self.is_whole[genes], whole, lows + unit * spans)
        if self._members is not None:
            chosen = self._members[random.integers(len(self._members), size=len(genes)), genes]
            drawn = np.where(self._is_category[genes], chosen, drawn)
        return drawn


def _narrow_block(block: Block, lows: FloatArray, highs: FloatArray) -> Block:
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
        cuts = region.cuts[random.integers(len(region.cuts), size=couples)]
        behind = np.arange(parents.shape[1]) >= cuts[:, None]
        exchanged = behind & (random.random(couples) < self.crossover)[:, None]
        one, other = np.where(exchanged, second, first), np.where(exchanged, first, second)
        children = np.concatenate((one, other))[: len(parents)]
        if self.mutation is not None:
            return np.stack([self.mutation.mutate(c, region.space, random) for c in children])
        return self._mutate(children, region, random)

    def _mutate(
        self, values: FloatArray, region: Region, random: np.random.Generator
    ) -> FloatArray:
        """Changes each gene with probability 1 over their number, and at least one.

        Half of the changed magnitudes are redrawn, the others moved by a normal draw. Values are
        clipped to the bounds, so that both bounds occur.
        """
        varying = region.varying
        if not len(varying):
            return values
        which = random.random(values.shape) < 1.0 / len(varying)
        which[np.arange(len(values)), varying[random.integers(len(varying), size=len(values))]] = 1
        rows, genes = np.nonzero(which)
        changed = np.array(values)
        changed[rows, genes] = region.draw(genes, random)
        near = ~region.is_whole[genes] & (random.random(len(genes)) < 0.5)
        rows, genes = rows[near], genes[near]
        lows, highs = region.lows[genes], region.highs[genes]
        steps = self.step * (highs - lows) * random.standard_normal(len(genes))
        changed[rows, genes] = np.clip(values[rows, genes] + steps, lows, highs)
        return changed
