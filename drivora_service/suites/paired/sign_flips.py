"""A test of paired differences by flipping their signs.

If A and B do not differ, a scenario's difference is as likely to have either sign, whatever its
size. The p-value is the share of random flips whose mean is at least as far from zero as the
observed one (Fisher's randomization test). It is honest for few scenarios and many ties, where the
bootstrap's intervals are too narrow: with fewer than six differences that are not zero, p cannot be
below 0.05.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FLIPS = 5_000
SEED = 2
"""The same data gives the same p-values."""
_VALUES_AT_ONCE = 4_000_000
"""Signs in memory at once."""
_ROUNDING = 1e-9


def flip_p_values(
    differences: NDArray[np.float64], *, flips: int = FLIPS, seed: int = SEED
) -> tuple[float, ...]:
    """Returns the two-sided p of each column; 1 where all differences are zero or missing.

    Args:
        differences: A row for each scenario, a column for each metric; NaN: not measurable.
        flips: Number of random flips, which all columns share.
        seed: Seeds the flips.
    """
    known = np.nan_to_num(differences, nan=0.0, posinf=0.0, neginf=0.0)
    n = len(known)
    # The flip without any change counts as well: p is never 0.
    reached = np.ones(known.shape[1])
    least = np.abs(known.sum(axis=0)) - _ROUNDING * np.abs(known).sum(axis=0)
    rng = np.random.default_rng(seed)
    at_once = max(1, _VALUES_AT_ONCE // max(n, 1))
    for start in range(0, flips, at_once):
        samples = min(at_once, flips - start)
        signs = rng.integers(0, 2, size=(samples, n), dtype=np.int8) * 2.0 - 1.0
        reached += (np.abs(signs @ known) >= least).sum(axis=0)
    return tuple(float(p) for p in reached / (flips + 1))
