"""DriveFuzz as ask and tell.

Kim, Liu, Rhee, Jeon, Kwon, Kim: *DriveFuzz: Discovering Autonomous Driving Bugs through Driving
Quality-Guided Fuzzing* (CCS 2022). A seed has nothing added. In every cycle each mutant of the
parent gets one thing more; the mutant with the lowest driving quality is the next parent. A
violation, or the last cycle, ends with a new seed. The reference page explains the adaptations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from drivora_service.errors import SearchError
from drivora_service.feedback.drivefuzz import QUALITY
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.aims import Guidance
from drivora_service.search.budget_bounds import MANY, within_budget
from drivora_service.search.components import Components
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.selection import Truncation
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.drivefuzz.adding import Adding
from drivora_service.search.testers.script import Script, ScriptedTester


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivefuzzParameters:
    """Defaults from Kim et al., "DriveFuzz" (CCS 2022), and its public code.

    Attributes:
        cycles: Number of cycles from one seed, unless a violation ends them (paper: 10).
        mutants: Number of mutants of a cycle (paper: 8).
        nearest: Metres from the ego's start at which a new actor appears, at least (code: 5).
        farthest: The same, at most (code: 40).
        patch_chance: Probability with which a mutant gets a slippery patch (code: 0.25).
        weather_chance: Probability with which a mutant gets another weather (ours).
        tries: Number of draws of an actor until it appears within these distances (ours).
    """

    cycles: Annotated[int, Field(ge=1, le=MANY)] = 10
    mutants: Annotated[int, within_budget(1)] = 8
    nearest: Annotated[float, Field(ge=0.0)] = 5.0
    farthest: Annotated[float, Field(gt=0.0)] = 40.0
    patch_chance: Annotated[float, Field(ge=0.0, le=1.0)] = 0.25
    weather_chance: Annotated[float, Field(ge=0.0, le=1.0)] = 0.25
    tries: Annotated[int, Field(ge=1, le=10_000)] = 50


class DrivefuzzSearch:
    """The cycles of a search."""

    def __init__(
        self, context: TesterContext, parameters: DrivefuzzParameters, components: Components
    ) -> None:
        self._space, self._random = context.space, context.random
        self._parameters = parameters
        self._mutation = components.mutation
        self._selection = components.selection or Truncation()
        self._objective = context.objective(QUALITY)
        self._cycle = 0
        self.adding = Adding(
            context.space,
            context.random,
            distance=context.ego_distance,
            reach=(parameters.nearest, parameters.farthest),
            chances=(parameters.patch_chance, parameters.weather_chance),
            tries=parameters.tries,
        )

    def script(self) -> Script:
        """Searches without end, from one seed after another."""
        while True:
            parent = self.adding.blank()
            numbers: tuple[int, ...] = ()
            for _ in range(self._parameters.cycles):
                proposals = tuple(
                    self._mutant(parent, numbers) for _ in range(self._parameters.mutants)
                )
                evaluations = yield proposals
                self._cycle += 1
                if any(told.violations for told in evaluations):
                    break
                worst = self._worst(evaluations)
                if worst is not None:
                    parent, numbers = worst.proposal.values, (worst.number,)

    def _mutant(self, parent: FloatArray, numbers: tuple[int, ...]) -> Proposal:
        if self._mutation is not None:
            values, origin = self._mutation.mutate(parent, self._space, self._random), "mutation"
        else:
            added = self.adding.add(parent)
            values, origin = added.values, f"{added.part.value} added"
        return Proposal(values=values, origin=origin, generation=self._cycle, parents=numbers)

    def _worst(self, evaluations: tuple[Evaluation, ...]) -> Evaluation | None:
        """Returns the evaluation with the lowest quality; ``None`` if none is measurable."""
        known = [
            (one, quality) for one in evaluations if (quality := self._quality(one)) is not None
        ]
        if not known:
            return None
        objectives = np.array([[quality] for _, quality in known])
        (chosen,) = self._selection.select(objectives, 1, self._random)
        return known[int(chosen)][0]

    def _quality(self, evaluation: Evaluation) -> float | None:
        """Returns the objective; ``None`` if it was not judged or not measurable.

        Raises:
            UnknownObjective: It was measured by another feedback.
        """
        measurement = evaluation.measurement
        quality = None if measurement is None else measurement.objectives[self._objective]
        return quality if quality is not None and math.isfinite(quality) else None


def _create(
    context: TesterContext, parameters: DrivefuzzParameters, components: Components
) -> ScriptedTester:
    if parameters.nearest >= parameters.farthest:
        raise SearchError(
            f"nearest is {parameters.nearest:g} and farthest {parameters.farthest:g}; the first "
            "must be less"
        )
    search = DrivefuzzSearch(context, parameters, components)
    if components.mutation is None and not search.adding.is_possible:
        raise SearchError(
            "drivefuzz adds actors, slippery patches and weather to a scenario, and this space has "
            "none that may be absent; set `optional: true`, and `vehicles`, `walkers`, `obstacles` "
            "or `patches`"
        )
    return ScriptedTester(search.script())


DRIVEFUZZ = TesterPlugin(
    name="drivefuzz",
    title="DriveFuzz",
    description="adds actors, slippery patches and weather to the scenario that was driven worst",
    source="Kim et al., DriveFuzz: Discovering Autonomous Driving Bugs through Driving "
    "Quality-Guided Fuzzing, 2022",
    parameters=DrivefuzzParameters,
    feedback=FeedbackChoice(name="drivefuzz"),
    create=_create,
    is_generational=True,
    guidance=Guidance.ONE,
)
