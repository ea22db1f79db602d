"""The distance between candidates."""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.arrays import FloatArray
from drivora_service.search.genes import GeneSpace
from drivora_service.search.mutation import effective_genes, varying_blocks

_ABSENT = -1.0


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
    # Imported here: SciPy takes a fifth of a second, which listing campaigns must not wait.
    from scipy.spatial.distance import cdist

    one, other = _coordinates(first, space), _coordinates(second, space)
    total = np.zeros((len(first), len(second)))
    blocks = varying_blocks(space)
    for block in blocks:
        genes = np.arange(block.start, block.stop)[space.varies[block.slice]]
        is_category = space.is_category[genes]
        magnitudes, categories = genes[~is_category], genes[is_category]
        squares = np.zeros_like(total)
        if len(magnitudes):
            squares += cdist(one[:, magnitudes], other[:, magnitudes], "sqeuclidean")
        if len(categories):
            unequal = cdist(one[:, categories], other[:, categories], "hamming")
            squares += unequal * len(categories)
        total += np.sqrt(squares / len(genes))
    return total / max(len(blocks), 1)


def _coordinates(values: FloatArray, space: GeneSpace) -> FloatArray:
    """Returns magnitudes scaled to 0..1 and categories unchanged; equal for all absent actors."""
    span = np.where(space.varies, space.highs - space.lows, 1.0)
    shares = np.where(space.is_category, values, (values - space.lows) / span)
    effective = effective_genes(values, space)
    return np.where(effective, shares, np.where(space.is_category, _ABSENT, 0.0))
