"""A section of a chromosome: the egos, or the walkers, as a list of actors.

The blocks of one part are slots of equal genes, some of which may be empty. An empty slot's genes
are at their lower bounds, so that equal scenarios have equal genes. All changes are made in place,
in the copy that an operator works on.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
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
        self._filled = sorted(range(self.most), key=lambda slot: slot in self._optional)
        self._presence = [block.start for block in blocks]
        self._slices = [block.slice for block in blocks]
        names = [gene.name for gene in blocks[0].genes] if blocks else []
        # Slots have equal genes.
        self._offsets = {name: offset for offset, name in enumerate(names)}
        self._empty = [np.array([gene.low for gene in block.genes]) for block in blocks]

    def taken_slots(self, values: FloatArray) -> list[int]:
        """Returns the slots that hold an actor."""
        # A few genes of a vector are read faster one by one.
        return [slot for slot, gene in enumerate(self._presence) if values.item(gene) > 0.0]

    def index(self, slot: int, name: str) -> int:
        """Returns the index in the vector of a gene of an actor."""
        return self._presence[slot] + self._offsets[name]

    def actor(self, values: FloatArray, slot: int) -> FloatArray:
        """Returns a copy of an actor's genes."""
        return values[self._slices[slot]].copy()

    def actors(self, values: FloatArray) -> list[FloatArray]:
        """Returns copies of the genes of all actors."""
        return [self.actor(values, slot) for slot in self.taken_slots(values)]

    def gene(self, values: FloatArray, slot: int, name: str) -> float:
        """Returns one gene of an actor."""
        return float(values.item(self.index(slot, name)))

    def genes(self, values: FloatArray, slots: Sequence[int], name: str) -> list[float]:
        """Returns one gene of each of some actors."""
        offset = self._offsets[name]
        return [values.item(self._presence[slot] + offset) for slot in slots]

    def put(self, values: FloatArray, slot: int, actor: FloatArray) -> None:
        """Puts an actor into a slot."""
        values[self._slices[slot]] = actor
        values[self._presence[slot]] = 1.0

    def add(self, values: FloatArray, actor: FloatArray) -> None:
        """Puts an actor into the first empty slot."""
        taken = self.taken_slots(values)
        self.put(values, next(slot for slot in range(self.most) if slot not in taken), actor)

    def remove(self, values: FloatArray, slot: int) -> None:
        """Removes an actor; the last of the others moves into a slot that is never empty."""
        if slot not in self._optional:
            last = [other for other in self.taken_slots(values) if other in self._optional][-1]
            self.put(values, slot, self.actor(values, last))
            slot = last
        self._clear(values, slot)

    def fill(self, values: FloatArray, actors: Sequence[FloatArray]) -> None:
        """Replaces the actors by others, up to the number of slots."""
        for place, slot in enumerate(self._filled):
            if place < len(actors):
                self.put(values, slot, actors[place])
            else:
                self._clear(values, slot)

    def draw(self, space: GeneSpace, random: np.random.Generator) -> FloatArray:
        """Returns the genes of an actor, drawn from a sample of the whole space."""
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
        kept = {name: values[self.index(slot, name)] for name in keep}
        self.put(values, slot, self.draw(space, random))
        for name, value in kept.items():
            values[self.index(slot, name)] = value

    def _clear(self, values: FloatArray, slot: int) -> None:
        values[self._slices[slot]] = self._empty[slot]
