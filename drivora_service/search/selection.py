"""Survivor selections. Several objectives are compared as in NSGA-II.

Objectives are minimised. Non-finite values count as not measurable, and as worse than all
measurable ones. A selection of more candidates than there are repeats some of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivora_service.errors import SearchError
from drivora_service.geometry.array_shapes import BoolArray, FloatArray, IntArray
from drivora_service.search.plugin import SelectionPlugin


def fronts(objectives: FloatArray) -> tuple[IntArray, ...]:
    """Sorts candidates by non-domination; the first front is not dominated.

    Args:
        objectives: (n, m), to be minimised.

    Returns:
        Indices of each front, in ascending order.
    """
    ranks = _ranks(measurable(objectives))
    return tuple(np.flatnonzero(ranks == rank) for rank in range(ranks.max() + 1))


def crowding_distances(objectives: FloatArray) -> FloatArray:
    """Returns the crowding distance (n,) of each candidate of one front; inf at its ends.

    Source: Deb et al., "A fast and elitist multiobjective genetic algorithm: NSGA-II" (2002).
    """
    return _compute_crowding(measurable(objectives), np.zeros(len(objectives), dtype=np.int64))


def best_first(objectives: FloatArray) -> IntArray:
    """Orders candidates (n,) from best to worst: by front, crowding distance, then index.

    Args:
        objectives: (n, m), to be minimised. With m = 1 this is the order of the values.
    """
    if objectives.shape[1:] == (1,) and objectives.size and np.isfinite(objectives).all():
        return np.argsort(objectives[:, 0], kind="stable")
    numbers = measurable(objectives)
    if numbers.shape[1] == 1:
        return np.argsort(numbers[:, 0], kind="stable")
    ranks = _ranks(numbers)
    if np.isfinite(objectives).all():
        rooms = _compute_crowding(numbers, ranks)
    else:
        # A value that is not measurable is worse than those of its own front.
        rooms = np.empty(len(numbers))
        for rank in range(ranks.max() + 1):
            front = ranks == rank
            rooms[front] = crowding_distances(objectives[front])
    order: IntArray = np.lexsort((-rooms, ranks))
    return order


def _ranks(numbers: FloatArray) -> IntArray:
    """Returns the number (n,) of each candidate's front, from 0."""
    # A matrix of all pairs: for the few hundred candidates of a population, faster than libraries.
    no_worse = np.ones((len(numbers), len(numbers)), dtype=np.bool_)
    for column in numbers.T:
        no_worse &= column[:, None] <= column
    dominates = (no_worse > no_worse.T).astype(np.float64)
    # Number of candidates of no front yet that dominate each; negative for those in a front.
    better = dominates.sum(axis=0)
    ranks = np.zeros(len(numbers), dtype=np.int64)
    while True:
        front = better == 0.0
        if not front.any():
            return ranks
        better -= front @ dominates
        better[front] = -1.0
        ranks += better >= 0.0


def _compute_crowding(numbers: FloatArray, ranks: IntArray) -> FloatArray:
    """Returns the crowding distance (n,) of each candidate in its front.

    Candidates of a front of up to two are all ends. An objective in which all of a front are equal
    does not count.
    """
    count, objectives = numbers.shape
    order = np.lexsort((numbers, np.broadcast_to(ranks[:, None], numbers.shape)), axis=0)
    values = np.take_along_axis(numbers, order, axis=0)
    sizes = np.bincount(ranks)
    ends = np.cumsum(sizes) - 1
    starts = ends - sizes + 1
    before, behind = np.full((2, count, objectives), np.inf)
    before[1:] = behind[:-1] = values[1:] - values[:-1]
    before[starts] = behind[ends] = np.inf
    widths = values[ends] - values[starts]
    widths[widths == 0.0] = np.inf
    widths = np.repeat(widths, sizes, axis=0)
    with np.errstate(invalid="ignore"):
        rooms = before / widths + behind / widths
    rooms[np.isinf(widths)] = 0.0
    placed = np.empty_like(rooms)
    np.put_along_axis(placed, order, rooms, axis=0)
    distances: FloatArray = placed.sum(axis=1) / objectives
    distances[(sizes <= 2)[ranks]] = np.inf
    return distances


def measurable(objectives: FloatArray) -> FloatArray:
    """Returns a copy with non-finite values replaced by one worse than all others of the column.

    Raises:
        SearchError: There is no candidate or no objective.
    """
    if objectives.ndim != 2 or not objectives.size:
        raise SearchError(
            f"objectives have the shape {objectives.shape}; needed: (n, m) of at least 1 candidate "
            "and 1 objective"
        )
    finite = np.isfinite(objectives)
    least = np.min(objectives, axis=0, where=finite, initial=np.inf)
    most = np.max(objectives, axis=0, where=finite, initial=-np.inf)
    known = finite.any(axis=0)
    worse = np.where(known, most + np.maximum(most - least, 1.0), 0.0)
    return np.where(finite, objectives, worse)


def draw_by_probability(chances: FloatArray, count: int, random: np.random.Generator) -> IntArray:
    """Draws ``count`` numbers of candidates by their probabilities (n,).

    The draws are those of ``Generator.choice``, without its checks, which take several times as
    long.
    """
    return cumulate_probabilities(chances).searchsorted(random.random(count), side="right")


def cumulate_probabilities(chances: FloatArray) -> FloatArray:
    """Returns the sums (n,) of the probabilities up to each candidate, the last of which is 1."""
    sums = chances.cumsum()
    sums /= sums[-1]
    return sums


@dataclass(frozen=True, slots=True, kw_only=True)
class Truncation:
    """Chooses the best candidates by their order; see ``best_first``."""

    def select(
        self,
        objectives: FloatArray,
        count: int,
        random: np.random.Generator,  # noqa: ARG002  # nothing is drawn
    ) -> IntArray:
        """Returns ``count`` rows, the best first; again from the best if there are fewer."""
        return np.resize(best_first(objectives), count)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tournament:
    """Chooses the best of some drawn candidates, repeatedly.

    Attributes:
        size: Number of candidates drawn each time, if there are as many.
    """

    size: int = 2

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        """Returns the rows (count,) of the winners, the best first; a row may occur repeatedly."""
        order = best_first(objectives)
        places = np.empty(len(order), dtype=np.int64)
        places[order] = np.arange(len(order))
        size = min(self.size, len(order))
        drawn = np.stack([random.permutation(len(order))[:size] for _ in range(count)])
        chosen: IntArray = order[np.sort(places[drawn].min(axis=1))]
        return chosen


@dataclass(frozen=True, slots=True, kw_only=True)
class Roulette:
    """Draws with a probability that grows with the fitness.

    The fitness is the distance to the worst measurable value, so it is never negative. With several
    objectives, the rank in the order counts instead. Candidates that are not measurable are drawn
    only if none is measurable.

    Attributes:
        floor: Fitness of the worst, as a share of the distance between the best and the worst.
    """

    floor: float = 0.1

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        """Returns the rows (count,) that were drawn, the most probable first."""
        chances = self.chances(objectives)
        drawn = draw_by_probability(chances, count, random)
        return drawn[np.argsort(-chances[drawn], kind="stable")]

    def chances(self, objectives: FloatArray) -> FloatArray:
        """Returns the probability (n,) of each candidate to be drawn."""
        if objectives.shape[1] == 1 and np.isfinite(objectives).all():
            return self._shares(objectives[:, 0])
        known: BoolArray = np.asarray(np.isfinite(objectives).any(axis=1))
        if not known.any():
            return np.full(len(objectives), 1.0 / len(objectives))
        if objectives.shape[1] == 1:
            costs = measurable(objectives)[:, 0]
        else:
            costs = np.empty(len(objectives))
            costs[best_first(objectives)] = np.arange(len(objectives))
        return self._shares(costs, known)

    def _shares(self, costs: FloatArray, known: BoolArray | None = None) -> FloatArray:
        measured = costs if known is None else costs[known]
        worst = measured.max()
        spread = worst - measured.min()
        fitness = worst - costs + self.floor * spread if spread > 0.0 else np.ones(len(costs))
        if known is not None:
            fitness = np.where(known, fitness, 0.0)
        chances: FloatArray = fitness / fitness.sum()
        return chances


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomSelection:
    """Chooses regardless of the objectives, without replacement until all have been chosen."""

    def select(self, objectives: FloatArray, count: int, random: np.random.Generator) -> IntArray:
        """Returns the rows (count,) in random order."""
        n = len(measurable(objectives))
        rounds = [random.permutation(n) for _ in range(-(-count // n))]
        return np.concatenate(rounds)[:count]


TRUNCATION = SelectionPlugin(name="truncation", description="chooses the best", create=Truncation)
TOURNAMENT = SelectionPlugin(
    name="tournament", description="chooses the better of two drawn candidates", create=Tournament
)
ROULETTE = SelectionPlugin(
    name="roulette",
    description="draws with a probability that grows with the fitness",
    create=Roulette,
)
RANDOM_SELECTION = SelectionPlugin(
    name="random", description="chooses regardless of the objectives", create=RandomSelection
)
