"""AVFuzzer's search.

Li et al., *AV-FUZZER: Finding Safety Violations in Autonomous Driving Systems* (ISSRE 2020). A
generation is selected from the last by roulette, crossed and mutated; only scenarios that changed
are run. If the best costs of the last generations do not improve, the search restarts as far as
possible from all tried candidates. A new best candidate starts a local search around it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from drivora_service.errors import SearchError
from drivora_service.feedback.avfuzzer import SAFETY_MARGIN
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.aims import Guidance
from drivora_service.search.budget_bounds import MANY, MOST_CANDIDATES, within_budget
from drivora_service.search.components import Components
from drivora_service.search.distance import farthest
from drivora_service.search.mutation import RedrawSlice
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.redrawing import ATTEMPTS, MOST_ATTEMPTS, Redrawing
from drivora_service.search.selection import Roulette
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.avfuzzer.breeding import (
    Breeding,
    Individual,
    Offspring,
    Population,
    best_of,
    individual,
    proposal,
)
from drivora_service.search.testers.script import Script, ScriptedTester

Step = Generator[tuple[Proposal, ...], tuple[Evaluation, ...], Population]
"""A part of the script that returns a population."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AvfuzzerParameters:
    """Defaults from Li et al., "AV-FUZZER" (ISSRE 2020), and its public code.

    Attributes:
        population: Number of scenarios of a generation (paper: 4).
        crossover_rate: Probability with which a pair exchanges an actor (paper: 0.4).
        mutation_rate: Probability with which a scenario is mutated (paper: 0.4).
        stall: Number of generations over which the mean of the best costs is taken; if it is no
            worse than the best cost of the next generation, the search restarts (code: 5).
        restart_candidates: Number of scenarios drawn at a restart; those furthest from all past
            populations become the next one (code: 1,000).
        local_after: Number of generations after a start or restart without local searches
            (code: 2).
        local_generations: Number of generations of a local search (code: 5).
        local_factor: Mutation rate of a local search over that of the search (code: 1.5).
        local_mutates_all: Whether a local search begins by mutating all its copies (code: yes); if
            not, its first generation is bred as every other (paper).
        redraws: Number of mutants that are drawn again for one candidate, at most, as they could
            not change the run of any ego (ours; paper and code: 0).
    """

    population: Annotated[int, within_budget(2)] = 4
    crossover_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.4
    mutation_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.4
    stall: Annotated[int, Field(ge=1, le=MANY)] = 5
    restart_candidates: Annotated[int, Field(ge=1, le=MOST_CANDIDATES)] = 1000
    local_after: Annotated[int, Field(ge=0, le=MANY)] = 2
    local_generations: Annotated[int, Field(ge=0, le=MANY)] = 5
    local_factor: Annotated[float, Field(ge=0.0)] = 1.5
    local_mutates_all: bool = True
    redraws: Annotated[int, Field(ge=0, le=MOST_ATTEMPTS)] = ATTEMPTS


class AvfuzzerSearch:
    """The state of a search: past populations, and the current attempt."""

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
            redrawing=Redrawing.of(context, parameters.redraws),
        )
        self._objective = context.objective(SAFETY_MARGIN)
        self._generation = 0
        self._past: dict[int, FloatArray] = {}
        self._members: Counter[int] = Counter()

    def script(self) -> Script:
        """Searches without end, one attempt after another."""
        drawn = self._space.sample(self._random, self._parameters.population)
        population = yield from self._evaluate_new(drawn, "initial")
        while True:
            yield from self._attempt(population)
            population = yield from self._evaluate_new(self._far_from_the_past(), "restart")

    def _attempt(self, population: Population) -> Script:
        """Breeds generations until they no longer improve."""
        settings = self._parameters
        best = best_of(population)
        bests = [best.cost]
        while not self._has_stalled(bests):
            parents = self._breeding.select(population)
            offspring = self._breeding.breed(parents, settings.mutation_rate)
            population = yield from self._run(offspring)
            found = best_of(population)
            bests.append(found.cost)
            if found.cost < best.cost:
                best = found
                if len(bests) - 1 > settings.local_after:
                    local = yield from self._search_locally(best)
                    population = _replace_member(population, best, local)
                    best = local

    def _has_stalled(self, bests: list[float]) -> bool:
        """Returns whether the last best cost is no better than the mean of those before it."""
        stall = self._parameters.stall
        return len(bests) > stall and float(np.mean(bests[-stall - 1 : -1])) <= bests[-1]

    def _search_locally(
        self, best: Individual
    ) -> Generator[tuple[Proposal, ...], tuple[Evaluation, ...], Individual]:
        """Breeds some generations from copies of a scenario; returns the best of all of them."""
        settings = self._parameters
        rate = settings.mutation_rate * settings.local_factor
        population: Population = (best,) * settings.population
        for number in range(settings.local_generations):
            if number == 0 and settings.local_mutates_all:
                offspring = self._breeding.mutate_all(population)
            else:
                parents = population if number == 0 else self._breeding.select(population)
                offspring = self._breeding.breed(parents, rate)
            population = yield from self._run(offspring, "local ")
            best = best_of((best, *population))
        return best

    def _run(self, offspring: Sequence[Offspring], prefix: str = "") -> Step:
        """Runs those of a generation that changed."""
        known = [child.known for child in offspring]
        if all(same is not None for same in known):
            # A mutation that changes nothing must not let the search loop without a run.
            known[next(i for i, child in enumerate(offspring) if child.origins)] = None
        proposals = tuple(
            proposal(child, self._generation, prefix)
            for child, same in zip(offspring, known, strict=True)
            if same is None
        )
        evaluations = iter((yield proposals))
        population = tuple(
            individual(next(evaluations), self._objective) if same is None else same
            for same in known
        )
        return self._remember(population)

    def _evaluate_new(self, values: FloatArray, origin: str) -> Step:
        evaluations = yield tuple(
            Proposal(values=row, origin=origin, generation=self._generation) for row in values
        )
        return self._remember(tuple(individual(told, self._objective) for told in evaluations))

    def _remember(self, population: Population) -> Population:
        self._generation += 1
        # A scenario that survives is a member of many populations: it is compared once.
        self._past.update((one.number, one.values) for one in population)
        self._members.update(one.number for one in population)
        return population

    def _far_from_the_past(self) -> FloatArray:
        """Returns the drawn candidates furthest, on average, from all past populations."""
        settings = self._parameters
        count = max(settings.restart_candidates, settings.population)
        drawn = self._space.sample(self._random, count)
        counts = np.array([self._members[number] for number in self._past], dtype=np.float64)
        past = np.array([*self._past.values()])
        return drawn[farthest(drawn, past, counts, self._space, settings.population)]


def _replace_member(population: Population, old: Individual, new: Individual) -> Population:
    return tuple(new if one is old else one for one in population)


def _create(
    context: TesterContext, parameters: AvfuzzerParameters, components: Components
) -> ScriptedTester:
    if not context.space.varies.any():
        raise SearchError("avfuzzer needs a gene that varies; vary at least one part")
    return ScriptedTester(AvfuzzerSearch(context, parameters, components).script())


AVFUZZER = TesterPlugin(
    name="avfuzzer",
    title="AVFuzzer",
    description="a genetic algorithm with restarts and local searches around its best candidates",
    source="Li et al., AV-FUZZER: Finding Safety Violations in Autonomous Driving Systems, 2020",
    parameters=AvfuzzerParameters,
    feedback=FeedbackChoice(name="avfuzzer"),
    create=_create,
    is_generational=True,
    guidance=Guidance.ONE,
)
