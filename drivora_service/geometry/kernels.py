"""Angles in compiled code."""

from __future__ import annotations

import math

from drivora_service.compilation import compiled


@compiled
def wrap_to_pi(angle: float) -> float:
    """Returns the same direction as an angle in [-pi, pi); ``angles.wrap_angle`` for kernels."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
