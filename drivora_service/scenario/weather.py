"""Effects of the weather: grip, range and quality of perception, and force of the wind.

Every effect is a monotone function of each of CARLA's parameters. Sources and choices:

- **Friction.** Measured coefficients are 0.8 to 1.0 on dry asphalt, about 0.7 on wet asphalt, and
  0.4 and less with aquaplaning (Wallman and Åström, *Friction measurement
  methods and the correlation between road friction and traffic safety*, VTI 2001; Wong, *Theory of
  Ground Vehicles*, chapter 1). Rain, wetness or deposits of 100 take 1.0 down to 0.7; deposits of
  100 take it further down to 0.4.
- **Fog.** The density is the logarithm of the meteorological visibility (Koschmieder): 10 km at 0,
  1 km (where fog begins by the WMO's definition) at 43, 50 m (dense fog) at 100. Objects are
  perceived up to the begin of the fog plus that visibility.
- **Rain, low sun, night.** Heavy rain takes 30 % of the range; glare of a sun on the horizon 20 %;
  the night, from the end of civil twilight (6 degrees below the horizon) on, 50 %. Orders of
  magnitude chosen here.
- **Noise, drop-out and latency** grow in proportion to the share of the range that is lost: objects
  that are hard to see are detected later, too. Chosen here.
- **Wind.** 100 is 20 m/s (Beaufort 8 to 9). Drag on the side of a car (8 m², coefficient 1, 1.2
  kg/m³, 1500 kg) gives 1.3 m/s² and grows with the square of the wind speed. CARLA's wind has no
  direction: here it blows towards the north-east, so that it affects roads of both axes. The tyres
  balance it (``simulation.motion.vehicle_dynamics``).

Cloudiness, the sun's azimuth and the fog's falloff with height have no effect.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from drivora_service.scenario.model import Weather

CLEAR_RANGE = 150.0
"""Metres that agents perceive in clear weather."""
WIND_DIRECTION = math.pi / 4
_WET_LOSS = 0.3
_DEPOSITS_LOSS = 0.3
_CLEAR_VISIBILITY = 10_000.0
_DENSEST_VISIBILITY = 50.0
_RAIN_LOSS = 0.3
_GLARE_LOSS = 0.2
_NIGHT_LOSS = 0.5
_LOW_SUN = 15.0
_TWILIGHT_END = -6.0
_POSITION_NOISE = 0.5
_SPEED_NOISE = 0.8
_DROPOUT = 0.2
_LATENCY = 0.3
_WIND_ACCELERATION = 1.3


@dataclass(frozen=True, slots=True, kw_only=True)
class WeatherEffects:
    """Physical effects of a weather.

    Attributes:
        friction: Tyre-road friction coefficient, 0.4 to 1.
        perception_range: Metres within which agents perceive others.
        position_noise: Standard deviation of perceived positions, metres.
        speed_noise: Standard deviation of perceived speeds, m/s.
        dropout: Probability that an object is not perceived at a step.
        latency: Latency of the perception, seconds.
        wind_acceleration: Force of the wind by the mass of a vehicle, m/s².
        wind_direction: Where the wind blows to, radians counter-clockwise from east.
    """

    friction: float
    perception_range: float
    position_noise: float
    speed_noise: float
    dropout: float
    latency: float
    wind_acceleration: float
    wind_direction: float


def weather_effects(weather: Weather) -> WeatherEffects:
    """Returns the effects of a weather; clear weather has no noise, drop-out, latency or wind."""
    perception_range = _perception_range(weather)
    lost = 1.0 - perception_range / CLEAR_RANGE
    return WeatherEffects(
        friction=_friction(weather),
        perception_range=perception_range,
        position_noise=_POSITION_NOISE * lost,
        speed_noise=_SPEED_NOISE * lost,
        dropout=_DROPOUT * lost,
        latency=_LATENCY * lost,
        wind_acceleration=_WIND_ACCELERATION * (weather.wind_intensity / 100.0) ** 2,
        wind_direction=WIND_DIRECTION,
    )


def _friction(weather: Weather) -> float:
    wet = max(weather.wetness, weather.precipitation, weather.precipitation_deposits) / 100.0
    return 1.0 - _WET_LOSS * wet - _DEPOSITS_LOSS * weather.precipitation_deposits / 100.0


def _perception_range(weather: Weather) -> float:
    thickness = weather.fog_density / 100.0
    visibility = _CLEAR_VISIBILITY * math.pow(_DENSEST_VISIBILITY / _CLEAR_VISIBILITY, thickness)
    reach = min(CLEAR_RANGE, weather.fog_distance + visibility)
    rain = 1.0 - _RAIN_LOSS * weather.precipitation / 100.0
    return reach * rain * _light(weather.sun_altitude_angle)


def _light(sun_altitude: float) -> float:
    """Returns the share of the range that is left at a height of the sun in degrees."""
    if sun_altitude >= _LOW_SUN:
        return 1.0
    if sun_altitude >= 0.0:
        return 1.0 - _GLARE_LOSS * (_LOW_SUN - sun_altitude) / _LOW_SUN
    night = min(sun_altitude / _TWILIGHT_END, 1.0)
    return 1.0 - _GLARE_LOSS - (_NIGHT_LOSS - _GLARE_LOSS) * night
