"""Route completion of an ego."""

from __future__ import annotations

import numpy as np

from drivora_service.metrics.judgement import Judgement
from drivora_service.observations.run_view import EgoView
from drivora_service.observations.trace import EgoCol
from drivora_service.oracles.verdict import Outcome


def route_completion(ego: EgoView, judgement: Judgement) -> float | None:
    """Returns per cent of the route (Leaderboard): 100 on arrival, 0 for an ego that never started.

    The first deviation from the route ends the completion. ``None`` if an artefact of the simulator
    kept the ego from arriving: how far it would have come is not known.
    """
    if not ego.count:
        return 0.0
    arrival = judgement.by("destination")
    if arrival and arrival[0].outcome is Outcome.PASSED:
        return 100.0
    if ego.artefact is not None:
        return None
    last = ego.count
    for deviation in judgement.violations("route_deviation") or ():
        if deviation.step is not None:
            last = min(last, deviation.step - ego.first + 1)
    done = ego.value(EgoCol.ROUTE_S)[:last] / ego.route.length
    if not np.isfinite(done).any():
        return None
    return 100.0 * float(np.clip(np.nanmax(done), 0.0, 1.0))
