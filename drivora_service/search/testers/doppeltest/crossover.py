"""The crossover: a candidate inherits from another in one section."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.selection import cumulate_probabilities
from drivora_service.search.testers.doppeltest.chromosome import PATH, START_TIME, Chromosome
from drivora_service.search.testers.doppeltest.parameters import DoppelTestParameters

_ALL_EGOS = 0.05
_ALL_WALKERS = 0.1
_ALL_LIGHTS = 0.1


class DoppelTestCrossover:
    """Operator that combines two parents into one child."""

    def __init__(self, *, chromosome: Chromosome, parameters: DoppelTestParameters) -> None:
        """Creates the operator.

        Args:
            chromosome: The sections.
            parameters: Shares; that of a section that the space lacks goes to the others.
        """
        self.chromosome = chromosome
        egos, walkers = parameters.cross_egos, parameters.cross_walkers
        self._sections: list[Callable[..., None]] = [self._cross_egos]
        shares = [egos]
        if chromosome.walkers.most:
            self._sections.append(self._cross_walkers)
            shares.append(walkers)
        if len(chromosome.lights):
            self._sections.append(self._cross_lights)
            shares.append(max(1.0 - egos - walkers, 0.0))
        # If all shares are 0, all sections are equally likely.
        self._cumulated = (
            cumulate_probabilities(np.array(shares) / np.sum(shares)) if any(shares) else None
        )

    def cross(
        self, first: FloatArray, second: FloatArray, random: np.random.Generator
    ) -> FloatArray:
        """Returns a copy of the first parent with one section changed by the second's."""
        child = first.copy()
        if self._cumulated is None:
            number = random.integers(len(self._sections))
        else:
            number = self._cumulated.searchsorted(random.random(), side="right")
        self._sections[number](child, second, random)
        return child

    def _cross_egos(
        self, child: FloatArray, other: FloatArray, random: np.random.Generator
    ) -> None:
        """Copies all egos, or the start or start time of one on the same path, or one ego.

        Else both parents' egos are shuffled, and the child gets some of them.
        """
        egos = self.chromosome.egos
        if random.random() < _ALL_EGOS:
            for slot in range(egos.most):
                child[egos.blocks[slot].slice] = other[egos.blocks[slot].slice]
        elif not self._copy_starts(child, other, random) and not self._add_conflicting_ego(
            child, other
        ):
            pool = egos.actors(child) + egos.actors(other)
            fewest = max(egos.least, 2)
            count = int(random.integers(fewest, min(len(pool), egos.most) + 1))
            chosen = random.permutation(len(pool))[:count]
            egos.fill(child, [pool[index] for index in chosen])
        self.chromosome.start_early(child)

    def _copy_starts(
        self, child: FloatArray, other: FloatArray, random: np.random.Generator
    ) -> bool:
        """Copies the start or the start time of egos on the same path; returns whether any exist.

        The place and the time have probability 1/2 each.
        """
        egos = self.chromosome.egos
        slots, places = egos.taken_slots(child), egos.taken_slots(other)
        paths = list(zip(places, egos.genes(other, places, PATH), strict=True))
        found = False
        for slot, path in zip(slots, egos.genes(child, slots, PATH), strict=True):
            for place, its_path in paths:
                if path != its_path:
                    continue
                found = True
                gene = "start" if random.random() < 0.5 else START_TIME
                child[egos.index(slot, gene)] = other[egos.index(place, gene)]
        return found

    def _add_conflicting_ego(self, child: FloatArray, other: FloatArray) -> bool:
        """Adds the other's first ego with a path that conflicts with one of the child's, if any."""
        egos, paths = self.chromosome.egos, self.chromosome.paths(child)
        if len(paths) == egos.most:
            return False
        for slot in egos.taken_slots(other):
            if self.chromosome.conflicts.between(egos.gene(other, slot, PATH), paths):
                egos.add(child, egos.actor(other, slot))
                return True
        return False

    def _cross_walkers(
        self, child: FloatArray, other: FloatArray, random: np.random.Generator
    ) -> None:
        """Copies all walkers; more often, the child gets some of both parents'."""
        walkers = self.chromosome.walkers
        pool = walkers.actors(child) + walkers.actors(other)
        if random.random() < _ALL_WALKERS:
            walkers.fill(child, walkers.actors(other))
            return
        count = int(random.integers(walkers.least, min(len(pool), walkers.most) + 1))
        chosen = random.permutation(len(pool))[:count]
        walkers.fill(child, [pool[index] for index in chosen])

    def _cross_lights(
        self, child: FloatArray, other: FloatArray, random: np.random.Generator
    ) -> None:
        """Copies one gene of the lights; sometimes all."""
        lights = self.chromosome.lights
        which = lights if random.random() < _ALL_LIGHTS else random.choice(lights)
        child[which] = other[which]
