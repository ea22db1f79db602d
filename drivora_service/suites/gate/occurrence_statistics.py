"""Whether failures that occur in some runs occur more often than before, and how sure a mean is."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

_Z_95 = 1.959963984540054
"""97.5 % quantile of the standard normal distribution."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Occurrences:
    """How often something occurred.

    Attributes:
        runs: Runs in which it did.
        of: All runs.
    """

    runs: int
    of: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """A mean with its confidence interval; ``low`` and ``high`` are ``None`` without one."""

    mean: float
    low: float | None = None
    high: float | None = None

    def __str__(self) -> str:
        """Returns the mean and its interval."""
        mean = f"{self.mean:.4g}"
        return mean if self.low is None else f"{mean} ({self.low:.4g} to {self.high:.4g})"

    @property
    def least(self) -> float:
        """The lower end; the mean without an interval."""
        return self.mean if self.low is None else self.low

    @property
    def most(self) -> float:
        """The upper end; the mean without an interval."""
        return self.mean if self.high is None else self.high


def p_of_more(before: Occurrences, now: Occurrences) -> float:
    """Returns the one-sided p of Fisher's exact test that something occurs more often now.

    It is the probability of at least as many occurrences now, given their number before and now
    together, if nothing has changed.
    """
    if not now.runs:
        # At least none is certain. Without any run SciPy answers NaN.
        return 1.0
    # Imported here: importing it takes half a second, which commands without a gate skip.
    from scipy import stats

    # Exact, since a scenario is run a few times only. Given both margins, the number of occurrences
    # now is hypergeometric; its survival function at one less has the observed number in it.
    every, occurred = before.of + now.of, before.runs + now.runs
    return float(stats.hypergeom.sf(now.runs - 1, every, occurred, now.of))


def p_of_more_overall(pairs: Iterable[tuple[Occurrences, Occurrences]]) -> float | None:
    """Returns the one-sided p that failures of all strata together occur more often now.

    The test of Cochran, Mantel and Haenszel with a correction for continuity: each stratum (a
    scenario) keeps its own frequency, so that hard and easy ones do not hide a common change.

    Args:
        pairs: Before and now, of each stratum.

    Returns:
        ``None`` if no stratum can show a difference.
    """
    surplus = variance = 0.0
    for before, now in pairs:
        every, occurred = before.of + now.of, before.runs + now.runs
        # Without runs on one side, a stratum has neither surplus nor variance.
        if before.of == 0 or now.of == 0 or every < 2:
            continue
        # Mean and variance of the hypergeometric distribution of the stratum's occurrences now.
        surplus += now.runs - now.of * occurred / every
        variance += now.of * before.of * occurred * (every - occurred) / (every**2 * (every - 1))
    if variance <= 0.0:
        return None
    # The correction: the surplus changes in steps of 1, the normal distribution does not. The p is
    # its upper tail, by the complementary error function.
    z = (surplus - 0.5) / math.sqrt(variance)
    return 0.5 * math.erfc(z / math.sqrt(2.0))


def share(part: int, whole: int) -> Interval:
    """Returns a share with the 95 % interval of Wilson (1927), which also holds near 0 and 1.

    Args:
        part: Number of those that count.
        whole: Number of all; 0: the share is 0, and the interval the whole range.
    """
    if not whole:
        return Interval(mean=0.0, low=0.0, high=1.0)
    # All shares p for which the observed one is within z standard errors sqrt(p (1 - p) / n): the
    # ends are the roots of a quadratic equation. By rounding, one may be beyond 0 or 1.
    mean, z2 = part / whole, _Z_95**2
    middle = (mean + z2 / (2.0 * whole)) / (1.0 + z2 / whole)
    half = _Z_95 / (1.0 + z2 / whole) * math.sqrt(mean * (1.0 - mean) / whole + z2 / 4.0 / whole**2)
    # Where none or all count, an end is the share, but for rounding.
    low, high = max(middle - half, 0.0), min(middle + half, 1.0)
    return Interval(mean=mean, low=min(low, mean), high=max(high, mean))


def mean_of_repetitions(values: Sequence[float], *, confidence: float) -> Interval:
    """Returns the mean over the repetitions of a suite with Student's confidence interval.

    A repetition is one observation: the runs of one scenario under several seeds tell nothing on
    how its scenarios were chosen, so that the interval is that of the seeds alone.

    Args:
        values: Of each repetition, at least one.
        confidence: Level of the interval.
    """
    n = len(values)
    mean = math.fsum(values) / n
    if n < 2:
        return Interval(mean=mean)
    from scipy import stats

    # The standard error of the mean: n - 1 for the variance, n for the mean.
    spread = math.sqrt(math.fsum((value - mean) ** 2 for value in values) / (n - 1) / n)
    half = float(stats.t.ppf(0.5 + confidence / 2.0, n - 1)) * spread
    return Interval(mean=mean, low=mean - half, high=mean + half)
