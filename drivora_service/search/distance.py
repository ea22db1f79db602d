"""The distance between candidates."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.genes import GeneSpace
from drivora_service.search.points import actor_points

_TILE = 32_768
"""Number of pairs that are compared at once: two arrays of them stay in a core's cache."""

_COMPARED = 16
"""Number of candidates that are compared with all others at once."""

_SLACK = 1e-9
"""Difference of two mean distances, or of a bound, that is more than a rounding error."""

_EQUAL = 1e-12
"""Squared distance below which two actors are equal: it has a rounding error."""


def candidate_distances(first: FloatArray, second: FloatArray, space: GeneSpace) -> FloatArray:
    """Returns the distances between candidates, 0 for equals, at most 1.

    An actor's distance is the root mean square over its genes: for magnitudes, the difference as a
    share of the range; for categories, 1 if they differ. The candidates' distance is the mean over
    the actors. Genes of absent actors do not count, so two that lack an actor are equal in it.

    Args:
        first: (n, d) genes.
        second: (m, d) genes.
        space: Their bounds.

    Returns:
        (n, m).
    """
    total = np.zeros((len(first), len(second)))
    actors = actor_points(space)
    for actor in actors:
        total += _distances(_left(actor.points(first)), _right(actor.points(second)))
    return total / max(len(actors), 1)


def farthest(
    first: FloatArray, second: FloatArray, counts: FloatArray, space: GeneSpace, wanted: int
) -> IntArray:
    """Returns the rows of the candidates with the greatest mean distance to others.

    The distance is that of ``candidate_distances``. The root of the mean squared distance is never
    less than the mean distance, and takes one product with the mean of the others: only candidates
    for which it is great enough are compared with each of the others.

    Args:
        first: (n, d) genes.
        second: (m, d) genes.
        counts: (m,) number of times that each of the others counts; not all 0.
        space: Their bounds.
        wanted: Number of rows, at most n.

    Returns:
        (wanted,) the farthest first; the first ones among equals.
    """
    means = _Means(first, second, counts, space)
    bounds = means.bounds()
    order = np.argsort(-bounds, kind="stable")
    found = np.full(len(first), -np.inf)
    size = max(_COMPARED, wanted + 1)
    for start in range(0, len(first), size):
        rows = order[start : start + size]
        if start and bounds[rows[0]] < np.partition(found, -wanted)[-wanted] - _SLACK:
            break
        found[rows] = means.of(rows)
    best = np.argsort(-found, kind="stable")[: wanted + 1]
    if (-np.diff(found[best]) > _SLACK).all():
        return best[:wanted]
    # Candidates that are equal but for rounding are all compared in the same tiles, whatever the
    # bounds: which ones are farthest must depend on the candidates alone.
    return np.argsort(-means.of_all(), kind="stable")[:wanted]


class _Means:
    """The mean distances of candidates to others."""

    def __init__(
        self, first: FloatArray, second: FloatArray, counts: FloatArray, space: GeneSpace
    ) -> None:
        self._first, self._counts = first, counts
        self._actors = actor_points(space)
        self._others = [actor.points(second) for actor in self._actors]
        self._rights = [_right(other) for other in self._others]

    def of(self, rows: IntArray | slice) -> FloatArray:
        """Returns the mean distances of some of the candidates."""
        values = self._first[rows]
        sums = np.zeros(len(values))
        for actor, right in zip(self._actors, self._rights, strict=True):
            sums += _distances(_left(actor.points(values)), right) @ self._counts
        means: FloatArray = sums / (self._counts.sum() * max(len(self._actors), 1))
        return means

    def of_all(self) -> FloatArray:
        """Returns the mean distances (n,) of all candidates."""
        size = max(_TILE // len(self._counts), 1)
        tiles = range(0, len(self._first), size)
        return np.concatenate([self.of(slice(start, start + size)) for start in tiles])

    def bounds(self) -> FloatArray:
        """Returns values (n,) that are never less than the mean distances, but for rounding."""
        shares = self._counts / self._counts.sum()
        sums = np.zeros(len(self._first))
        for actor, others in zip(self._actors, self._others, strict=True):
            sums += np.sqrt(actor.mean_squares(self._first, others, shares))
        return sums / max(len(self._actors), 1)


def _left(points: FloatArray) -> FloatArray:
    """Returns a matrix (n, k + 2) whose product with ``_right`` is the squared distances."""
    squares = np.einsum("ij,ij->i", points, points)[:, None]
    return np.concatenate((points, squares, np.ones_like(squares)), axis=1)


def _right(points: FloatArray) -> FloatArray:
    squares = np.einsum("ij,ij->i", points, points)[None]
    return np.concatenate((-2.0 * points.T, np.ones_like(squares), squares))


def _distances(left: FloatArray, right: FloatArray) -> FloatArray:
    squares: FloatArray = left @ right
    squares[squares < _EQUAL] = 0.0
    return np.sqrt(squares, out=squares)
