"""Weather and time of day as an adversary sets them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from drivora_service.runs.adversary import Action
from drivora_service.scenario.model import Weather

SKIES: Mapping[Action, Mapping[str, float]] = {
    Action.CLEAR_SKY: {
        "cloudiness": 0.0,
        "precipitation": 0.0,
        "precipitation_deposits": 0.0,
        "wetness": 0.0,
        "fog_density": 0.0,
    },
    Action.LIGHT_RAIN: {"cloudiness": 60.0, "precipitation": 30.0, "wetness": 40.0},
    Action.HEAVY_RAIN: {"cloudiness": 100.0, "precipitation": 100.0, "wetness": 100.0},
    Action.FOG: {"fog_density": 80.0},
    Action.NOON: {"sun_altitude_angle": 70.0},
    Action.DUSK: {"sun_altitude_angle": 3.0},
    Action.NIGHT: {"sun_altitude_angle": -10.0},
}
"""The conditions that an action sets, as fields of ``Weather``; the others stay."""


def sky(action: Action, weather: Weather) -> Weather:
    """Returns the weather after an action."""
    return replace(weather, **SKIES[action])
