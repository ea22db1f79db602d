"""SAMOTA: global search on surrogates of all objectives, local search around the best."""

from __future__ import annotations

from functools import partial

import numpy as np

from drivora_service.feedback.measurement import FeedbackChoice
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.aims import Guidance
from drivora_service.search.components import Components
from drivora_service.search.distance import candidate_distances
from drivora_service.search.genes import GeneSpace
from drivora_service.search.plugin import TesterPlugin
from drivora_service.search.tester import (
    Evaluation,
    EvaluationStatus,
    Proposal,
    Tester,
    TesterContext,
)
from drivora_service.search.testers.samota.archive import Archive, Database
from drivora_service.search.testers.samota.breeding import Breeding, Region
from drivora_service.search.testers.samota.encoding import Encoding
from drivora_service.search.testers.samota.ensemble import fit_ensemble
from drivora_service.search.testers.samota.local_search import LocalSearch
from drivora_service.search.testers.samota.mosa import Mosa, PreferenceSorting
from drivora_service.search.testers.samota.parameters import SamotaParameters
from drivora_service.search.testers.samota.screening import add_screening
from drivora_service.search.testers.samota.surrogates import Kriging, Polynomial, RadialBasis
from drivora_service.search.testers.script import Script, ScriptedTester


class AdaptiveRandom:
    """Draws several candidates and returns the one farthest from all returned before.

    Source: Chen, Leung, Mak, "Adaptive random testing" (2004), with a candidate set of fixed size.
    """

    def __init__(self, space: GeneSpace, *, pool: int) -> None:
        """Creates the initialisation of a space, with ``pool`` draws for each candidate."""
        self._space = space
        self._pool = pool
        self._given: FloatArray = np.empty((0, len(space)))

    def draw(self, random: np.random.Generator) -> FloatArray:
        """Returns the next candidate (d,)."""
        drawn = self._space.sample(random, self._pool)
        chosen = 0
        if len(self._given):
            nearest = candidate_distances(drawn, self._given, self._space).min(axis=1)
            chosen = int(np.argmax(nearest))
        self._given = np.concatenate((self._given, drawn[chosen : chosen + 1]))
        return np.array(drawn[chosen])


class SamotaSearch:
    """Adaptive random initialisation, then global and local search in turns.

    Each of these phases proposes all its candidates at once and waits for their evaluations.

    Attributes:
        database: All judged candidates.
        archive: The covered objectives.
    """

    def __init__(
        self, context: TesterContext, parameters: SamotaParameters, components: Components
    ) -> None:
        """Creates the search, with empty database and archive."""
        self._space = context.space
        self._random = context.random
        self._parameters = parameters
        self._encoding = Encoding(context.space)
        self._initialisation = AdaptiveRandom(context.space, pool=parameters.pool)
        self.database = Database(self._encoding, context.aims)
        self.archive = Archive(parameters.threshold, context.aims)
        breeding = Breeding(
            crossover=parameters.crossover,
            tournament=parameters.tournament,
            step=parameters.step,
            mutation=components.mutation,
        )
        self._mosa = Mosa(
            generations=parameters.generations,
            threshold=parameters.threshold,
            selection=components.selection or PreferenceSorting(),
            breeding=breeding,
        )
        self._local = LocalSearch(
            top=parameters.top,
            cluster=parameters.cluster,
            generations=parameters.local_generations,
            population=parameters.local_population,
            breeding=breeding,
        )

    def run(self) -> Script:
        """Proposes the candidates of phase after phase and learns from them, without end."""
        generation = 0
        yield from self._simulate(self._propose_initial(self._parameters.initial, generation))
        while True:
            for search in (self._search_globally, self._search_locally):
                generation += 1
                targets = self._targets()
                found = search(targets, generation) if len(targets) else ()
                # If nothing can be learnt, or all found candidates are known, explore elsewhere.
                yield from self._simulate(
                    found or self._propose_initial(max(len(targets), 1), generation)
                )

    def _simulate(self, proposals: tuple[Proposal, ...]) -> Script:
        for evaluation in (yield proposals):
            self._take(evaluation)

    def _take(self, evaluation: Evaluation) -> None:
        values, measurement = evaluation.proposal.values, evaluation.measurement
        if evaluation.status is EvaluationStatus.JUDGED and measurement is not None:
            self.database.add(evaluation.number, values, measurement.objectives)
            self.archive.update(evaluation.number, measurement.objectives)
        else:
            self.database.note(values)

    def _targets(self) -> IntArray:
        """Returns the objectives to search for: columns of the database.

        They are not covered, and candidates differ in them. If there is none, a new round begins.
        """
        if len(self.database) < 2 * self._parameters.folds:
            return np.empty(0, dtype=np.int64)
        differs: BoolArray = np.greater(np.ptp(self.database.objectives, axis=0), 0.0)
        targets = np.flatnonzero(differs & self.archive.is_uncovered(self.database.names))
        if len(targets):
            return targets
        self.archive.begin_round()
        return np.flatnonzero(differs)

    def _propose_initial(self, count: int, generation: int) -> tuple[Proposal, ...]:
        drawn = [self._initialisation.draw(self._random) for _ in range(count)]
        for values in drawn:
            self.database.note(values)
        return tuple(
            Proposal(values=values, origin="initial", generation=generation) for values in drawn
        )

    def _search_globally(self, targets: IntArray, generation: int) -> tuple[Proposal, ...]:
        parameters, database = self._parameters, self.database
        rows = database.training_rows(targets, parameters.training)
        kriging = partial(Kriging.fit, components=parameters.components)
        ensemble = fit_ensemble(
            database.features[rows],
            database.objectives[np.ix_(rows, targets)],
            add_screening(RadialBasis.fit, Polynomial.fit, kriging),
            self._random,
            folds=parameters.folds,
        )
        found = self._mosa.search(
            self._first_population(targets),
            Region(space=self._space),
            self._encoding.encode,
            ensemble.predict,
            database.knows,
            self._random,
        )
        proposals = []
        for best, uncertain in zip(found.best, found.uncertain, strict=True):
            for values, origin in ((best, "best"), (uncertain, "uncertain")):
                if values is not None and self._note_if_new(values):
                    proposals.append(
                        Proposal(values=values.copy(), origin=origin, generation=generation)
                    )
        return tuple(proposals)

    def _first_population(self, targets: IntArray) -> FloatArray:
        size = self._parameters.population
        near = self.database.nearest(targets, round(self._parameters.seeded * size))
        drawn = self._space.sample(self._random, size - len(near))
        return np.concatenate((self.database.values[near], drawn))

    def _search_locally(self, targets: IntArray, generation: int) -> tuple[Proposal, ...]:
        finds = (
            find
            for target in targets
            for find in self._local.search(
                self.database, int(target), self._space, self._encoding, self._random
            )
        )
        return tuple(
            Proposal(
                values=find.values.copy(),
                origin="local",
                generation=generation,
                parents=tuple(self.database.numbers[row] for row in find.members),
            )
            for find in finds
            if self._note_if_new(find.values)
        )

    def _note_if_new(self, values: FloatArray) -> bool:
        """Returns whether a candidate was not proposed before, and records it as proposed."""
        is_new = not self.database.knows(self._encoding.encode(values[None])[0])
        self.database.note(values)
        return is_new


def _create(context: TesterContext, parameters: SamotaParameters, components: Components) -> Tester:
    return ScriptedTester(SamotaSearch(context, parameters, components).run())


SAMOTA = TesterPlugin(
    name="samota",
    title="SAMOTA",
    description="many objectives, searched on surrogates globally and around clusters locally",
    source="Ul Haq, Shin, Briand: Efficient Online Testing for DNN-Enabled Systems using "
    "Surrogate-Assisted and Many-Objective Optimization (ICSE 2022)",
    parameters=SamotaParameters,
    feedback=FeedbackChoice(name="samota"),
    create=_create,
    is_generational=True,
    guidance=Guidance.SEVERAL,
)
