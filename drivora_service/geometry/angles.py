"""Angles in radians."""

from __future__ import annotations

import math


def wrap_angle(angle: float) -> float:
    """Returns the same direction as an angle in [-pi, pi)."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
