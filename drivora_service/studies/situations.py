"""Counting the situations of violations, also where these fill a scenario evenly.

Chains of neighbours (``campaigns.grouping``) merge as more violations are found, and thousands of
violations of one oracle can become one group. Here a situation extends no farther than a radius
around its central violation: more violations never make fewer situations.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from drivora_service.campaigns.grouping import scale, situation_features
from drivora_service.geometry.arrays import FloatArray
from drivora_service.oracles.verdict import Verdict

RADIUS = 0.15
"""The distance of neighbours in a group: see ``campaigns.grouping``."""


def count_situations(samples: Sequence[Sequence[Verdict]]) -> tuple[int, ...]:
    """Returns the number of situations in each of several samples of violations.

    All violations are taken together, as their least and greatest values are the scale. Those of
    one oracle are processed in the order of their features: one that is farther than the radius
    from every situation so far starts the next. Each then belongs to the nearest situation.

    Args:
        samples: Violations, campaign by campaign.

    Returns:
        One number a sample.
    """
    by_oracle: dict[str, list[tuple[int, Verdict]]] = defaultdict(list)
    for index, sample in enumerate(samples):
        for verdict in sample:
            by_oracle[verdict.oracle].append((index, verdict))
    counts = np.zeros(len(samples), dtype=np.int64)
    for found in by_oracle.values():
        features = situation_features([verdict for _, verdict in found])
        situations = nearest_centres(scale(features) / math.sqrt(max(features.shape[1], 1)))
        pairs = {(index, place) for (index, _), place in zip(found, situations, strict=True)}
        counts += np.bincount([index for index, _ in pairs], minlength=len(samples))
    return tuple(counts.tolist())


def nearest_centres(points: FloatArray) -> tuple[int, ...]:
    """Returns for each of (n, d) points the number of its centre; n >= 1.

    Centres are points; no two of them are nearer than the radius, and no point is farther from one.
    """
    # In an order of their own: the result must not depend on the order of the campaigns.
    ordered = np.unique(points, axis=0)
    centres: list[FloatArray] = []
    left = np.full(len(ordered), math.inf)
    for k, point in enumerate(ordered):
        if left[k] > RADIUS:
            centres.append(point)
            left = np.minimum(left, np.linalg.norm(ordered - point, axis=1))
    away = np.linalg.norm(points[:, None] - np.array(centres)[None], axis=2)
    return tuple(np.argmin(away, axis=1).tolist())
