"""Speed profiles that are feasible with limited braking."""

from __future__ import annotations

import math

from drivora_service.compilation import compiled
from drivora_service.geometry.arrays import FloatArray


@compiled
def slow_down_in_time(wanted: FloatArray, arc: FloatArray, deceleration: float) -> None:
    """Lowers desired speeds (n,) in place, so that braking at ``deceleration`` suffices."""
    for i in range(wanted.shape[0] - 2, -1, -1):
        reach = math.sqrt(wanted[i + 1] ** 2 + 2.0 * deceleration * (arc[i + 1] - arc[i]))
        wanted[i] = min(wanted[i], reach)
