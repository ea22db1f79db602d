"""The intelligent driver model: accelerations behind a leader and before a line, compiled.

In m, m/s and m/s².
"""

from __future__ import annotations

import math

from drivora_service.compilation import compiled

MAX_ACCELERATION = 1.8
COMFORTABLE_BRAKING = 2.5
TIME_HEADWAY = 1.3
STANDSTILL_GAP = 2.0


@compiled
def follow(v: float, wanted: float, gap: float, other: float, max_braking: float) -> float:
    """Returns the acceleration of the intelligent driver model (Treiber et al., 2000)."""
    closing = v * (v - other) / (2.0 * math.sqrt(MAX_ACCELERATION * COMFORTABLE_BRAKING))
    space = STANDSTILL_GAP + max(0.0, v * TIME_HEADWAY + closing)
    free = (v / max(wanted, 0.1)) ** 4
    a = MAX_ACCELERATION * (1.0 - free - (space / max(gap, 0.1)) ** 2)
    return max(a, -max_braking)


@compiled
def halt(v: float, wanted: float, distance: float, max_braking: float) -> float:
    """Returns the acceleration that stops the front bumper at a line ``distance`` metres ahead."""
    if distance < 0.3:
        return -max_braking if v > 0.2 else -1.0
    needed = v * v / (2.0 * distance)
    approach = follow(v, wanted, distance + STANDSTILL_GAP - 0.8, 0.0, max_braking)
    return max(min(approach, MAX_ACCELERATION), -max(needed * 1.3, 2.0))
