"""Savitzky-Golay filters of order 2, with the same bits on every processor.

The value or slope of a sample is that of the parabola fitted by least squares to the samples around
it; at both ends, of the parabola of the first or last samples (as ``scipy.signal.savgol_filter``
with ``mode="interp"``, whose weights come from a solver of LAPACK and have other last bits on other
processors). Over a window that is centred at 0, the polynomials 1, t and t² - c are orthogonal (c:
mean of t²), so that each weight has a closed form (Savitzky and Golay 1964; Gram polynomials).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.geometry.products import correlate


def smooth(signals: FloatArray, window: int) -> FloatArray:
    """Returns signals (m, n), each sample replaced by the value of its parabola.

    Args:
        signals: (m, n), n >= ``window``.
        window: Samples of a parabola, at least 3.
    """
    return _filter(signals, window, _value_weights)


def slopes(signals: FloatArray, window: int, step: float) -> FloatArray:
    """Returns the derivatives (m, n) of signals: the slopes of their parabolas.

    Args:
        signals: (m, n), n >= ``window``.
        window: Samples of a parabola, at least 3.
        step: Distance of two samples.
    """
    return _filter(signals, window, _slope_weights) / step


_Weights = Callable[[FloatArray, FloatArray], FloatArray]
"""From the samples' times (k,) and places (p, 1) to the weights (p, k) of the samples there."""


def _filter(signals: FloatArray, window: int, weigh: _Weights) -> FloatArray:
    """Returns what ``weigh`` takes of the parabola of each sample (m, n)."""
    half = window // 2
    times: FloatArray = np.arange(window, dtype=np.float64) - 0.5 * (window - 1)
    found = np.empty_like(signals)
    # Of an even window, the first of the two samples in the middle gets the value between them.
    begin = (window - 1) // 2
    end = begin + signals.shape[1] - window + 1
    found[:, begin:end] = correlate(signals, weigh(times, np.zeros((1, 1)))[0])
    for part, edge in ((slice(window), slice(half)), (slice(-window, None), slice(-half, None))):
        # Sums along the last axis are pairwise, in an order that depends on their length only.
        weights = weigh(times, times[edge, None])
        found[:, edge] = (signals[:, None, part] * weights).sum(axis=-1)
    return found


def _value_weights(times: FloatArray, places: FloatArray) -> FloatArray:
    squares, mean = times * times, float((times * times).mean())
    bends = squares - mean
    along = places * times / squares.sum()
    weights: FloatArray = (
        1.0 / len(times) + along + (places * places - mean) * bends / (bends * bends).sum()
    )
    return weights


def _slope_weights(times: FloatArray, places: FloatArray) -> FloatArray:
    squares = times * times
    bends = squares - squares.mean()
    weights: FloatArray = times / squares.sum() + 2.0 * places * bends / (bends * bends).sum()
    return weights
