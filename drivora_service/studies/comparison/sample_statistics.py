"""Comparing two samples without assuming a distribution.

Mann-Whitney's U test tells whether a difference is more than chance, Vargha and Delaney's A12 how
large it is: the probability that a value of one sample is larger than one of the other, ties
counting half (Vargha and Delaney 2000; 0.56, 0.64 and 0.71 are called small, medium and large).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivora_service.errors import CampaignError

Sample = Sequence[float] | NDArray[np.float64]

CONFIDENCE = 0.95
_END = 1e-9
"""Distance from 0 and 1, where the standard error is 0 and would end the search at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """The effect of a sample against another.

    Attributes:
        a12: Probability that a value of the first is larger than one of the second.
        low: Lower end of the 95 % confidence interval of ``a12``.
        high: Upper end.
        p: Two-sided p of Mann-Whitney's U test; 1 where all values are the same.
    """

    a12: float
    low: float
    high: float
    p: float


def compare_samples(first: Sample, second: Sample) -> Effect:
    """Compares two samples of at least two finite values each.

    Raises:
        CampaignError: A sample is too small, or a value is not finite.
    """
    x, y = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    for name, sample in (("first", x), ("second", y)):
        if len(sample) < 2:
            raise CampaignError(
                f"the {name} sample has {len(sample)} repetitions; at least 2 are needed, and 20 "
                "for a reliable result"
            )
        if not np.isfinite(sample).all():
            raise CampaignError(f"the {name} sample holds a value that is not finite")
    if x.min() == x.max() == y.min() == y.max():
        # The ranks have no variance: some versions of SciPy answer p = 1, others NaN.
        low, high = a12_interval(0.5, len(x), len(y))
        return Effect(a12=0.5, low=low, high=high, p=1.0)
    # Imported here and below: importing it takes half a second, which the service's start skips.
    from scipy import stats

    # Also for few values: the exact distribution is that of ranks without ties, and counts of
    # failures have many.
    test = stats.mannwhitneyu(x, y, alternative="two-sided", method="asymptotic")
    # U counts the pairs in which the first is larger, ties half.
    a12 = float(test.statistic) / (len(x) * len(y))
    low, high = a12_interval(a12, len(x), len(y))
    return Effect(a12=a12, low=low, high=high, p=float(test.pvalue))


def a12_interval(a12: float, n: int, m: int) -> tuple[float, float]:
    """Returns the 95 % confidence interval of A12 for samples of ``n`` and ``m`` values.

    Method 5 of Newcombe 2006 ("Confidence intervals for an effect size measure based on the
    Mann-Whitney statistic", part 2): all values whose distance from ``a12`` is within z standard
    errors, these being Hanley and McNeil's at that value. It stays within 0..1, and has a width at
    its ends too.
    """
    from scipy import optimize, stats

    z = float(stats.norm.ppf(0.5 + CONFIDENCE / 2.0))
    # Hanley and McNeil (1982) have n - 1 and m - 1 for the two terms below, which are those of
    # exponential distributions. Method 5 has their mean for both, so that the interval is mirrored
    # if all values are negated.
    half = (n + m) / 2.0 - 1.0

    def spread(value: float) -> float:
        ties = 1.0 + half * (1.0 - value) / (2.0 - value) + half * value / (1.0 + value)
        return z * math.sqrt(value * (1.0 - value) * ties / (n * m))

    # The standard error at the sought value and not at a12: at 0 and 1 that of a12 is 0, and the
    # interval would have no width there. Each search is between a12, where the difference is
    # negative, and the end of 0..1, where it is not; at an a12 of 1 or 0, that end itself is left
    # out, as the other end's search would take it for its solution.
    low = high = a12
    if a12 > 0.0:
        low = float(optimize.brentq(lambda v: a12 - v - spread(v), 0.0, min(a12, 1.0 - _END)))
    if a12 < 1.0:
        high = float(optimize.brentq(lambda v: v - a12 - spread(v), max(a12, _END), 1.0))
    return low, high


def holm(p_values: Sequence[float]) -> tuple[float, ...]:
    """Corrects p-values for their number by Holm's step-down method, in the order given.

    Raises:
        CampaignError: A p-value is NaN. It has no place in the order of the others, which would be
            corrected wrongly.
    """
    if any(map(math.isnan, p_values)):
        raise CampaignError(
            f"a p-value to correct is not a number: {', '.join(f'{p:g}' for p in p_values)}; a "
            "test that cannot tell two samples apart must give p = 1"
        )
    # Holm 1979 ("A simple sequentially rejective multiple test procedure"): the smallest of k is
    # multiplied by k, the next by k - 1, as it is tested only if the first was significant. A
    # larger p must not become smaller than one before it, hence the running maximum.
    order = sorted(range(len(p_values)), key=p_values.__getitem__)
    corrected = [0.0] * len(p_values)
    largest = 0.0
    for rank, index in enumerate(order):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
        corrected[index] = largest
    return tuple(corrected)
