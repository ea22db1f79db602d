"""Savitzky-Golay filters, as in SciPy, without its import: that would double a worker's start-up.

Savitzky and Golay, *Smoothing and differentiation of data by simplified least squares procedures*
(1964). The ends are read off a polynomial that is fitted to the first and to the last window.
"""

from __future__ import annotations

from functools import lru_cache
from math import factorial

import numpy as np

from drivora_service.geometry.arrays import FloatArray


@lru_cache(maxsize=32)
def _weights(window: int, order: int, derivative: int) -> FloatArray:
    """Gives the (window,) weights of a convolution; the sample spacing is 1."""
    position = (window - 1) / 2.0
    offsets = np.arange(-position, window - position)[::-1]
    powers = offsets ** np.arange(order + 1)[:, None]
    wanted = np.zeros(order + 1)
    wanted[derivative] = factorial(derivative)
    weights, *_ = np.linalg.lstsq(powers, wanted, rcond=None)
    return np.asarray(weights, dtype=np.float64)


def _fit(samples: FloatArray, order: int, derivative: int, at: FloatArray) -> FloatArray:
    """Fits a polynomial to (k, window) samples; gives its derivative (k, len(at)) at places."""
    places = np.arange(samples.shape[1], dtype=np.float64)
    fitted = np.polynomial.polynomial.polyfit(places, samples.T, order)
    if derivative:
        fitted = np.polynomial.polynomial.polyder(fitted, derivative)
    return np.asarray(np.polynomial.polynomial.polyval(at, fitted), dtype=np.float64)


def savitzky_golay(
    samples: FloatArray, window: int, order: int, *, derivative: int = 0, spacing: float = 1.0
) -> FloatArray:
    """Smooths signals, or gives their smoothed derivative.

    Args:
        samples: (k, n) signals, n >= window.
        window: Samples of a window, more than ``order``.
        order: Of the polynomials.
        derivative: 0 smooths.
        spacing: Between samples, in the unit by which is derived.

    Returns:
        (k, n) filtered signals.
    """
    count, half = samples.shape[1], window // 2
    weights = _weights(window, order, derivative)
    out = np.stack([np.convolve(row, weights)[half : half + count] for row in samples])
    ends = np.arange(half, dtype=np.float64)
    out[:, :half] = _fit(samples[:, :window], order, derivative, ends)
    out[:, count - half :] = _fit(
        samples[:, count - window :], order, derivative, ends + (window - half)
    )
    return out / spacing**derivative
