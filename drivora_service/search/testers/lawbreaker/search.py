"""LawBreaker's search: coverage-guided breeding towards violations of traffic laws.

Sun et al., *LawBreaker: An Approach for Specifying Traffic Laws and Fuzzing Autonomous Vehicles*
(ASE 2022). Each law is split into the ways to violate it. The scenario nearest to each way that no
run has covered is kept, and the next generation is bred from these; a way that a run covers is
retired. The public code filled the slot of the elite with the worst scenario; here the kept
scenarios are the nearest, and need not be run again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.aims import Guidance
from drivora_service.search.budget_bounds import MANY, MOST_CANDIDATES, within_budget
from drivora_service.search.components import Components
from drivora_service.search.crossover import one_point
from drivora_service.search.mutation import GaussianMutation
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.lawbreaker.archive import Archive, Individual
from drivora_service.search.testers.script import Script, ScriptedTester

_FLAT = 1.0
"""Cost of a sub-violation that a scenario is not near to at all: its robustness is the least."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LawbreakerParameters:
    """Defaults from Sun et al., "LawBreaker" (ASE 2022); the others are ours.

    Attributes:
        laws: Names of the laws whose sub-violations are searched for; none: all that judge runs.
        population: Number of scenarios of a generation (paper: 20).
        generations: Number of generations after which a new population is drawn (paper: 20).
        crossover_rate: Probability with which a child is crossed with a second parent.
        mutation_rate: Probability with which a child is mutated; one that equals its parent always
            is.
        tournament: Number of scenarios of which the second parent is the one nearest to the
            violation.
    """

    laws: tuple[str, ...] = ()
    population: Annotated[int, within_budget(2)] = 20
    generations: Annotated[int, Field(ge=1, le=MANY)] = 20
    crossover_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    mutation_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    tournament: Annotated[int, Field(ge=1, le=MOST_CANDIDATES)] = 2


class LawbreakerSearch:
    """The state of a search: what is covered, and the scenarios nearest to the rest."""

    def __init__(
        self, context: TesterContext, parameters: LawbreakerParameters, components: Components
    ) -> None:
        self._space, self._random = context.space, context.random
        self._parameters = parameters
        self._mutation = components.mutation or GaussianMutation()
        self.archive = Archive(parameters.laws, context.aims)
        self._generation = 0

    def script(self) -> Script:
        """Searches without end: populations, each bred for some generations."""
        origin = "initial"
        while True:
            population = self._archive_generation((yield self._draw_proposals(origin)))
            for _ in range(self._parameters.generations - 1):
                targets = self._targets()
                if not targets:
                    break
                population = self._archive_generation(
                    (yield self._breed_proposals(targets, population))
                )
            origin = "restart"

    def _targets(self) -> tuple[tuple[str, Individual], ...]:
        """Returns the uncovered sub-violations with their nearest scenarios.

        Those that no scenario is near to give no direction, and are left out while there are
        others.
        """
        nearest = tuple(self.archive.nearest.items())
        near = tuple((name, one) for name, one in nearest if one.costs[name] < _FLAT)
        return near or nearest

    def _draw_proposals(self, origin: str) -> tuple[Proposal, ...]:
        drawn = self._space.sample(self._random, self._parameters.population)
        return tuple(
            Proposal(values=row, origin=origin, generation=self._generation) for row in drawn
        )

    def _breed_proposals(
        self, targets: tuple[tuple[str, Individual], ...], population: tuple[Individual, ...]
    ) -> tuple[Proposal, ...]:
        """Returns the next generation: the targets take turns as what a child is bred towards."""
        first = int(self._random.integers(len(targets)))
        return tuple(
            self._child(*targets[(first + place) % len(targets)], population)
            for place in range(self._parameters.population)
        )

    def _child(
        self, target: str, parent: Individual, population: tuple[Individual, ...]
    ) -> Proposal:
        values, origins, parents = parent.values, [], [parent]
        if population and self._random.random() < self._parameters.crossover_rate:
            mate = self._mate(target, population)
            values = self._cross(values, mate.values)
            if (values != parent.values).any():
                origins.append("crossover")
                parents.append(mate)
        if self._random.random() < self._parameters.mutation_rate or not origins:
            values = self._mutation.mutate(values, self._space, self._random)
            origins.append("mutation")
            if any(np.array_equal(values, one.values) for one in parents):
                # What the crossover changed was changed back.
                values = self._mutation.mutate(values, self._space, self._random)
        return Proposal(
            values=values,
            origin=" and ".join(origins),
            generation=self._generation,
            parents=tuple(one.number for one in parents),
        )

    def _cross(self, first: FloatArray, second: FloatArray) -> FloatArray:
        children = one_point(first, second, self._space, self._random)
        return children[int(self._random.integers(2))]

    def _mate(self, target: str, population: tuple[Individual, ...]) -> Individual:
        """Returns the one of some drawn scenarios that is nearest to a sub-violation."""
        size = min(self._parameters.tournament, len(population))
        drawn = self._random.choice(len(population), size=size, replace=False)
        mates: list[Individual] = [population[int(place)] for place in drawn]
        return min(mates, key=lambda one: one.costs[target])

    def _archive_generation(self, evaluations: tuple[Evaluation, ...]) -> tuple[Individual, ...]:
        """Returns the measured scenarios of a generation, after they are in the archive."""
        self._generation += 1
        found = [self.archive.individual(evaluation) for evaluation in evaluations]
        population = tuple(one for one in found if one is not None)
        for one in population:
            self.archive.add(one)
        return population


def _create(
    context: TesterContext, parameters: LawbreakerParameters, components: Components
) -> ScriptedTester:
    if parameters.laws and context.aims:
        chosen = ", ".join(aim.name for aim in context.aims)
        raise SearchError(
            f"the parameter `laws` chooses sub-violations, and the campaign's feedback {chosen}; "
            "leave one of them out"
        )
    if not context.space.varies.any():
        raise SearchError("lawbreaker needs a gene that varies; vary at least one part")
    return ScriptedTester(LawbreakerSearch(context, parameters, components).script())


LAWBREAKER = TesterPlugin(
    name="lawbreaker",
    title="LawBreaker",
    description="breeds from the scenarios nearest to each uncovered violation of a traffic law",
    source="Sun et al., LawBreaker: An Approach for Specifying Traffic Laws and Fuzzing Autonomous "
    "Vehicles, 2022",
    parameters=LawbreakerParameters,
    feedback=FeedbackChoice(name="lawbreaker"),
    create=_create,
    is_generational=True,
    guidance=Guidance.SEVERAL,
)
