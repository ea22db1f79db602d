"""The features of candidates for the surrogates."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.search.genes import GeneSpace

_NEUTRAL = 0.5
"""Value of every feature of an absent actor."""


class Encoding:
    """Maps candidates to features in 0..1 with meaningful distances.

    Magnitudes are scaled to their bounds. A category becomes one feature for each of its values,
    0 or 1/sqrt(2), so that two different values are as far apart as the ends of a magnitude. The
    genes of an absent actor have no effect and are all encoded alike. Genes that do not vary are
    left out.

    Attributes:
        width: Number e of features.
    """

    def __init__(self, space: GeneSpace) -> None:
        """Creates the encoding of a space."""
        self._magnitudes = np.flatnonzero(space.varies & ~space.is_category)
        self._lows = space.lows[self._magnitudes]
        self._ranges = space.highs[self._magnitudes] - self._lows
        categories = np.flatnonzero(space.varies & space.is_category)
        self._categories = np.repeat(
            categories, (space.highs - space.lows + 1.0)[categories].astype(np.int64)
        )
        self._choices = np.concatenate(
            [np.arange(space.lows[gene], space.highs[gene] + 1.0) for gene in categories]
            or [np.empty(0)]
        )
        self.width = len(self._magnitudes) + len(self._choices)
        genes = np.concatenate((self._magnitudes, self._categories))
        # The gene of the presence of a feature's actor; the feature's own gene if there is none.
        self._present = genes.copy()
        for block in space.blocks:
            if block.is_optional:
                self._present[(genes > block.start) & (genes < block.stop)] = block.start
        self._dependent = np.flatnonzero(self._present != genes)
        self._present = self._present[self._dependent]

    def encode(self, values: FloatArray) -> FloatArray:
        """Returns the features (n, e) of candidates (n, d)."""
        features = np.empty((len(values), self.width))
        magnitudes = values.take(self._magnitudes, axis=1)
        magnitudes -= self._lows
        magnitudes /= self._ranges
        features[:, : len(self._magnitudes)] = magnitudes
        chosen = values.take(self._categories, axis=1) == self._choices
        np.multiply(chosen, np.sqrt(0.5), out=features[:, len(self._magnitudes) :])
        if len(self._dependent):
            rows, columns = np.nonzero(values.take(self._present, axis=1) == 0.0)
            features[rows, self._dependent[columns]] = _NEUTRAL
        return features
