"""Mutations: a candidate made from one other.

They change only genes that have an effect: genes of an absent actor have none, except the gene of
its presence. The mutant is therefore another scenario than its parent, unless the space leaves no
choice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.genes import GeneSpace
from drivora_service.search.plugin import MutationPlugin


def effective_genes(values: FloatArray, space: GeneSpace) -> BoolArray:
    """Returns which genes (..., d) can vary and would change the scenario.

    Args:
        values: (..., d) genes.
        space: Their bounds.
    """
    effective = np.empty(values.shape, dtype=np.bool_)
    effective[...] = space.varies
    for block in space.optional_blocks:
        is_there = values[..., block.start] != 0.0
        effective[..., block.start + 1 : block.stop] &= is_there[..., None]
    return effective


def redraw_genes(
    values: FloatArray, space: GeneSpace, random: np.random.Generator, which: BoolArray
) -> FloatArray:
    """Returns a copy in which some genes are redrawn; whole genes get a different value.

    Args:
        values: (d,) genes of the parent.
        space: Their bounds.
        random: Generator for every draw.
        which: (d,) genes to redraw; those that cannot vary are not changed.
    """
    drawn = random.random(len(space))
    steps = 1.0 + np.floor(drawn * space.at_least_one)
    other = space.lows + (values - space.lows + steps) % space.cells
    fresh = np.where(space.is_whole, other, space.scale_in_place(drawn))
    return np.where(which & space.varies, fresh, values)


def shift_genes(
    values: FloatArray,
    space: GeneSpace,
    random: np.random.Generator,
    which: BoolArray,
    sigma: FloatArray | float,
) -> FloatArray:
    """Returns a copy in which some genes are moved by normal draws; whole genes by at least 1.

    Values are reflected at the bounds, so that they do not accumulate there.

    Args:
        values: (d,) genes of the parent.
        space: Their bounds.
        random: Generator for every draw.
        which: (d,) genes to move; those that cannot vary are not changed.
        sigma: Standard deviation in the genes' own units, (d,) or one for all.
    """
    draws = random.standard_normal(len(space)) * sigma
    at_least_one = np.copysign(np.maximum(np.round(np.abs(draws)), 1.0), draws)
    moves = np.where(space.is_whole, at_least_one, draws)
    way = (values + moves - space.lows) % space.both_ways
    reflected = space.lows + np.minimum(way, space.both_ways - way)
    return np.where(which & space.varies, space.clip(reflected), values)


@dataclass(frozen=True, slots=True, kw_only=True)
class GaussianMutation:
    """Moves magnitudes by normal draws and redraws some categories; changes at least one gene.

    Attributes:
        rate: Probability with which a magnitude moves.
        sigma: Standard deviation as a share of the gene's range, at strength 1.
        category_rate: Probability with which a category is redrawn, at strength 1.
    """

    rate: float = 0.2
    sigma: float = 0.1
    category_rate: float = 0.1

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy."""
        effective = effective_genes(values, space)
        rates = np.where(space.is_category, self.category_rate * strength, self.rate)
        which = effective & (random.random(len(space)) < rates)
        if effective.any() and not which.any():
            which[random.choice(np.flatnonzero(effective))] = True
        sigma = self.sigma * strength * space.ranges
        moved = shift_genes(values, space, random, which & ~space.is_category, sigma)
        return redraw_genes(moved, space, random, which & space.is_category)


@dataclass(frozen=True, slots=True, kw_only=True)
class RedrawGene:
    """Redraws one gene; at strength s, s genes on average and at least one."""

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy."""
        choices = np.flatnonzero(effective_genes(values, space))
        chosen = random.permutation(choices)[: _number(strength, random)]
        return redraw_genes(values, space, random, _mask(chosen, space))


@dataclass(frozen=True, slots=True, kw_only=True)
class RedrawBlock:
    """Redraws an actor as a whole; at strength s, s actors on average and at least one.

    An absent actor becomes present; a present optional one becomes absent with probability 1/2.
    """

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy."""
        blocks = space.varying_blocks
        fresh = space.sample(random)
        changed = values.copy()
        for index in random.permutation(len(blocks))[: _number(strength, random)]:
            block = blocks[index]
            changed[block.slice] = fresh[block.slice]
            if block.is_optional and values[block.start] == 0.0:
                changed[block.start] = 1.0
            if np.array_equal(changed[block.slice], values[block.slice]):
                all_of_it = _mask(range(block.start, block.stop), space)
                changed = redraw_genes(changed, space, random, all_of_it)
        return changed


@dataclass(frozen=True, slots=True, kw_only=True)
class RedrawSlice:
    """Redraws one gene of one time slice of one actor; at strength s, s times on average.

    The actor is drawn first, then the slice (the genes with the same number), then the gene; so
    actors with many genes do not change more often than others. The other genes of an actor (its
    path, its start) count as one more slice.
    """

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy."""
        changed = values.copy()
        blocks = space.varying_slices
        for _ in range(_number(strength, random) if blocks else 0):
            block, slices = blocks[random.integers(len(blocks))]
            if block.is_optional and changed[block.start] == 0.0:
                # Of an absent actor, only its presence has an effect.
                slices = ((block.start,),)
            genes = slices[random.integers(len(slices))]
            chosen = genes[random.integers(len(genes))]
            changed = redraw_genes(changed, space, random, _mask([chosen], space))
        return changed


def _number(strength: float, random: np.random.Generator) -> int:
    """Draws a whole number whose mean is the strength, at least 1."""
    return max(int(strength + random.random()), 1)


def _mask(indices: Sequence[int] | range | IntArray, space: GeneSpace) -> BoolArray:
    mask = np.zeros(len(space), dtype=np.bool_)
    mask[list(indices)] = True
    return mask


GAUSSIAN = MutationPlugin(
    name="gaussian",
    description="moves magnitudes by normal draws and redraws some categories",
    create=GaussianMutation,
)
REDRAW_GENE = MutationPlugin(name="redraw-gene", description="redraws one gene", create=RedrawGene)
REDRAW_BLOCK = MutationPlugin(
    name="redraw-block", description="redraws an actor as a whole", create=RedrawBlock
)
REDRAW_SLICE = MutationPlugin(
    name="redraw-slice",
    description="redraws one gene of one time slice of one actor",
    create=RedrawSlice,
)
