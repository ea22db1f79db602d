"""k-means and the silhouette, for tables of about a thousand rows.

The algorithms are those of scikit-learn, with the same draws, so the same clusters are found; the
tests compare them. scikit-learn takes a second to import, and its checks take longer than the
arithmetic here (decision 18).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray

_ITERATIONS = 300
"""Greatest number of iterations."""

_TOLERANCE = 1e-4
"""Sum of the squared moves of the centres, over the mean variance, at which they have converged."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Clusters:
    """Clusters of n points.

    Attributes:
        centres: (k, c).
        labels: (n,) number of the cluster of each point.
        inertia: Sum of the squared distances of the points to their centres.
    """

    centres: FloatArray
    labels: IntArray
    inertia: float


def k_means(points: FloatArray, count: int, seed: int, start: FloatArray | None = None) -> Clusters:
    """Clusters points by Lloyd's algorithm.

    Args:
        points: (n, c), n >= ``count``.
        count: Number of clusters; some are empty if fewer points differ.
        seed: Seed of the draws.
        start: (count, c) first centres; ``None``: drawn by k-means++.
    """
    mean = points.mean(axis=0)
    # About the mean, products have smaller rounding errors.
    rows = points - mean
    centres = _plus_plus(rows, count, seed) if start is None else start - mean
    tolerance = _TOLERANCE * float(rows.var(axis=0).mean())
    labels = np.full(len(rows), -1)
    for _ in range(_ITERATIONS):
        before, labels = labels, _nearest(rows, centres)
        moved = _means(rows, labels, centres)
        shift = float(np.sum((moved - centres) ** 2))
        centres = moved
        if np.array_equal(labels, before):
            break
        if shift <= tolerance:
            labels = _nearest(rows, centres)
            break
    else:
        labels = _nearest(rows, centres)
    inertia = float(np.sum((rows - centres[labels]) ** 2))
    return Clusters(centres=centres + mean, labels=labels, inertia=inertia)


def silhouettes(distances: FloatArray, labels: IntArray) -> FloatArray:
    """Returns the silhouette of each point (Rousseeuw 1987); 0 if it is alone in its cluster.

    Args:
        distances: (n, n) between the points.
        labels: (n,) clusters; at least two.
    """
    _, numbers = np.unique(labels, return_inverse=True)
    members = np.eye(numbers.max() + 1)[numbers]
    sizes = members.sum(axis=0)
    sums = distances @ members
    own = np.arange(len(labels)), numbers
    alone = sizes[numbers] == 1.0
    within = sums[own] / np.where(alone, 1.0, sizes[numbers] - 1.0)
    means = sums / sizes
    means[own] = np.inf
    between = means.min(axis=1)
    greater = np.maximum(within, between)
    is_known = ~alone & (greater > 0.0)
    found: FloatArray = np.where(
        is_known, (between - within) / np.where(greater > 0.0, greater, 1.0), 0.0
    )
    return found


def distances_between(points: FloatArray) -> FloatArray:
    """Returns the distances (n, n) between points (n, c)."""
    squares = np.einsum("ij,ij->i", points, points)
    found = squares[:, None] + squares - 2.0 * (points @ points.T)
    np.fill_diagonal(found, 0.0)
    distances: FloatArray = np.sqrt(np.maximum(found, 0.0))
    return distances


def _plus_plus(rows: FloatArray, count: int, seed: int) -> FloatArray:
    """Draws first centres by greedy k-means++ (Arthur and Vassilvitskii 2007).

    Points far from all centres so far are more likely; the best of a few draws is taken.
    """
    # The generator that scikit-learn uses: with another one the clusters would be others.
    random = np.random.RandomState(seed)
    n = len(rows)
    squares = np.einsum("ij,ij->i", rows, rows)
    draws = 2 + int(math.log(count))
    chosen = [int(random.choice(n, p=np.full(n, 1.0 / n)))]
    nearest = _compute_squared_distances(rows[chosen], squares[chosen], rows, squares)[0]
    for _ in range(1, count):
        cumulated = np.cumsum(nearest)
        drawn = np.searchsorted(cumulated, random.uniform(size=draws) * nearest.sum())
        drawn = np.minimum(drawn, n - 1)
        nearer = np.minimum(
            nearest, _compute_squared_distances(rows[drawn], squares[drawn], rows, squares)
        )
        best = int(nearer.sum(axis=1).argmin())
        nearest = nearer[best]
        chosen.append(int(drawn[best]))
    return rows[chosen]


def _compute_squared_distances(
    first: FloatArray, first_squares: FloatArray, second: FloatArray, second_squares: FloatArray
) -> FloatArray:
    """Returns the squared distances (q, n) of points (q, c) and (n, c)."""
    found: FloatArray = -2.0 * (first @ second.T)
    found += first_squares[:, None]
    found += second_squares
    return np.maximum(found, 0.0, out=found)


def _nearest(rows: FloatArray, centres: FloatArray) -> IntArray:
    """Returns the number (n,) of the nearest centre."""
    costs = rows @ (-2.0 * centres).T
    costs += np.einsum("ij,ij->i", centres, centres)
    nearest: IntArray = costs.argmin(axis=1)
    return nearest


def _means(rows: FloatArray, labels: IntArray, centres: FloatArray) -> FloatArray:
    """Returns the means (k, c) of the clusters.

    An empty cluster takes over the point farthest from its centre. If no point is away from its
    centre, it is put on the centre of the greatest cluster.
    """
    members = (labels == np.arange(len(centres))[:, None]).astype(np.float64)
    sizes = members.sum(axis=1)
    sums: FloatArray = members @ rows
    empty = np.flatnonzero(sizes == 0.0)
    if len(empty):
        away = np.sum((rows - centres[labels]) ** 2, axis=1)
        if away.max() > 0.0:
            farthest = np.argpartition(away, -len(empty))[: -len(empty) - 1 : -1]
            for cluster, row in zip(empty, farthest, strict=True):
                sums[labels[row]] -= rows[row]
                sizes[labels[row]] -= 1.0
                sums[cluster] = rows[row]
                sizes[cluster] = 1.0
    means: FloatArray = sums / np.maximum(sizes, 1.0)[:, None]
    means[sizes == 0.0] = means[sizes.argmax()]
    return means
