"""AVFuzzer's operators: selection, crossover and mutation of a generation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from drivora_service.feedback.avfuzzer import SAFETY_MARGIN
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.search.components import Mutation, Selection
from drivora_service.search.crossover import exchange_block
from drivora_service.search.genes import GeneSpace
from drivora_service.search.redrawing import Redrawing, without_effect
from drivora_service.search.tester import Evaluation, Proposal


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Individual:
    """An evaluated scenario.

    Attributes:
        values: (d,) genes.
        cost: The objective, to be minimised (its own is in metres); infinite if not measurable.
        number: Number of its evaluation.
        without_effect: (d,) genes without effect in its run.
    """

    values: FloatArray
    cost: float
    number: int
    without_effect: BoolArray


Population = tuple[Individual, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Offspring:
    """A scenario of the next generation.

    Attributes:
        values: (d,) genes.
        origins: Names of the operators that changed it, in order.
        parents: Individuals from which it has genes; it replaces the first.
        redrawn: Number of mutants that were drawn again for it.
    """

    values: FloatArray
    origins: tuple[str, ...]
    parents: Population
    redrawn: int = 0

    @property
    def known(self) -> Individual | None:
        """Its parent if the scenario is the same and need not be run again."""
        for parent in self.parents:
            if parent.values is self.values or bool((parent.values == self.values).all()):
                return parent
        return None


def individual(evaluation: Evaluation, objective: str = SAFETY_MARGIN) -> Individual:
    """Returns the individual of an evaluation, whose cost is an objective."""
    measured = evaluation.measurement
    cost = None if measured is None else measured.objectives[objective]
    return Individual(
        values=evaluation.proposal.values,
        cost=math.inf if cost is None else cost,
        number=evaluation.number,
        without_effect=without_effect(evaluation),
    )


def best_of(population: Population) -> Individual:
    """Returns the best individual, the first among equals."""
    return min(population, key=lambda one: one.cost)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Breeding:
    """The genetic operators.

    Attributes:
        space: Bounds of the genes.
        random: Generator for every draw.
        mutation: Changes a scenario.
        selection: Draws the parents.
        crossover_rate: Probability with which a pair exchanges an actor.
        redrawing: Draws mutants again that could not change the run.
    """

    space: GeneSpace
    random: np.random.Generator
    mutation: Mutation
    selection: Selection
    crossover_rate: float
    redrawing: Redrawing

    def select(self, population: Population) -> Population:
        """Draws as many parents as the population has members, with repetition."""
        costs = np.array([[one.cost] for one in population])
        chosen = self.selection.select(costs, len(population), self.random)
        return tuple(population[index] for index in chosen)

    def breed(self, parents: Population, mutation_rate: float) -> tuple[Offspring, ...]:
        """Crosses and mutates.

        At least one of the offspring differs from its parent, else the search would not advance.
        """
        offspring = [Offspring(values=one.values, origins=(), parents=(one,)) for one in parents]
        for _ in range(len(parents) // 2):
            if self.random.random() < self.crossover_rate:
                one, other = self.random.permutation(len(offspring))[:2]
                offspring[one], offspring[other] = self._cross(offspring[one], offspring[other])
        mutated = self.random.random(len(offspring)) < mutation_rate
        if not mutated.any() and all(child.known is not None for child in offspring):
            mutated[self.random.integers(len(offspring))] = True
        return tuple(
            self._mutate(child) if changes else child
            for child, changes in zip(offspring, mutated, strict=True)
        )

    def mutate_all(self, parents: Population) -> tuple[Offspring, ...]:
        """Mutates every scenario, and crosses none."""
        return tuple(
            self._mutate(Offspring(values=one.values, origins=(), parents=(one,)))
            for one in parents
        )

    def _cross(self, one: Offspring, other: Offspring) -> tuple[Offspring, Offspring]:
        values = exchange_block(one.values, other.values, self.space, self.random)
        return (
            _derive_offspring(one, values[0], "crossover", other.parents),
            _derive_offspring(other, values[1], "crossover", one.parents),
        )

    def _mutate(self, one: Offspring) -> Offspring:
        parent = one.parents[0]
        values, redrawn = self.redrawing.draw(
            lambda: self.mutation.mutate(one.values, self.space, self.random),
            parent.values,
            parent.without_effect,
        )
        return replace(_derive_offspring(one, values, "mutation"), redrawn=redrawn)


def _derive_offspring(
    one: Offspring, values: FloatArray, origin: str, parents: Population = ()
) -> Offspring:
    origins = one.origins if origin in one.origins else (*one.origins, origin)
    unique = {parent.number: parent for parent in (*one.parents, *parents)}
    return Offspring(values=values, origins=origins, parents=tuple(unique.values()))


def proposal(offspring: Offspring, generation: int, prefix: str = "") -> Proposal:
    """Returns the proposal of an offspring; ``prefix`` is put before its origin."""
    return Proposal(
        values=offspring.values,
        origin=prefix + " and ".join(offspring.origins),
        generation=generation,
        parents=tuple(parent.number for parent in offspring.parents),
        redrawn=offspring.redrawn,
    )
