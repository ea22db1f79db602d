"""The least distance between two egos."""

from __future__ import annotations

import math

import numpy as np

from drivora_service.observations.proximity import gaps_between
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import LEVEL_GAP, Col


def least_ego_distance(run: RunView) -> float | None:
    """Returns the least gap between the boxes of any two egos in metres, 0 if they touch.

    Counts while at least one of the two is driving: an ego that waits for its start, or stands at
    its end, is an obstacle for the other. Egos on different levels of a bridge are not near.

    Returns:
        ``None`` if no two egos were on the road together.
    """
    trace, count = run.trace, run.trace.ego_count
    one, other = np.triu_indices(count, k=1)
    driving = np.zeros((trace.step_count, count), dtype=np.bool_)
    for ego in run.egos:
        driving[ego.first : ego.first + ego.count, ego.row] = True
    states, present = trace.states[:, :count], trace.present[:, :count]
    climb = np.abs(states[:, one, Col.Z] - states[:, other, Col.Z])
    together = present[:, one] & present[:, other] & (driving[:, one] | driving[:, other])
    together &= climb <= LEVEL_GAP
    offsets = states[:, one, : Col.YAW] - states[:, other, : Col.YAW]
    between = np.where(together, np.hypot(offsets[..., 0], offsets[..., 1]), np.inf)
    half = np.array([0.5 * math.hypot(ego.actor.length, ego.actor.width) for ego in run.egos])
    at_least = between.min(axis=0, initial=np.inf) - half[one] - half[other]
    least = math.inf
    for pair in np.argsort(at_least, kind="stable"):
        if at_least[pair] >= least:
            break
        gaps = gaps_between(trace, int(one[pair]), int(other[pair]))
        least = min(least, float(gaps[together[:, pair]].min()))
    return None if math.isinf(least) else least
