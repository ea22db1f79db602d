"""McNemar's exact test for paired failures, and Tango's interval for their difference."""

from __future__ import annotations

import math
from dataclasses import dataclass

CONFIDENCE = 0.95
_END = 1e-9
"""Distance from -1 and 1, where the standard error is 0 and would end the search at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShareDifference:
    """The share of scenarios in which B fails less that of A.

    Attributes:
        difference: B's share minus A's, -1..1.
        low: Lower end of its 95 % confidence interval.
        high: Upper end.
        p: Two-sided p of McNemar's exact test; 1 where no scenario tells A from B.
    """

    difference: float
    low: float
    high: float
    p: float


def compare_shares(*, a_only: int, b_only: int, scenarios: int) -> ShareDifference | None:
    """Compares in how many scenarios A and B fail.

    Args:
        a_only: Scenarios in which A fails and B does not.
        b_only: Scenarios in which B fails and A does not.
        scenarios: All scenarios.

    Returns:
        ``None`` without scenarios.
    """
    if not scenarios:
        return None
    low, high = tango_interval(b_only, a_only, scenarios)
    return ShareDifference(
        difference=(b_only - a_only) / scenarios,
        low=low,
        high=high,
        p=mcnemar_p(a_only, b_only),
    )


def mcnemar_p(first: int, second: int) -> float:
    """Returns the two-sided p of McNemar's exact test for two numbers of discordant pairs.

    If both outcomes are equally likely to fail alone, each discordant pair is a toss of a fair
    coin (McNemar 1947, with the binomial distribution instead of its approximation).
    """
    # Exact, as few scenarios differ in the comparisons that matter (decision 56). Pairs in which
    # both fail or neither does tell nothing about which of them fails more, and are left out.
    if not first + second:
        return 1.0
    # Imported here: importing it takes half a second, which the service's start skips.
    from scipy import stats

    return float(stats.binomtest(first, first + second, 0.5).pvalue)


def tango_interval(more: int, less: int, n: int) -> tuple[float, float]:
    """Returns the 95 % confidence interval of (more - less) / n for paired shares.

    All differences that the score test does not reject (Tango 1998, "Equivalence test and
    confidence interval for the difference in proportions for the paired-sample design"). It has a
    width also where no pair differs.

    Args:
        more: Pairs in which only the first share counts one.
        less: Pairs in which only the second does.
        n: All pairs.
    """
    from scipy import optimize, stats

    # Given a difference delta, the most likely share q of pairs in which only the second counts is
    # the larger root of 2n q² + linear q + product = 0. It gives the variance under delta, which is
    # n (2q + delta - delta²); the observed one would be 0 where no pair differs.
    z = float(stats.norm.ppf(0.5 + CONFIDENCE / 2.0))
    first, last = -1.0 + _END, 1.0 - _END

    def score(delta: float) -> float:
        linear = -more - less + (2 * n - more + less) * delta
        product = -less * delta * (1.0 - delta)
        # By rounding, the discriminant may be slightly negative.
        root = math.sqrt(max(0.0, linear * linear - 8.0 * n * product))
        least = (root - linear) / (4.0 * n)
        variance = n * (2.0 * least + delta * (1.0 - delta))
        return (more - less - n * delta) / math.sqrt(max(variance, _END * _END))

    # The score falls as the difference grows, from above z to below -z unless an end of -1..1 is
    # itself compatible with the data; then the interval reaches it.
    low = (
        first if score(first) <= z else float(optimize.brentq(lambda d: score(d) - z, first, last))
    )
    high = (
        last if score(last) >= -z else float(optimize.brentq(lambda d: score(d) + z, first, last))
    )
    return (-1.0 if low == first else low), (1.0 if high == last else high)
