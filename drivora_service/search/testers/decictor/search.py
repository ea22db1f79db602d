"""Decictor's search for non-optimal decisions.

Cheng, Zhou, Xie, Wang, Meng, Yang, *Decictor: Towards Evaluating the Robustness of Decision-Making
in Autonomous Driving Systems* (ICSE 2025). The first candidate is the scenario without further
actors; the paths that its egos drive are the reference. All others are compared with it: actors are
added, removed and changed outside the area that an ego could use on its path, so that the path
stays free. The scenarios whose runs differ most from the reference are bred.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from drivora_service.errors import SearchError
from drivora_service.feedback.decictor import CONSISTENCY, REFERENCE
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import BoolArray, FloatArray
from drivora_service.runs.candidate import Reference
from drivora_service.search.aims import Guidance
from drivora_service.search.budget_bounds import within_budget
from drivora_service.search.components import Components
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.selection import Roulette
from drivora_service.search.tester import (
    REFERENCE_ORIGIN,
    Evaluation,
    EvaluationStatus,
    Proposal,
    TesterContext,
)
from drivora_service.search.testers.decictor.mutation import ActorChanges, optional_actors
from drivora_service.search.testers.script import Script, ScriptedTester

Share = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class DecictorParameters:
    """Defaults from Cheng et al., "Decictor" (ICSE 2025), and its public code.

    Attributes:
        population: Number of scenarios of a generation (paper: 4).
        static_rate: Probability with which obstacles are mutated, and not vehicles and walkers, if
            the space has both (code: 0.5).
        most_added: Greatest number of obstacles that are added at a time; of vehicles and walkers
            it is 1 (code: 4).
        removed_share: Share of the present actors that are removed if none can be added, at least
            one (code: 0.2).
        change_rate: Probability with which each present actor is changed a little (code: 0.5).
        sigma: Standard deviation of such a change, as a share of a gene's range.
        reference_tries: Number of times that the reference is drawn again if an ego does not
            arrive, where the space varies more than actors that may be absent.
    """

    population: Annotated[int, within_budget(1)] = 4
    static_rate: Share = 0.5
    most_added: Annotated[int, Field(ge=1, le=1000)] = 4
    removed_share: Share = 0.2
    change_rate: Share = 0.5
    sigma: Annotated[float, Field(gt=0.0)] = 0.05
    reference_tries: Annotated[int, within_budget(0)] = 10


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Member:
    """A scenario of the population.

    Attributes:
        values: (d,) genes.
        cost: The objective, to be minimised (its own is the consistency with the reference);
            infinite if not measurable.
        number: Number of its evaluation.
    """

    values: FloatArray
    cost: float
    number: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Start:
    """The reference run: its genes, the number of its evaluation, its cost, and the paths."""

    values: FloatArray
    number: int
    cost: float
    reference: Reference


class DecictorSearch:
    """The state of a search."""

    def __init__(
        self, context: TesterContext, parameters: DecictorParameters, components: Components
    ) -> None:
        self._space, self._random, self._parameters = context.space, context.random, parameters
        self._mutation = components.mutation or ActorChanges(
            static_rate=parameters.static_rate,
            most_added=parameters.most_added,
            removed_share=parameters.removed_share,
            change_rate=parameters.change_rate,
            sigma=parameters.sigma,
        )
        self._selection = components.selection or Roulette()
        self._actors = optional_actors(context.space)
        self._objective = context.objective(CONSISTENCY)

    def script(self) -> Script:
        """Runs the reference, then breeds generations without end."""
        start = yield from self._find_reference()
        first = Member(values=start.values, cost=start.cost, number=start.number)
        population = (first,) * self._parameters.population
        generation = 0
        while True:
            generation += 1
            children = yield tuple(
                Proposal(
                    values=self._mutant(parent.values, start.values),
                    origin="mutation",
                    generation=generation,
                    parents=(parent.number,),
                    reference=start.reference,
                )
                for parent in population
            )
            # A found failure is not bred, as it could only be found again.
            fit = tuple(self._member(told) for told in children if self._may_breed(told))
            population = self._select((*population, *fit))

    def _find_reference(self) -> Generator[tuple[Proposal, ...], tuple[Evaluation, ...], _Start]:
        tries = 0
        while True:
            values = self._space.sample(self._random)
            for block in self._actors:
                values[block.start] = 0.0
            (told,) = yield (Proposal(values=values, origin=REFERENCE_ORIGIN),)
            if told.status is not EvaluationStatus.JUDGED:
                # Another try may be judged; the campaign ends if too many are not.
                continue
            reference = _reference(told)
            if reference is not None:
                # It is compared with itself.
                is_own = self._objective == CONSISTENCY
                member = self._member(told)
                return _Start(
                    values=member.values,
                    number=member.number,
                    cost=0.0 if is_own else member.cost,
                    reference=reference,
                )
            tries += 1
            if tries > self._parameters.reference_tries or not self._others_vary():
                raise SearchError(
                    "decictor compares paths with that of the seed scenario without further "
                    f"actors, but there an ego did not arrive ({tries} tries); choose a scenario "
                    "in which the ADS completes its task"
                )

    def _others_vary(self) -> bool:
        return bool((self._space.varies & ~self._mutable()).any())

    def _mutable(self) -> BoolArray:
        """Returns the (d,) genes of actors that may be absent."""
        mutable = np.zeros(len(self._space), dtype=np.bool_)
        for block in self._actors:
            mutable[block.slice] = True
        return mutable

    def _mutant(self, parent: FloatArray, reference: FloatArray) -> FloatArray:
        mutant = self._mutation.mutate(parent, self._space, self._random)
        # Weather, lights, patches and egos stay as in the reference, whatever mutates.
        return np.where(self._mutable(), mutant, reference)

    def _select(self, members: tuple[Member, ...]) -> tuple[Member, ...]:
        costs = np.array([[one.cost] for one in members])
        count = self._parameters.population
        return tuple(members[i] for i in self._selection.select(costs, count, self._random))

    def _may_breed(self, told: Evaluation) -> bool:
        return (
            told.status is EvaluationStatus.JUDGED
            and not told.violations
            and told.measurement is not None
            and told.measurement.objectives[self._objective] is not None
        )

    def _member(self, told: Evaluation) -> Member:
        measured = (
            None if told.measurement is None else told.measurement.objectives[self._objective]
        )
        return Member(
            values=told.proposal.values,
            cost=math.inf if measured is None else measured,
            number=told.number,
        )


def _reference(told: Evaluation) -> Reference | None:
    """Returns the paths of a reference run; ``None`` if an ego did not arrive."""
    measured = told.measurement
    if measured is None:
        return None
    rows = measured.features.get(REFERENCE, ())
    if rows:
        egos = range(int(rows[-1][0]) + 1)
        return Reference(
            paths=tuple(tuple(row[1:] for row in rows if int(row[0]) == ego) for ego in egos)
        )
    # The seed scenario has reference paths of its own.
    is_compared = measured.objectives.get(CONSISTENCY) is not None
    return Reference() if is_compared else None


def _create(
    context: TesterContext, parameters: DecictorParameters, components: Components
) -> ScriptedTester:
    if not optional_actors(context.space):
        raise SearchError(
            "decictor adds and removes actors; let the space have some that may be absent "
            "(`optional: true`)"
        )
    return ScriptedTester(DecictorSearch(context, parameters, components).script())


DECICTOR = TesterPlugin(
    name="decictor",
    title="Decictor",
    description="changes a scenario outside the area that the ego could use, and breeds those in "
    "which its path and motion differ most",
    source="Cheng et al., Decictor: Towards Evaluating the Robustness of Decision-Making in "
    "Autonomous Driving Systems, 2025",
    parameters=DecictorParameters,
    feedback=FeedbackChoice(name="decictor"),
    create=_create,
    is_generational=True,
    oracle="non_optimal_decision",
    compares_paths=True,
    guidance=Guidance.ONE,
)
