"""Lights at which an adapter must stop, and the resulting speed."""

from __future__ import annotations

import math

from drivora_service.agents.interface import Observation
from drivora_service.observations.trace import Light

_PLANNED_BRAKING = 4.0
"""m/s²: a yellow light is passed if stopping would need more."""

_CALM_BRAKING, _HARDEST_BRAKING = 2.5, 7.5
"""m/s²: braking before a light; if more is needed, it is too late to stop."""

_LINE_GAP = 0.5
"""Metres between the front bumper and the stop line at standstill."""


def must_stop(observation: Observation) -> bool:
    """Returns whether the next signal has to be obeyed: red, or yellow with room to stop."""
    halting = observation.speed**2 / (2.0 * _PLANNED_BRAKING)
    return observation.light is Light.RED or (
        observation.light is Light.YELLOW and halting < observation.light_distance
    )


def light_speed(observation: Observation) -> float:
    """Returns the speed with which calm braking can still stop before the next light, m/s.

    For adapters of policies without lights.

    Returns:
        inf if the light does not require braking.
    """
    if not must_stop(observation):
        return math.inf
    room = observation.light_distance - _LINE_GAP
    if observation.speed**2 > 2.0 * _HARDEST_BRAKING * max(room, 0.1):
        return math.inf
    return math.sqrt(2.0 * _CALM_BRAKING * max(room, 0.0))
