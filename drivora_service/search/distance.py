"""The distance between candidates."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.genes import GeneSpace
from drivora_service.search.mutation import effective_genes, varying_blocks

_TILE = 32_768
"""Number of pairs that are compared at once: two arrays of them stay in a core's cache."""

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
    ones, others = _points(first, space), _points(second, space)
    for one, other in zip(ones, others, strict=True):
        total += _distances(_left(one), _right(other))
    return total / max(len(ones), 1)


def mean_distances(
    first: FloatArray, second: FloatArray, counts: FloatArray, space: GeneSpace
) -> FloatArray:
    """Returns the mean distance of candidates to others, as ``candidate_distances`` defines it.

    Args:
        first: (n, d) genes.
        second: (m, d) genes.
        counts: (m,) number of times that each of the others counts; not all 0.
        space: Their bounds.

    Returns:
        (n,).
    """
    sums = np.zeros(len(first))
    size = max(_TILE // len(second), 1)
    ones, others = _points(first, space), _points(second, space)
    for one, other in zip(ones, others, strict=True):
        left, right = _left(one), _right(other)
        for start in range(0, len(first), size):
            rows = slice(start, start + size)
            sums[rows] += _distances(left[rows], right) @ counts
    means: FloatArray = sums / (counts.sum() * max(len(ones), 1))
    return means


def _points(values: FloatArray, space: GeneSpace) -> list[FloatArray]:
    """Returns candidates (n, d) as points (n, k), one array an actor.

    The distance of two points is the distance of the actors. A category has one coordinate for each
    of its values, and one for absent actors.
    """
    effective = effective_genes(values, space)
    above, ranges = values - space.lows, space.highs - space.lows
    points = []
    for block in varying_blocks(space):
        genes = np.arange(block.start, block.stop)[space.varies[block.slice]]
        is_category = space.is_category[genes]
        magnitudes, categories = genes[~is_category], genes[is_category]
        shares = above[:, magnitudes] / ranges[magnitudes]
        columns = [np.where(effective[:, magnitudes], shares, 0.0)]
        for gene in categories:
            number = np.where(effective[:, gene], above[:, gene] + 1.0, 0.0)
            columns.append((number[:, None] == np.arange(ranges[gene] + 2.0)) * np.sqrt(0.5))
        points.append(np.concatenate(columns, axis=1) / np.sqrt(len(genes)))
    return points


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
