"""Sums of products with the same bits on every processor.

``np.convolve``, ``@`` and ``np.linalg`` use BLAS, which adds in another order on each kind of
processor, with or without fused operations. Here the terms are added in their order.
"""

from __future__ import annotations

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray


def correlate(values: FloatArray, weights: FloatArray) -> FloatArray:
    """Returns the weighted sums (..., n - k + 1) of each k values in succession of (..., n)."""
    count = values.shape[-1] - len(weights) + 1
    found = np.zeros((*values.shape[:-1], count))
    for k, weight in enumerate(weights.tolist()):
        found += values[..., k : k + count] * weight
    return found


def moving_mean(values: FloatArray, count: int) -> FloatArray:
    """Returns the means (n - count + 1,) of each ``count`` values in succession."""
    return correlate(values, np.full(count, 1.0 / count))
