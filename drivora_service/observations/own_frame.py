"""Motion of a vehicle in its own frame: x forwards, y to the left."""

from __future__ import annotations

from drivora_service.geometry import elementary
from drivora_service.geometry.array_shapes import FloatArray
from drivora_service.observations.trace import Col


def own_acceleration(states: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Returns the (n,) accelerations forwards and to the left, m/s².

    Args:
        states: (n, 9) columns ``Col``.
    """
    cos, sin = elementary.cos(states[:, Col.YAW]), elementary.sin(states[:, Col.YAW])
    ax, ay = states[:, Col.AX], states[:, Col.AY]
    return ax * cos + ay * sin, ay * cos - ax * sin
