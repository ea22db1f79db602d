"""A section of a chromosome: the egos, or the walkers, as a list of actors.

The blocks of one part are slots of equal genes, some of which may be empty. An empty slot's genes
are at their lower bounds, so that equal scenarios have equal genes. All changes are made in place,
in the copy that an operator works on.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.genes import Block, GeneSpace


class ActorSection:
    """The actors of one part, in slots.

    Attributes:
        blocks: One a slot.
        least: Number of slots that are never empty.
        most: Number of slots.
    """

    def __init__(self, blocks: tuple[Block, ...]) -> None:
        self.blocks = blocks
        self.most = len(blocks)
        self._optional = [slot for slot, block in enumerate(blocks) if block.is_optional]
        self.least = self.most - len(self._optional)

    def taken(self, values: FloatArray) -> list[int]:
        """Returns the slots that hold an actor."""
        return [slot for slot, block in enumerate(self.blocks) if values[block.start] > 0.0]

    def actor(self, values: FloatArray, slot: int) -> FloatArray:
        """Returns a copy of an actor's genes."""
        return values[self.blocks[slot].slice].copy()

    def actors(self, values: FloatArray) -> list[FloatArray]:
        """Returns copies of the genes of all actors."""
        return [self.actor(values, slot) for slot in self.taken(values)]

    def gene(self, values: FloatArray, slot: int, name: str) -> float:
        """Returns one gene of an actor."""
        return float(values[self.blocks[slot].index(name)])

    def put(self, values: FloatArray, slot: int, actor: FloatArray) -> None:
        """Puts an actor into a slot."""
        block = self.blocks[slot]
        values[block.slice] = actor
        values[block.start] = 1.0

    def add(self, values: FloatArray, actor: FloatArray) -> None:
        """Puts an actor into the first empty slot."""
        taken = self.taken(values)
        self.put(values, next(slot for slot in range(self.most) if slot not in taken), actor)

    def remove(self, values: FloatArray, slot: int) -> None:
        """Removes an actor; the last of the others moves into a slot that is never empty."""
        if slot not in self._optional:
            last = [other for other in self.taken(values) if other in self._optional][-1]
            self.put(values, slot, self.actor(values, last))
            slot = last
        self._clear(values, slot)

    def fill(self, values: FloatArray, actors: Sequence[FloatArray]) -> None:
        """Replaces the actors by others, up to the number of slots."""
        slots = sorted(range(self.most), key=lambda slot: slot in self._optional)
        for place, slot in enumerate(slots):
            if place < len(actors):
                self.put(values, slot, actors[place])
            else:
                self._clear(values, slot)

    def draw(self, space: GeneSpace, random: np.random.Generator) -> FloatArray:
        """Draws an actor."""
        return space.sample(random)[self.blocks[0].slice]

    def redraw(
        self,
        values: FloatArray,
        slot: int,
        space: GeneSpace,
        random: np.random.Generator,
        keep: Sequence[str],
    ) -> None:
        """Redraws an actor, except for the genes of the given names."""
        block = self.blocks[slot]
        kept = {name: values[block.index(name)] for name in keep}
        self.put(values, slot, self.draw(space, random))
        for name, value in kept.items():
            values[block.index(name)] = value

    def _clear(self, values: FloatArray, slot: int) -> None:
        block = self.blocks[slot]
        values[block.slice] = [gene.low for gene in block.genes]
