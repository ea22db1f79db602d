"""DoppelTest as a script: seeds, then generation after generation of NSGA-II (mu + lambda)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.search.aims import Guidance
from drivora_service.search.components import Components, Mutation, Selection
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.redrawing import Redrawing, without_effect
from drivora_service.search.selection import Truncation
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.doppeltest.chromosome import Chromosome
from drivora_service.search.testers.doppeltest.crossover import DoppelTestCrossover
from drivora_service.search.testers.doppeltest.mutation import DoppelTestMutation
from drivora_service.search.testers.doppeltest.parameters import DoppelTestParameters
from drivora_service.search.testers.doppeltest.seeds import draw_seed
from drivora_service.search.testers.doppeltest.violations import ViolationLog
from drivora_service.search.testers.script import Script, ScriptedTester

_ATTEMPTS = 20
"""Number of attempts to make a child that differs from all earlier proposals."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Individual:
    """A judged candidate.

    Attributes:
        number: Number of its evaluation.
        values: (d,) genes.
        objectives: Objectives of the feedback, or those that the campaign chose, then the negated
            number of new violations; NaN is not measurable.
        without_effect: (d,) genes without effect in its run.
    """

    number: int
    values: FloatArray
    objectives: tuple[float, ...]
    without_effect: BoolArray


class DoppelTest:
    """The method.

    Attributes:
        population: The survivors.
        violations: The violations found.
    """

    def __init__(
        self, context: TesterContext, parameters: DoppelTestParameters, components: Components
    ) -> None:
        """Creates the tester with its operators.

        Raises:
            SearchError: The method cannot search the space, or rates exceed 1 together.
        """
        _check_rates(parameters)
        self._random, self._space = context.random, context.space
        self._parameters = parameters
        self._aims = tuple(aim.name for aim in context.aims)
        self._chromosome = Chromosome(context.space, context.conflicts)
        self._mutation: Mutation = components.mutation or DoppelTestMutation(
            chromosome=self._chromosome, parameters=parameters
        )
        self._crossover = DoppelTestCrossover(chromosome=self._chromosome, parameters=parameters)
        self._redrawing = Redrawing.of(context, parameters.redraws)
        self._selection: Selection = components.selection or Truncation()
        self._proposed: set[bytes] = set()
        self.population: list[Individual] = []
        self.violations = ViolationLog(self._chromosome)

    def script(self) -> Script:
        """Proposes generations and learns from them, without end.

        Candidates that were not judged are left out. Seeds are drawn until there are two parents.
        """
        generation = 0
        while True:
            if len(self.population) < 2:
                count = self._parameters.population
                proposals = tuple(self._seed(generation) for _ in range(count))
            else:
                count = self._parameters.offspring
                proposals = tuple(self._child(generation) for _ in range(count))
            evaluations = yield proposals
            self.population = self._survivors(
                [*self.population, *self._record_evaluations(evaluations)]
            )
            generation += 1

    def _seed(self, generation: int) -> Proposal:
        values = draw_seed(self._chromosome, self._random)
        self._proposed.add(values.tobytes())
        return Proposal(values=values, origin="initial", generation=generation)

    def _child(self, generation: int) -> Proposal:
        """Returns a child by crossover or by mutation, never by both, that differs from all before.

        A population of similar members has few different children: as a last resort, the child of
        a crossover is mutated, too.
        """
        if self._random.random() < self._parameters.crossover:
            origin, make = "crossover", self._cross
        else:
            origin, make = "mutation", self._mutate
        redrawn = 0
        for _ in range(_ATTEMPTS):
            values, parents, again = make()
            redrawn += again
            if values.tobytes() not in self._proposed:
                break
        else:
            values = self._mutate_values(values)
        self._proposed.add(values.tobytes())
        numbers = tuple(parent.number for parent in parents)
        return Proposal(
            values=values, origin=origin, generation=generation, parents=numbers, redrawn=redrawn
        )

    def _cross(self) -> tuple[FloatArray, list[Individual], int]:
        one, other = self._random.permutation(len(self.population))[:2]
        parents = [self.population[one], self.population[other]]
        values = self._crossover.cross(parents[0].values, parents[1].values, self._random)
        return self._space.clip(values), parents, 0

    def _mutate(self) -> tuple[FloatArray, list[Individual], int]:
        parent = self.population[self._random.integers(len(self.population))]
        values, redrawn = self._redrawing.draw(
            lambda: self._mutate_values(parent.values), parent.values, parent.without_effect
        )
        return values, [parent], redrawn

    def _mutate_values(self, values: FloatArray) -> FloatArray:
        return self._space.clip(self._mutation.mutate(values, self._space, self._random))

    def _record_evaluations(self, evaluations: Sequence[Evaluation]) -> list[Individual]:
        """Returns the judged candidates with their objectives, in the order of telling."""
        individuals = []
        for evaluation in evaluations:
            values = evaluation.proposal.values
            self._proposed.add(values.tobytes())
            if evaluation.measurement is None:
                continue
            objectives = evaluation.measurement.objectives
            values_of = [objectives[name] for name in self._aims or objectives]
            measured = [np.nan if value is None else value for value in values_of]
            new = self.violations.count_new(evaluation)
            individuals.append(
                Individual(
                    number=evaluation.number,
                    values=values,
                    objectives=(*measured, 0.0 - new),
                    without_effect=without_effect(evaluation),
                )
            )
        return individuals

    def _survivors(self, individuals: list[Individual]) -> list[Individual]:
        """Chooses the next population of all parents and children."""
        count = min(len(individuals), self._parameters.population)
        if not count:
            return []
        objectives = np.array([individual.objectives for individual in individuals])
        chosen = self._selection.select(objectives, count, self._random)
        return [individuals[index] for index in chosen]


def _check_rates(parameters: DoppelTestParameters) -> None:
    for names in (
        ("cross_egos", "cross_walkers"),
        ("remove_ego", "add_ego"),
        ("remove_walker", "add_walker"),
    ):
        rates = [getattr(parameters, name) for name in names]
        if sum(rates) > 1.0 + 1e-9:
            raise SearchError(
                f"tester 'doppeltest': {names[0]} = {rates[0]:g} and {names[1]} = {rates[1]:g} "
                "exceed 1 together; lower one of them"
            )


def _create(
    context: TesterContext, parameters: DoppelTestParameters, components: Components
) -> ScriptedTester:
    return ScriptedTester(DoppelTest(context, parameters, components).script())


DOPPELTEST = TesterPlugin(
    name="doppeltest",
    title="DoppelTest",
    description="evolves several egos of the same ADS to conflict with one another",
    source="Huai et al., Doppelgänger test generation for revealing bugs in autonomous driving "
    "software, ICSE 2023",
    parameters=DoppelTestParameters,
    feedback=FeedbackChoice(name="doppeltest"),
    create=_create,
    is_generational=True,
    guidance=Guidance.SEVERAL,
)
