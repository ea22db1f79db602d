"""BehAVExplor's model of behaviour: labels of motion windows, and runs as sequences of labels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.testers.behavexplor.k_means import (
    Clusters,
    distances_between,
    k_means,
    silhouettes,
)

FIT_ROWS = 1000
"""Number of windows, spread evenly over the archive, for a fit: more cost time, change little."""

CHOICE_ROWS = 500
"""The same for choosing the number of clusters, at a cost that grows with the square."""

CONSTANT = 1e-3
"""Standard deviation up to which a statistic counts as constant, in its own unit. A vehicle that
does not slide has next to no lateral speed; scaled to unit variance, rounding errors would cluster.
"""

_ABSENT = -1


def sequence_distances(sequence: IntArray, archive: IntArray, lengths: IntArray) -> FloatArray:
    """Returns the distances of a label sequence to others.

    The distance is the number of positions with different labels over the length of the longer
    sequence; positions that only one of the two has count as different.

    Args:
        sequence: (n,) labels, none negative.
        archive: (m, w) labels, -1 after the end of each sequence.
        lengths: (m,) lengths of the sequences.

    Returns:
        (m,) 0..1; 0 if both are empty.
    """
    width = max(len(sequence), archive.shape[1])
    # The fillings differ from each other and from all labels: positions after both ends count as
    # different, too, and are subtracted again.
    one = np.full(width, _ABSENT - 1, dtype=archive.dtype)
    one[: len(sequence)] = sequence
    others = np.full((len(archive), width), _ABSENT, dtype=archive.dtype)
    others[:, : archive.shape[1]] = archive
    longer = np.maximum(lengths, len(sequence))
    different = (others != one).sum(axis=1) - (width - longer)
    distances: FloatArray = different / np.maximum(longer, 1)
    return distances


class BehaviourModel:
    """Clusters the windows of an archive of runs, and measures the novelty of a run's behaviour.

    Statistics have units of their own and ranges that differ by orders of magnitude, so they are
    scaled to unit variance over the archive before they are clustered by k-means. The number of
    clusters is that with the best silhouette (Rousseeuw 1987); it is chosen again whenever the
    archive has doubled. A fit takes the better of two: one starts from the centres of the previous
    fit, which suit the known windows; one starts anew, and can separate the new ones from them.

    Attributes:
        fits: Number of fits of the clusters.
    """

    def __init__(self, *, fewest: int, most: int, random: np.random.Generator) -> None:
        """Creates a model with an empty archive.

        Args:
            fewest: Least number of clusters to choose from.
            most: Greatest number of clusters to choose from.
            random: Generator for the first centres.
        """
        self.fits = 0
        self._fewest = fewest
        self._most = most
        self._random = random
        self._rows: FloatArray = np.empty((0, 0))
        self._lengths: list[int] = []
        self._shift: FloatArray = np.empty(0)
        self._scale: FloatArray = np.empty(0)
        self._centres: FloatArray = np.empty((0, 0))
        self._rows_at_choice = 0
        self._archive: IntArray = np.empty((0, 0), dtype=np.int64)

    @property
    def clusters(self) -> int:
        """Number of clusters; 0 before the first fit."""
        return len(self._centres)

    @property
    def archived(self) -> int:
        """Number of runs in the archive."""
        return len(self._lengths)

    def labels(self, table: FloatArray) -> IntArray:
        """Returns the nearest cluster (n,) of each window (n, c); requires a fit."""
        # The weighted |x - c|² without the term that is equal for all centres; x is about the mean,
        # which is subtracted from the products instead of from every row.
        weights = self._scale**-2
        weighted = weights * self._centres
        shift = weighted @ self._shift
        costs = (self._centres**2) @ weights - 2.0 * (table @ weighted.T - shift)
        return np.asarray(costs.argmin(axis=1), dtype=np.int64)

    def novelty(self, table: FloatArray) -> float:
        """Returns the distance 0..1 of a run to the nearest of the archive; 1 for an empty one."""
        if not self.archived:
            return 1.0
        lengths = np.array(self._lengths)
        return float(sequence_distances(self.labels(table), self._archive, lengths).min())

    def extend(self, tables: Sequence[FloatArray]) -> None:
        """Takes runs (n, c), n >= 1, into the archive, fits the clusters anew and labels all."""
        self._lengths += [len(table) for table in tables]
        known = [self._rows] if self._rows.size else []
        self._rows = np.concatenate([*known, *tables])
        self._fit()
        self._label()

    def _fit(self) -> None:
        # Centres are kept about the mean of their time: they move with the scales.
        before = self._centres + self._shift if self.clusters else self._centres
        sample = _thin_rows(self._rows, FIT_ROWS)
        self._shift = sample.mean(axis=0)
        deviation = sample.std(axis=0)
        self._scale = np.where(deviation > CONSTANT, deviation, 1.0)
        scaled = (sample - self._shift) / self._scale
        if not self.clusters or len(self._rows) >= 2 * self._rows_at_choice:
            self._rows_at_choice = len(self._rows)
            start = self._choice(scaled)
        else:
            start = (before - self._shift) / self._scale
        on, anew = self._k_means(scaled, len(start), start), self._k_means(scaled, len(start))
        better = on if on.inertia <= anew.inertia else anew
        self._centres = better.centres * self._scale
        self.fits += 1

    def _choice(self, scaled: FloatArray) -> FloatArray:
        """Chooses the number of clusters, and with it the first centres."""
        sample = _thin_rows(scaled, CHOICE_ROWS)
        distances = distances_between(sample)
        most = min(self._most, len(sample))
        best, best_score = sample[:1], -np.inf
        for count in range(min(self._fewest, most), most + 1):
            fitted = self._k_means(sample, count)
            # A silhouette needs two clusters, and one of them with two members.
            can_score = 1 < len(np.unique(fitted.labels)) < len(sample)
            score = float(silhouettes(distances, fitted.labels).mean()) if can_score else -1.0
            if score > best_score:
                best, best_score = fitted.centres, score
        return best

    def _k_means(self, scaled: FloatArray, count: int, start: FloatArray | None = None) -> Clusters:
        return k_means(scaled, count, int(self._random.integers(2**31)), start)

    def _label(self) -> None:
        lengths = np.array(self._lengths)
        run = np.repeat(np.arange(len(lengths)), lengths)
        place = np.arange(len(run)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        self._archive = np.full((len(lengths), lengths.max()), _ABSENT, dtype=np.int64)
        self._archive[run, place] = self.labels(self._rows)


def _thin_rows(rows: FloatArray, most: int) -> FloatArray:
    """Returns at most ``most`` rows, spread evenly."""
    if len(rows) <= most:
        return rows
    return rows[np.linspace(0, len(rows) - 1, most).round().astype(np.int64)]
