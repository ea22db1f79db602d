"""Comfort of an ego's motion."""

from __future__ import annotations

import numpy as np

from drivora_service.observations.run_view import EgoView
from drivora_service.oracles.discomfort import Discomfort

SEGMENT = 20
"""Rows in a segment (Bench2Drive)."""


def comfort(ego: EgoView) -> float | None:
    """Returns the share of 20-row segments in which all six signals keep to their bounds.

    Rows after the last whole segment are ignored; a drive shorter than a segment is one. ``None``
    if it is too short for the filters.
    """
    if ego.motion is None:
        return None
    rough = np.any(list(Discomfort().find_exceeded_bounds(ego.motion).values()), axis=0)
    length = min(SEGMENT, len(rough))
    segments = len(rough) // length
    whole = rough[: segments * length].reshape(segments, length)
    return float(1.0 - whole.any(axis=1).mean())
