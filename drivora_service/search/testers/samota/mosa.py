"""MOSA, the many-objective sorting algorithm, on surrogates.

Source: Panichella, Kifetew, Tonella, "Reformulating branch coverage as a many-objective
optimization problem" (ICST 2015), as SAMOTA uses it: the objectives are predicted, and besides the
best candidate of each objective the one is kept that the surrogates disagree about most.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.components import Selection
from drivora_service.search.selection import best_first
from drivora_service.search.testers.samota.breeding import Breeding, Region
from drivora_service.search.testers.samota.ensemble import Prediction


@dataclass(frozen=True, slots=True, kw_only=True)
class PreferenceSorting:
    """The best candidate of every objective first, the others by non-domination and crowding."""

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:  # noqa: ARG002 - nothing is drawn
        """Returns ``count`` rows, preferred ones first; again from the first if there are fewer."""
        preferred = preferred_rows(objectives)
        is_other = np.ones(len(objectives), dtype=np.bool_)
        is_other[preferred] = False
        others = np.flatnonzero(is_other)
        if len(preferred) >= count or not len(others):
            return np.resize(preferred, count)
        return np.resize(np.concatenate((preferred, others[best_first(objectives[others])])), count)


def preferred_rows(objectives: FloatArray) -> IntArray:
    """Returns the rows of the best candidate of each objective, each row once.

    Among equals, the one with the smallest sum of objectives is preferred, then the first.

    Args:
        objectives: (n, m), to be minimised.
    """
    least = objectives == objectives.min(axis=0)
    total = np.where(least, objectives.sum(axis=1)[:, None], np.inf)
    rows, first = np.unique(total.argmin(axis=0), return_index=True)
    preferred: IntArray = rows[np.argsort(first, kind="stable")]
    return preferred


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """The candidates that a search on the surrogates selects for simulation.

    Attributes:
        best: For each of the m objectives, the candidate (d,) predicted nearest to a violation.
        uncertain: For each, the candidate with the greatest disagreement of the surrogates.
    """

    best: tuple[FloatArray | None, ...]
    uncertain: tuple[FloatArray | None, ...]


class _Keeper:
    """Keeps the candidate with the least score of each of m objectives, of those wanted."""

    def __init__(self, count: int, is_known: Callable[[FloatArray], bool]) -> None:
        self.scores = np.full(count, np.inf)
        self.values: list[FloatArray | None] = [None] * count
        self._is_known = is_known

    def consider(self, scores: FloatArray, values: FloatArray, features: FloatArray) -> None:
        """Considers q candidates with scores (q, m)."""
        for j in range(scores.shape[1]):
            better = np.flatnonzero(scores[:, j] < self.scores[j])
            for row in better[np.argsort(scores[better, j], kind="stable")]:
                if not self._is_known(features[row]):
                    self.scores[j] = scores[row, j]
                    self.values[j] = values[row]
                    break


@dataclass(frozen=True, slots=True, kw_only=True)
class Mosa:
    """The search.

    Attributes:
        generations: Number of generations.
        threshold: Predicted value at and below which an objective is no longer searched for.
        selection: Survivor selection, best first.
        breeding: The operators.
    """

    generations: int
    threshold: float
    selection: Selection
    breeding: Breeding

    def search(
        self,
        start: FloatArray,
        region: Region,
        encode: Callable[[FloatArray], FloatArray],
        predict: Callable[[FloatArray], Prediction],
        is_known: Callable[[FloatArray], bool],
        random: np.random.Generator,
    ) -> Found:
        """Searches from a first population.

        Args:
            start: (n, d) candidates of the first population.
            region: Region of the search.
            encode: Returns the features (n, e) of candidates (n, d).
            predict: Returns the objectives and uncertainties (n, m) of features (n, e).
            is_known: Whether a candidate with features (e,) is known and must be left out.
            random: Generator for every draw.
        """
        features = encode(start)
        said = predict(features)
        values, objectives = start, said.objectives
        best = _Keeper(objectives.shape[1], is_known)
        uncertain = _Keeper(objectives.shape[1], is_known)
        best.consider(objectives, values, features)
        uncertain.consider(-said.uncertainty, values, features)
        for _ in range(self.generations):
            open_: BoolArray = best.scores > self.threshold
            if not open_.any():
                break
            order = self.selection.select(objectives[:, open_], len(start), random)
            values, objectives = values[order], objectives[order]
            children = self.breeding.children(values, region, random)
            features = encode(children)
            said = predict(features)
            best.consider(said.objectives, children, features)
            uncertain.consider(-said.uncertainty, children, features)
            values = np.concatenate((values, children))
            objectives = np.concatenate((objectives, said.objectives))
        return Found(best=tuple(best.values), uncertain=tuple(uncertain.values))
