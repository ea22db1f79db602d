"""Which lights an adapter has to stop for."""

from __future__ import annotations

from drivora_service.agents.interface import Observation
from drivora_service.observations.trace import Light

_PLANNED_BRAKING = 4.0
"""m/s²: a yellow light is passed if stopping would need more."""


def must_stop(observation: Observation) -> bool:
    """Tells whether the next signal has to be obeyed: red, or yellow with room to stop."""
    halting = observation.speed**2 / (2.0 * _PLANNED_BRAKING)
    return observation.light is Light.RED or (
        observation.light is Light.YELLOW and halting < observation.light_distance
    )
