"""Which lights an adapter has to stop for, and how slow that makes it."""

from __future__ import annotations

import math

from drivora_service.agents.interface import Observation
from drivora_service.observations.trace import Light

_PLANNED_BRAKING = 4.0
"""m/s²: a yellow light is passed if stopping would need more."""

_CALM_BRAKING, _HARDEST_BRAKING = 2.5, 7.5
"""m/s²: before a light, and more than which is not tried: it is too late then."""

_LINE_GAP = 0.5
"""Metres that stay between the front bumper and the stop line."""


def must_stop(observation: Observation) -> bool:
    """Returns whether the next signal has to be obeyed: red, or yellow with room to stop."""
    halting = observation.speed**2 / (2.0 * _PLANNED_BRAKING)
    return observation.light is Light.RED or (
        observation.light is Light.YELLOW and halting < observation.light_distance
    )


def light_speed(observation: Observation) -> float:
    """Returns the speed with which calm braking can still stop before the next light, m/s.

    For adapters of policies that know no lights.

    Returns:
        inf where the light asks for nothing.
    """
    if not must_stop(observation):
        return math.inf
    room = observation.light_distance - _LINE_GAP
    if observation.speed**2 > 2.0 * _HARDEST_BRAKING * max(room, 0.1):
        return math.inf
    return math.sqrt(2.0 * _CALM_BRAKING * max(room, 0.0))
