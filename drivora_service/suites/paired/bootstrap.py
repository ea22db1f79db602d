"""Confidence intervals of means by the bootstrap over scenarios.

Scenarios are drawn with replacement, each with all its runs and metrics: runs of one scenario with
several seeds are not independent. The intervals are bias-corrected and accelerated (BCa; Efron
1987, "Better bootstrap confidence intervals"). All metrics share the drawn scenarios: drawing them
for each metric would take most of the time.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

CONFIDENCE = 0.95
RESAMPLES = 5000
SEED = 1
"""The same data gives the same intervals."""
_VALUES_AT_ONCE = 4_000_000
"""Drawn scenarios in memory at once."""

Interval = tuple[float, float]


def mean_intervals(
    values: NDArray[np.float64], *, resamples: int = RESAMPLES, seed: int = SEED
) -> tuple[Interval | None, ...]:
    """Returns the 95 % interval of the mean of each column.

    Args:
        values: A row for each scenario, a column for each metric; NaN: not measurable.
        resamples: Number of drawn samples.
        seed: Seeds the draws.

    Returns:
        ``None`` for a column with fewer than two values; both ends are the mean where all are the
        same.
    """
    means = _resample_means(values, resamples, seed)
    return tuple(
        _interval(values[:, column], means[:, column]) for column in range(values.shape[1])
    )


def _resample_means(values: NDArray[np.float64], resamples: int, seed: int) -> NDArray[np.float64]:
    """Returns the mean of each column in each drawn sample; NaN where it drew no value."""
    # A sample is the number of times that each scenario was drawn, so that the means of all metrics
    # are two products of matrices. A metric that a scenario lacks is left out of both.
    known = np.isfinite(values)
    filled = np.where(known, values, 0.0)
    parts = []
    for counts in _draws(len(values), resamples, np.random.default_rng(seed)):
        drawn = counts @ known.astype(np.float64)
        parts.append(np.where(drawn > 0.0, counts @ filled / np.maximum(drawn, 1.0), np.nan))
    return np.concatenate(parts)


def _draws(n: int, resamples: int, rng: np.random.Generator) -> Iterator[NDArray[np.float64]]:
    """Yields how often each of ``n`` scenarios is in each sample, some samples at a time."""
    at_once = max(1, _VALUES_AT_ONCE // max(n, 1))
    for start in range(0, resamples, at_once):
        samples = min(at_once, resamples - start)
        # Each sample counts in a range of its own, so that one call counts for all of them.
        drawn = rng.integers(0, n, size=(samples, n))
        drawn += n * np.arange(samples)[:, None]
        counts = np.bincount(drawn.ravel(), minlength=samples * n).reshape(samples, n)
        yield counts.astype(np.float64)


def _interval(values: NDArray[np.float64], means: NDArray[np.float64]) -> Interval | None:
    known = values[np.isfinite(values)]
    if len(known) < 2:
        return None
    mean = float(known.mean())
    # Every sample has the same mean, and the acceleration would divide 0 by 0.
    if np.ptp(known) == 0.0:
        return mean, mean
    from scipy import stats

    means = means[np.isfinite(means)]
    # Means of discrete values are often equal to the observed one, but for rounding.
    near = np.isclose(means, mean, rtol=1e-12, atol=1e-12 * float(np.ptp(known)))
    # Those count half, or the bias correction would depend on how ties happen to be rounded.
    below = float(((means < mean) & ~near).mean() + 0.5 * near.mean())
    # By the jackknife (Efron and Tibshirani, "An introduction to the bootstrap", 1993, eq. 14.15).
    # Leaving a value out moves the mean by -(value - mean) / (n - 1), of which the factor cancels.
    apart = np.ldexp(known - mean, -int(np.frexp(np.ptp(known))[1]))
    acceleration = float((apart**3).sum() / (6.0 * (apart**2).sum() ** 1.5))
    # Eq. 14.14 for the bias, and below 14.10 for the shares of the samples at which the ends are.
    bias = float(stats.norm.ppf(below))
    ends = []
    for share in ((1.0 - CONFIDENCE) / 2.0, (1.0 + CONFIDENCE) / 2.0):
        z = bias + float(stats.norm.ppf(share))
        corrected = float(stats.norm.cdf(bias + z / (1.0 - acceleration * z)))
        ends.append(float(np.quantile(means, corrected)))
    return ends[0], ends[1]
