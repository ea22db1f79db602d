"""The mutation: one section of a candidate changes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import GeneSpace
from drivora_service.search.mutation import redraw_genes
from drivora_service.search.testers.doppeltest.chromosome import PATH, Chromosome
from drivora_service.search.testers.doppeltest.parameters import DoppelTestParameters

LEAST_EGOS = 2

_CROSSING = (PATH, "place", "side")
"""Genes of a walker for the place of its crossing, like the crosswalk in the paper."""
_ONE_LIGHT_GENE = 0.9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DoppelTestMutation:
    """Changes the egos, the walkers or the lights, with equal probability.

    Attributes:
        chromosome: The sections.
        parameters: The rates.
    """

    chromosome: Chromosome
    parameters: DoppelTestParameters

    def mutate(
        self,
        values: FloatArray,
        space: GeneSpace,
        random: np.random.Generator,
        *,
        strength: float = 1.0,
    ) -> FloatArray:
        """Returns a changed copy; at strength s, changed s times."""
        changed = values.copy()
        sections = [self._mutate_egos]
        if self.chromosome.walkers.most:
            sections.append(self._mutate_walkers)
        if len(self.chromosome.lights):
            sections.append(self._mutate_lights)
        for _ in range(max(round(strength), 1)):
            changed = sections[random.integers(len(sections))](changed, space, random)
        return changed

    def _mutate_egos(
        self, values: FloatArray, space: GeneSpace, random: np.random.Generator
    ) -> FloatArray:
        egos, rates = self.chromosome.egos, self.parameters
        taken = egos.taken_slots(values)
        draw = random.random()
        if draw < rates.remove_ego and len(taken) > max(egos.least, LEAST_EGOS):
            egos.remove(values, _one_of(taken, random))
        elif draw < rates.remove_ego + rates.add_ego and len(taken) < egos.most:
            egos.add(values, self.chromosome.draw_ego(random, self.chromosome.paths(values)))
        else:
            egos.redraw(values, _one_of(taken, random), space, random, keep=(PATH,))
        self.chromosome.start_early(values)
        return values

    def _mutate_walkers(
        self, values: FloatArray, space: GeneSpace, random: np.random.Generator
    ) -> FloatArray:
        walkers, rates = self.chromosome.walkers, self.parameters
        taken = walkers.taken_slots(values)
        draw = random.random()
        if not taken:
            walkers.add(values, walkers.draw(space, random))
        elif draw < rates.remove_walker and len(taken) > walkers.least:
            walkers.remove(values, _one_of(taken, random))
        elif draw < rates.remove_walker + rates.add_walker and len(taken) < walkers.most:
            walkers.add(values, walkers.draw(space, random))
        else:
            walkers.redraw(values, _one_of(taken, random), space, random, keep=_CROSSING)
        return values

    def _mutate_lights(
        self, values: FloatArray, space: GeneSpace, random: np.random.Generator
    ) -> FloatArray:
        which = np.zeros(len(space), dtype=np.bool_)
        lights = self.chromosome.lights
        which[random.choice(lights) if random.random() < _ONE_LIGHT_GENE else lights] = True
        return redraw_genes(values, space, random, which)


def _one_of(slots: list[int], random: np.random.Generator) -> int:
    return slots[random.integers(len(slots))]
