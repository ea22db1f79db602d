"""Braking for traffic lights for policies without lights."""

from __future__ import annotations

import math
from functools import lru_cache

from drivora_service.agents.idm.car_following import halt
from drivora_service.agents.interface import Observation
from drivora_service.observations.trace import Light

_LINE_GAP = 0.5
"""Metres between the front bumper and the stop line at standstill."""
_CALM_BRAKING = 3.0
"""m/s²; a yellow light that would need more is passed."""
_HARDEST_BRAKING = 7.5
"""m/s²; a red light that would need more, or one whose line is passed, is too late to stop for."""


def light_acceleration(observation: Observation, max_braking: float) -> float:
    """Returns the maximum acceleration that the next light on the route allows, m/s².

    Args:
        observation: Observation of this step.
        max_braking: m/s², positive.

    Returns:
        inf if the light does not require braking.
    """
    light, distance, speed = observation.light, observation.light_distance, observation.speed
    if light not in (Light.RED, Light.YELLOW) or distance <= -_LINE_GAP:
        return math.inf
    needed = speed * speed / (2.0 * max(distance, 0.1))
    if needed >= (_CALM_BRAKING if light is Light.YELLOW else _HARDEST_BRAKING):
        return math.inf
    wanted = max(observation.speed_limit, 1.0)
    return float(halt(speed, wanted, max(distance - _LINE_GAP, 0.0), max_braking))


@lru_cache(maxsize=1)
def compile_braking() -> None:
    """Compiles the braking, which would otherwise happen at an agent's first red light."""
    halt(1.0, 1.0, 1.0, 1.0)
