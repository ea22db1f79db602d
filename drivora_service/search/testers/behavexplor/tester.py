"""BehAVExplor as ask and tell.

Cheng, Zhou, Xie, *BehAVExplor: Behavior Diversity Guided Testing for Autonomous Driving Systems*
(ISSTA 2023), with the details of its public code. The reference page explains the adaptations.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from typing import Annotated

import numpy as np
from pydantic import Field

from drivora_service.errors import SearchError
from drivora_service.feedback.behavexplor import DEGREE, WINDOWS
from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Outcome, Verdict
from drivora_service.search.aims import Aim, Guidance
from drivora_service.search.budget_bounds import within_budget
from drivora_service.search.components import Components
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.redrawing import ATTEMPTS, MOST_ATTEMPTS, Redrawing, without_effect
from drivora_service.search.tester import Evaluation, Proposal, TesterContext
from drivora_service.search.testers.behavexplor.behaviour_model import BehaviourModel
from drivora_service.search.testers.behavexplor.energy import (
    INITIAL_GAIN,
    INITIAL_NOVELTY,
    EnergySelection,
    Seed,
    initial_energy,
)
from drivora_service.search.testers.behavexplor.mutation import WaypointNoise
from drivora_service.search.testers.turn import Turn

_WORST = 1.0
"""Degree of violation if it is not measurable: the farthest from a failure."""


class Failures(StrEnum):
    """The runs that count as failures when a seed is rewarded for its mutants.

    None of them joins the corpus or the archive, whichever is chosen.
    """

    EVERY = "every"
    """As in the public code: also every collision, at fault or not, and every ego that did not
    reach its destination."""
    CAMPAIGN = "campaign"
    """The failures of the campaign alone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BehavexplorParameters:
    """Parameters of BehAVExplor. "Code" is the public code of the paper.

    Attributes:
        initial: Number of candidates that are drawn first (code: 4).
        novelty: Distance to the nearest behaviour of the archive above which a behaviour is new
            (paper and code: 0.4).
        fewest_clusters: Least number of clusters of the behaviour model (code: 10).
        most_clusters: Greatest number (the authors' later code: 20); equal to the least to fix it.
        noise_energy: Energy above which a seed is mutated rather than redrawn (code: 0.5).
        probability: Probability with which a mutation moves a magnitude or waypoint (code: 0.5).
        along_sigma: Metres, standard deviation of a waypoint's move along the path (code: 12).
        speed_sigma: m/s, standard deviation of the change of its speed (code: 6).
        spread: Standard deviation of all other magnitudes as a share of their range (ours; in the
            paper's space there are none).
        redraw_cost: Energy that a redraw takes from its parent (code: 0.1).
        failures: What rewards the parent as a failure; see :class:`Failures`.
        breed_failures: Whether candidates that failed become seeds, too (paper and code: no; the
            authors' later code: yes).
        redraws: Number of mutants that are drawn again for one candidate, at most, as they could
            not change the run of any ego (ours; paper and code: 0).
    """

    initial: Annotated[int, within_budget(1)] = 4
    novelty: Annotated[float, Field(ge=0.0, le=1.0)] = 0.4
    fewest_clusters: Annotated[int, Field(ge=2, le=1000)] = 10
    most_clusters: Annotated[int, Field(ge=2, le=1000)] = 20
    noise_energy: Annotated[float, Field(ge=0.0)] = 0.5
    probability: Annotated[float, Field(gt=0.0, le=1.0)] = 0.5
    along_sigma: Annotated[float, Field(gt=0.0)] = 12.0
    speed_sigma: Annotated[float, Field(gt=0.0)] = 6.0
    spread: Annotated[float, Field(ge=0.0)] = 1.0 / 3.0
    redraw_cost: Annotated[float, Field(ge=0.0)] = 0.1
    failures: Failures = Failures.EVERY
    breed_failures: bool = False
    redraws: Annotated[int, Field(ge=0, le=MOST_ATTEMPTS)] = ATTEMPTS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Open:
    """A proposal that has not been told; without a parent if it was drawn."""

    parent: Seed | None
    is_redraw: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Outcome:
    """The result of an evaluation.

    Attributes:
        degree: Degree of violation, or the share of the chosen objective, 0..1.
        windows: (n, c), n >= 1; ``None`` if the ego's behaviour is not known.
        failed: Whether the campaign counts it as a failure.
        is_barred: Whether it failed, an ego collided, or an ego did not reach its destination.
    """

    degree: float
    windows: FloatArray | None
    failed: bool
    is_barred: bool


class BehavexplorTester:
    """Breeds from a corpus of seeds by their energy; new or more critical children join it.

    There are no generations: every proposal is bred from the current corpus, and every told
    evaluation changes the corpus, the energy of the parent and, if the behaviour is new, the model.
    ``Proposal.generation`` is the number of fits of the behaviour model up to then.
    """

    def __init__(
        self, context: TesterContext, parameters: BehavexplorParameters, components: Components
    ) -> None:
        self._space = context.space
        self._random = context.random
        self._parameters = parameters
        self._mutation = components.mutation or WaypointNoise(
            probability=parameters.probability,
            along_sigma=parameters.along_sigma,
            speed_sigma=parameters.speed_sigma,
            spread=parameters.spread,
        )
        self._selection = components.selection or EnergySelection()
        context.objective(DEGREE)  # Refuses several.
        self._aim = context.aims[0] if context.aims else None
        self._redrawing = Redrawing.of(context, parameters.redraws)
        self._turn = Turn()
        self._open: deque[_Open] = deque()
        self._told = 0
        self._fresh: list[tuple[Seed, FloatArray]] = []
        self.corpus: list[Seed] = []
        self.model = BehaviourModel(
            fewest=parameters.fewest_clusters,
            most=parameters.most_clusters,
            random=context.random,
        )

    def ask(self, room: int) -> tuple[Proposal, ...]:
        """Proposes the initial candidates and, once all are evaluated, children of the corpus.

        If the corpus is empty then, candidates are drawn.
        """
        left = self._parameters.initial - self._turn.next_number
        if left > 0:
            proposals = self._draw_proposals(min(room, left))
        elif self._told < self._parameters.initial:
            proposals = ()
        elif not self.corpus:
            proposals = self._draw_proposals(room)
        else:
            proposals = self._breed_proposals(room)
        return self._turn.propose(proposals, room)

    def tell(self, evaluation: Evaluation) -> None:
        """Learns from the next evaluation: adds its candidate to the corpus if it deserves it."""
        self._turn.take(evaluation)
        asked = self._open.popleft()
        self._told += 1
        outcome = _read(evaluation, self._aim)
        if asked.parent is None:
            self._tell_drawn(evaluation, outcome)
        else:
            self._tell_child(evaluation, outcome, asked.parent, is_redraw=asked.is_redraw)

    def _draw_proposals(self, count: int) -> tuple[Proposal, ...]:
        proposals = []
        for _ in range(count):
            self._open.append(_Open(parent=None, is_redraw=True))
            proposals.append(self._proposal(self._space.sample(self._random), "initial"))
        return tuple(proposals)

    def _breed_proposals(self, count: int) -> tuple[Proposal, ...]:
        energies = np.array([[seed.energy] for seed in self.corpus])
        proposals = []
        for index in self._selection.select(-energies, count, self._random):
            parent = self.corpus[index]
            is_redraw = parent.energy <= self._parameters.noise_energy
            if is_redraw:
                values, redrawn = self._space.sample(self._random), 0
            else:
                values, redrawn = self._redrawing.draw(
                    partial(self._mutation.mutate, parent.values, self._space, self._random),
                    parent.values,
                    parent.without_effect,
                )
            self._open.append(_Open(parent=parent, is_redraw=is_redraw))
            origin = "redraw" if is_redraw else "mutation"
            proposals.append(self._proposal(values, origin, parent.number, redrawn=redrawn))
        return tuple(proposals)

    def _proposal(
        self, values: FloatArray, origin: str, *parents: int, redrawn: int = 0
    ) -> Proposal:
        return Proposal(
            values=values,
            origin=origin,
            generation=self.model.fits,
            parents=tuple(parents),
            redrawn=redrawn,
        )

    def _tell_drawn(self, evaluation: Evaluation, outcome: _Outcome) -> None:
        if outcome.windows is not None and self._may_breed(outcome):
            energy = initial_energy(INITIAL_GAIN, INITIAL_NOVELTY)
            self._fresh.append((_seed(evaluation, outcome, energy), outcome.windows))
        if self._fresh and self._told >= self._parameters.initial:
            self.corpus += [seed for seed, _ in self._fresh]
            self.model.extend([windows for _, windows in self._fresh])
            self._fresh.clear()

    def _tell_child(
        self, evaluation: Evaluation, outcome: _Outcome, parent: Seed, *, is_redraw: bool
    ) -> None:
        windows = outcome.windows
        gain = parent.degree - outcome.degree
        novelty = 0.0 if windows is None else self.model.novelty(windows)
        is_new = novelty > self._parameters.novelty
        if is_redraw:
            parent.spend(self._parameters.redraw_cost)
        else:
            failed = (
                outcome.is_barred if self._parameters.failures is Failures.EVERY else outcome.failed
            )
            parent.learn(is_success=failed or is_new, gain=gain, novelty=novelty)
        if windows is None or not self._may_breed(outcome):
            return
        if is_new or gain > 0.0:
            self.corpus.append(_seed(evaluation, outcome, initial_energy(gain, novelty)))
        if is_new:
            self.model.extend([windows])

    def _may_breed(self, outcome: _Outcome) -> bool:
        return self._parameters.breed_failures or not outcome.is_barred


def _seed(evaluation: Evaluation, outcome: _Outcome, energy: float) -> Seed:
    return Seed(
        number=evaluation.number,
        values=evaluation.proposal.values.copy(),
        without_effect=without_effect(evaluation),
        degree=outcome.degree,
        energy=energy,
    )


def _read(evaluation: Evaluation, aim: Aim | None) -> _Outcome:
    """Reads an evaluation; one that was not judged has no windows.

    Args:
        evaluation: The evaluation.
        aim: The objective in place of the degree of violation; ``None``: the degree.

    Raises:
        SearchError: It was measured by another feedback.
    """
    measurement = evaluation.measurement
    if measurement is None:
        return _Outcome(degree=_WORST, windows=None, failed=False, is_barred=False)
    if DEGREE not in measurement.objectives or WINDOWS not in measurement.features:
        raise SearchError(
            f"evaluation {evaluation.number} has no {DEGREE!r} or no {WINDOWS!r}; the tester "
            "'behavexplor' needs evaluations that were measured by the feedback 'behavexplor'"
        )
    if aim is None:
        degree = measurement.objectives[DEGREE]
    else:
        value = measurement.objectives[aim.name]
        degree = None if value is None else aim.share(value)
    rows = measurement.features[WINDOWS]
    return _Outcome(
        degree=_WORST if degree is None else degree,
        windows=np.array(rows, dtype=np.float64) if rows else None,
        failed=bool(evaluation.violations),
        is_barred=bool(evaluation.violations) or any(map(_bars, evaluation.verdicts)),
    )


def _bars(verdict: Verdict) -> bool:
    """Returns whether a verdict keeps a run out of the corpus, at fault or not."""
    return verdict.outcome is Outcome.VIOLATED and (
        verdict.oracle == "collision"
        # An ego that came too late has reached its destination.
        or (verdict.oracle == "destination" and verdict.evidence.get("reason") != "late")
    )


def _create(
    context: TesterContext, parameters: BehavexplorParameters, components: Components
) -> BehavexplorTester:
    if parameters.fewest_clusters > parameters.most_clusters:
        raise SearchError(
            f"fewest_clusters is {parameters.fewest_clusters} and most_clusters "
            f"{parameters.most_clusters}; the first must not be greater"
        )
    noise = WaypointNoise(spread=parameters.spread)
    if components.mutation is None and not noise.plan(context.space)[0].any():
        raise SearchError(
            "nothing in the gene space has a magnitude that BehAVExplor's mutation can move; let "
            "vehicles vary (or walkers, obstacles, weather or lights, with a spread above 0)"
        )
    return BehavexplorTester(context, parameters, components)


BEHAVEXPLOR = TesterPlugin(
    name="behavexplor",
    title="BehAVExplor",
    description="breeds from seeds by energy; keeps candidates with new behaviour or more critical",
    source="Cheng, Zhou, Xie: BehAVExplor (ISSTA 2023)",
    parameters=BehavexplorParameters,
    feedback=FeedbackChoice(name="behavexplor"),
    create=_create,
    is_generational=False,
    guidance=Guidance.ONE,
)
