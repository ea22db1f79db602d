"""AVFuzzer's way of working.

Li et al., *AV-FUZZER: Finding Safety Violations in Autonomous Driving Systems* (ISSRE 2020). A
generation is selected from the last by roulette, crossed and mutated; only scenarios that changed
are run. Where the bests of the last generations do not get better, the search starts again, as far
as possible from all that was tried. A new best is searched around before the search goes on.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.components import Components
from drivora_service.search.distance import candidate_distances
from drivora_service.search.mutation import RedrawSlice
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.selection import Roulette
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.avfuzzer.breeding import (
    Breeding,
    Individual,
    Population,
    best_of,
    individual,
    proposal,
)
from drivora_service.search.testers.avfuzzer.parameters import AvfuzzerParameters
from drivora_service.search.testers.script import Script, ScriptedTester

Step = Generator[tuple[Proposal, ...], tuple[Evaluation, ...], Population]
"""A part of the script that ends with a population."""


class AvfuzzerSearch:
    """The state of a search: what was tried, and how the present attempt does."""

    def __init__(
        self, context: TesterContext, parameters: AvfuzzerParameters, components: Components
    ) -> None:
        self._space, self._random = context.space, context.random
        self._parameters = parameters
        self._breeding = Breeding(
            space=context.space,
            random=context.random,
            mutation=components.mutation or RedrawSlice(),
            selection=components.selection or Roulette(),
            crossover_rate=parameters.crossover_rate,
        )
        self._generation = 0
        self._past: list[FloatArray] = []

    def script(self) -> Script:
        """Searches without end, one attempt after the other."""
        drawn = self._space.sample(self._random, self._parameters.population)
        population = yield from self._evaluate_new(drawn, "initial")
        while True:
            yield from self._attempt(population)
            population = yield from self._evaluate_new(self._far_from_the_past(), "restart")

    def _attempt(self, population: Population) -> Script:
        """Breeds generation after generation until they do not get better any more."""
        settings = self._parameters
        best = best_of(population)
        bests = [best.cost]
        while not self._has_stalled(bests):
            parents = self._breeding.select(population)
            population = yield from self._next(parents, settings.mutation_rate)
            found = best_of(population)
            bests.append(found.cost)
            if found.cost < best.cost:
                best = found
                if len(bests) - 1 > settings.local_after:
                    local = yield from self._search_around(best)
                    population = _replaced(population, best, local)
                    best = local

    def _has_stalled(self, bests: list[float]) -> bool:
        """Whether the last best is no better than the mean of those before it."""
        stall = self._parameters.stall
        return len(bests) > stall and float(np.mean(bests[-stall - 1 : -1])) <= bests[-1]

    def _search_around(
        self, best: Individual
    ) -> Generator[tuple[Proposal, ...], tuple[Evaluation, ...], Individual]:
        """Breeds some generations from copies of a scenario, and gives the best of it and them."""
        settings = self._parameters
        rate = settings.mutation_rate * settings.local_factor
        population: Population = (best,) * settings.population
        for number in range(settings.local_generations):
            parents = population if number == 0 else self._breeding.select(population)
            population = yield from self._next(parents, rate, "local ")
            best = best_of((best, *population))
        return best

    def _next(self, parents: Population, mutation_rate: float, prefix: str = "") -> Step:
        """Breeds a generation and runs those that changed."""
        offspring = self._breeding.breed(parents, mutation_rate)
        known = [child.known for child in offspring]
        if all(same is not None for same in known):
            # A mutation that changes nothing must not let the search turn without a run.
            known[next(i for i, child in enumerate(offspring) if child.origins)] = None
        proposals = tuple(
            proposal(child, self._generation, prefix)
            for child, same in zip(offspring, known, strict=True)
            if same is None
        )
        evaluations = iter((yield proposals))
        population = tuple(
            individual(next(evaluations)) if same is None else same for same in known
        )
        return self._remember(population)

    def _evaluate_new(self, values: FloatArray, origin: str) -> Step:
        evaluations = yield tuple(
            Proposal(values=row, origin=origin, generation=self._generation) for row in values
        )
        return self._remember(tuple(individual(told) for told in evaluations))

    def _remember(self, population: Population) -> Population:
        self._generation += 1
        self._past.append(np.array([one.values for one in population]))
        return population

    def _far_from_the_past(self) -> FloatArray:
        """Draws candidates and gives those furthest, on average, from all past populations."""
        settings = self._parameters
        count = max(settings.restart_candidates, settings.population)
        drawn = self._space.sample(self._random, count)
        means = candidate_distances(drawn, np.concatenate(self._past), self._space).mean(axis=1)
        return drawn[np.argsort(-means, kind="stable")[: settings.population]]


def _replaced(population: Population, old: Individual, new: Individual) -> Population:
    return tuple(new if one is old else one for one in population)


def _create(
    context: TesterContext, parameters: AvfuzzerParameters, components: Components
) -> ScriptedTester:
    if not context.space.varies.any():
        raise SearchError("avfuzzer needs something to vary; let the space vary at least one thing")
    return ScriptedTester(AvfuzzerSearch(context, parameters, components).script())


AVFUZZER = TesterPlugin(
    name="avfuzzer",
    title="AVFuzzer",
    description="a genetic algorithm that restarts where it stalls and searches around its bests",
    source="Li et al., AV-FUZZER: Finding Safety Violations in Autonomous Driving Systems, 2020",
    parameters=AvfuzzerParameters,
    feedback=FeedbackChoice(name="avfuzzer"),
    create=_create,
    is_generational=True,
)
