"""Comfort of an ego's motion."""

from __future__ import annotations

import numpy as np

from drivora_service.observations.run_view import EgoView
from drivora_service.oracles.discomfort import Discomfort

SEGMENT = 20
"""Rows in a segment (Bench2Drive)."""


def comfort(ego: EgoView) -> float | None:
    """Returns the share of 20-row segments in which all six signals keep to their bounds.

    Rows after the last whole segment are ignored; ``None`` without a whole segment.
    """
    segments = ego.count // SEGMENT
    if ego.motion is None or not segments:
        return None
    rough = np.any(list(Discomfort().broken(ego.motion).values()), axis=0)
    whole = rough[: segments * SEGMENT].reshape(segments, SEGMENT)
    return float(1.0 - whole.any(axis=1).mean())
