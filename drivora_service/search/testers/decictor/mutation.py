"""Decictor's mutation: actors are added, removed and changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import Block, GeneSpace, Part
from drivora_service.search.mutation import shift_genes

MOVING = (Part.VEHICLE, Part.WALKER)
STATIC = (Part.OBSTACLE,)


def optional_actors(space: GeneSpace) -> tuple[Block, ...]:
    """Returns the actors that may be absent, without egos."""
    parts = (*MOVING, *STATIC)
    return tuple(block for block in space.optional_blocks if block.part in parts)


@dataclass(frozen=True, slots=True, kw_only=True)
class ActorChanges:
    """Adds actors of one kind, or else removes some, and changes some of them a little.

    Only actors that may be absent are mutated. The mutant differs from its parent.

    Attributes:
        static_rate: Probability of obstacles, if there are other actors, too.
        most_added: Greatest number of obstacles that are added.
        removed_share: Share of the present actors that are removed if none is added.
        change_rate: Probability with which each present actor is changed.
        sigma: Standard deviation of a change, as a share of a gene's range, at strength 1.
    """

    static_rate: float
    most_added: int
    removed_share: float
    change_rate: float
    sigma: float

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy."""
        blocks, most = self._kind(space, random)
        mutant = values.copy()
        added = self._add(mutant, space, random, blocks, most)
        if not added:
            self._remove(mutant, random, blocks)
        for block in _present(values, blocks):
            if mutant[block.start] != 0.0 and random.random() < self.change_rate:
                which = np.zeros(len(space), dtype=np.bool_)
                which[block.start + 1 : block.stop] = ~space.is_category[
                    block.start + 1 : block.stop
                ]
                which &= random.random(len(space)) < 0.5
                sigma = self.sigma * strength * space.ranges
                mutant = shift_genes(mutant, space, random, which & ~space.is_whole, sigma)
        return mutant

    def _kind(self, space: GeneSpace, random: np.random.Generator) -> tuple[tuple[Block, ...], int]:
        """Chooses obstacles or the others; returns them, and how many are added at most."""
        actors = optional_actors(space)
        static = tuple(block for block in actors if block.part in STATIC)
        moving = tuple(block for block in actors if block.part in MOVING)
        is_static = random.random() < self.static_rate
        if static and (is_static or not moving):
            return static, self.most_added
        return moving, 1

    def _add(
        self,
        mutant: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        blocks: Sequence[Block],
        most: int,
    ) -> bool:
        absent = [block for block in blocks if mutant[block.start] == 0.0]
        count = min(int(random.integers(1, most + 1)), len(absent))
        fresh = space.sample(random)
        for index in random.permutation(len(absent))[:count]:
            block = absent[index]
            mutant[block.slice] = fresh[block.slice]
            mutant[block.start] = 1.0
        return count > 0

    def _remove(
        self, mutant: FloatArray, random: np.random.Generator, blocks: Sequence[Block]
    ) -> None:
        present = _present(mutant, blocks)
        count = max(int(self.removed_share * len(present)), 1)
        for index in random.permutation(len(present))[:count]:
            mutant[present[index].start] = 0.0


def _present(values: FloatArray, blocks: Sequence[Block]) -> list[Block]:
    return [block for block in blocks if values[block.start] != 0.0]
