"""Actors of candidates as points: the distance of two points is the distance of the actors.

An actor's distance is the root mean square over its genes that vary: for magnitudes, the difference
as a share of the range; for categories, 1 if they differ. So a magnitude has one coordinate, and a
category one for each of its values, after one for absent actors.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray, IntArray
from drivora_service.search.genes import Block, GeneSpace


class ActorPoints:
    """The coordinates of one actor, or of the weather or the lights."""

    def __init__(self, block: Block, space: GeneSpace) -> None:
        """Lays out the coordinates: first the magnitudes, then the values of the categories."""
        genes = block.start + np.flatnonzero(space.varies[block.slice])
        is_category = space.is_category[genes]
        self._magnitudes, self._categories = genes[~is_category], genes[is_category]
        self._lows = space.lows[self._magnitudes]
        self._ranges = space.ranges[self._magnitudes]
        self._presence = block.start if block.is_optional else None
        self._root = float(np.sqrt(len(genes)))
        self._choice = float(np.sqrt(0.5)) / self._root
        widths = (space.ranges[self._categories] + 2.0).astype(np.int64)
        ends = len(self._magnitudes) + np.cumsum(widths)
        self._absent = ends - widths
        self._numbers = self._absent + 1.0 - space.lows[self._categories]
        self._width = int(ends[-1]) if len(ends) else len(self._magnitudes)

    def points(self, values: FloatArray) -> FloatArray:
        """Returns candidates (n, d) as points (n, k)."""
        found = np.zeros((len(values), self._width))
        found[:, : len(self._magnitudes)] = self._shares(values)
        found[np.arange(len(values))[:, None], self._find_columns(values)] = self._choice
        return found

    def mean_squares(
        self, values: FloatArray, others: FloatArray, weights: FloatArray
    ) -> FloatArray:
        """Returns the mean squared distances (n,) of candidates to points.

        Args:
            values: (n, d) genes.
            others: (m, k) points.
            weights: (m,) shares of the points in the mean; 1 in all.
        """
        mean = weights @ others
        # The sum over the magnitudes of s (s - 2 m), s = (v - low) / scale, as products with v.
        scales, lows = self._ranges * self._root, self._lows
        linear = 2.0 * (lows / scales + mean[: len(lows)]) / scales
        found = values.take(self._magnitudes, axis=1)
        found = (found * found) @ scales**-2 - found @ linear
        found += float(lows @ (linear - lows / scales**2))
        if self._presence is not None:
            found[values[:, self._presence] == 0.0] = 0.0
        for column in self._find_columns(values).T:
            found += (self._choice * (self._choice - 2.0 * mean)).take(column)
        found += weights @ np.einsum("ij,ij->i", others, others)
        return np.maximum(found, 0.0, out=found)

    def _shares(self, values: FloatArray) -> FloatArray:
        """Returns the coordinates (n, ...) of the magnitudes."""
        shares = values.take(self._magnitudes, axis=1)
        shares -= self._lows
        shares /= self._ranges
        if self._presence is not None:
            shares[values[:, self._presence] == 0.0] = 0.0
        shares /= self._root
        return shares

    def _find_columns(self, values: FloatArray) -> IntArray:
        """Returns the coordinate of the value of each category (n, ...)."""
        chosen = (values.take(self._categories, axis=1) + self._numbers).astype(np.int64)
        if self._presence is not None:
            chosen[values[:, self._presence] == 0.0] = self._absent
        return chosen


@lru_cache(maxsize=4)
def actor_points(space: GeneSpace) -> tuple[ActorPoints, ...]:
    """Returns the coordinates of each block that varies."""
    return tuple(ActorPoints(block, space) for block in space.varying_blocks)
