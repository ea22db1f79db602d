"""Groups of similar failures: chains of neighbours by the situation of each violation.

The features of a violation are its place, its time, and the oracle's evidence: numbers as they are,
words one-hot. Those of one oracle are scaled to 0..1 by their least and greatest value, so that the
size of groups follows the spread of the violations; a spread below one SI unit is not stretched.
Failures of different oracles are never in one group. (scenoRITA, Huai et al. 2023, groups
violations in this way, by DBSCAN, which with single failures as cores gives these chains.)
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.oracles.verdict import Verdict

_FEW = 2000
"""Failures up to which comparing each with each takes less time than importing SciPy's tree."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Grouping:
    """The parameters of the grouping.

    Attributes:
        radius: Greatest distance of neighbours in a group, as the root mean square over features
            that are scaled to 0..1. A failure without neighbours is a group by itself.
    """

    radius: float = 0.15

    def label(self, verdicts: Sequence[Verdict]) -> tuple[int, ...]:
        """Returns the number of the group of each violation, from 0 within its oracle."""
        by_oracle: dict[str, list[int]] = defaultdict(list)
        for index, verdict in enumerate(verdicts):
            by_oracle[verdict.oracle].append(index)
        labels = np.zeros(len(verdicts), dtype=np.int64)
        for indices in by_oracle.values():
            features = situation_features([verdicts[index] for index in indices])
            labels[indices] = self._label(features)
        return tuple(labels.tolist())

    def count(self, verdicts: Sequence[Verdict]) -> int:
        """Returns the number of groups of the violations of one campaign.

        The scale is their own spread: numbers of different campaigns cannot be compared.
        """
        labels = self.label(verdicts)
        return len({(one.oracle, label) for one, label in zip(verdicts, labels, strict=True)})

    def _label(self, features: FloatArray) -> NDArray[np.int64]:
        count = len(features)
        if count == 1 or not features.shape[1]:
            return np.zeros(count, dtype=np.int64)
        # A root mean square instead of a sum, so that the radius means the same for every oracle.
        points = scale(features) / math.sqrt(features.shape[1])
        return (chains_of_few if count <= _FEW else chains_of_many)(points, self.radius)


def chains_of_few(points: FloatArray, radius: float) -> NDArray[np.int64]:
    """Returns the numbers of the chains of neighbours, in the order of their first points.

    Args:
        points: (n, d) points.
        radius: Greatest distance of neighbours.
    """
    columns = np.ascontiguousarray(points.T)
    labels = np.full(len(points), -1, dtype=np.int64)
    chains = 0
    for first in range(len(points)):
        if labels[first] >= 0:
            continue
        labels[first] = chains
        waiting = [first]
        while waiting:
            squared = _squared_distances(columns, waiting.pop())
            found = np.flatnonzero((squared <= radius * radius) & (labels < 0))
            labels[found] = chains
            waiting += found.tolist()
        chains += 1
    return labels


def chains_of_many(points: FloatArray, radius: float) -> NDArray[np.int64]:
    """Returns the same as :func:`chains_of_few`, faster for thousands of points."""
    # Imported here: they take half a second. The DBSCAN of scikit-learn gives the same groups, and
    # takes several times as long to import.
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    count = len(points)
    pairs = KDTree(points).query_pairs(radius, output_type="ndarray")
    near = coo_array((np.ones(len(pairs), dtype=np.int8), pairs.T), shape=(count, count))
    _, groups = connected_components(near, directed=False)
    _, first, place = np.unique(groups, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[place]


def _squared_distances(columns: FloatArray, point: int) -> FloatArray:
    """Returns the (n,) squared distances of the points of (d, n) columns from one of them."""
    squares = [(column - column[point]) ** 2 for column in columns]
    full = len(squares) - len(squares) % 4
    # Added in the order of SciPy's tree, so that both find the same distances to the last bit.
    sums = [sum(squares[lane:full:4], np.zeros(columns.shape[1])) for lane in range(4)]
    return sum(squares[full:], sums[0] + sums[1] + sums[2] + sums[3])


def situation_features(verdicts: Sequence[Verdict]) -> FloatArray:
    """Returns (n, d) features of violations of one oracle.

    A feature is kept if it is measured, and finite, in every violation.
    """
    columns: list[list[float]] = []
    places = [verdict.location for verdict in verdicts]
    if all(place is not None for place in places):
        columns += [[place[axis] for place in places if place is not None] for axis in (0, 1)]
    times = [verdict.time for verdict in verdicts if verdict.time is not None]
    if len(times) == len(verdicts):
        columns.append(times)
    common = set.intersection(*({*verdict.evidence} for verdict in verdicts))
    for name in sorted(common):
        values = [verdict.evidence[name] for verdict in verdicts]
        if all(_is_number(value) for value in values):
            columns.append([float(value) for value in values])
        elif name in _CATEGORIES and all(isinstance(value, str) for value in values):
            columns += [[float(value == known) for value in values] for known in sorted({*values})]
    return np.array(columns, dtype=np.float64).reshape(len(columns), len(verdicts)).T


def scale(features: FloatArray) -> FloatArray:
    """Scales (n, d) features to 0..1 by their least and greatest value; small spreads stay."""
    low, high = features.min(axis=0), features.max(axis=0)
    scaled: FloatArray = (features - low) / np.maximum(high - low, 1.0)
    return scaled


_CATEGORIES = frozenset({"counterpart_role", "face", "front_crossed_on"})
"""Textual evidence from a fixed set of words; other texts are not features."""


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return math.isfinite(value)
