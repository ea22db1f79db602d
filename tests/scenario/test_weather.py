"""What weather does: clear is free, and every parameter acts in one direction."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.scenario.model import Weather
from drivora_service.scenario.weather import CLEAR_RANGE, WeatherEffects, weather_effects

percentages = st.floats(0, 100)
weathers = st.builds(
    Weather,
    cloudiness=percentages,
    precipitation=percentages,
    precipitation_deposits=percentages,
    wind_intensity=percentages,
    sun_altitude_angle=st.floats(-90, 90),
    fog_density=percentages,
    fog_distance=st.floats(0, 500),
    wetness=percentages,
)


def test_clear_weather_costs_nothing() -> None:
    effects = weather_effects(Weather())
    assert effects.friction == 1.0
    assert effects.perception_range == CLEAR_RANGE == 150.0
    assert effects.position_noise == effects.speed_noise == effects.dropout == 0.0
    assert effects.wind_acceleration == 0.0


def harm(effects: WeatherEffects) -> tuple[float, ...]:
    """The effects, each so that more is worse."""
    return (
        -effects.friction,
        -effects.perception_range,
        effects.position_noise,
        effects.speed_noise,
        effects.dropout,
        effects.wind_acceleration,
    )


@pytest.mark.parametrize(
    "name", ["precipitation", "precipitation_deposits", "wind_intensity", "fog_density", "wetness"]
)
@given(weather=weathers, value=percentages)
def test_more_of_it_is_never_better(name: str, weather: Weather, value: float) -> None:
    mild, harsh = sorted((getattr(weather, name), value))
    better = harm(weather_effects(replace(weather, **{name: mild})))
    worse = harm(weather_effects(replace(weather, **{name: harsh})))
    assert all(b <= w + 1e-12 for b, w in zip(better, worse, strict=True))


@given(weather=weathers, altitude=st.floats(-90, 90), distance=st.floats(0, 500))
def test_higher_sun_and_later_fog_are_never_worse(
    weather: Weather, altitude: float, distance: float
) -> None:
    for name, value in (("sun_altitude_angle", altitude), ("fog_distance", distance)):
        low, high = sorted((getattr(weather, name), value))
        worse = harm(weather_effects(replace(weather, **{name: low})))
        better = harm(weather_effects(replace(weather, **{name: high})))
        assert all(b <= w + 1e-12 for b, w in zip(better, worse, strict=True))


@given(weathers)
def test_effects_stay_in_their_bounds(weather: Weather) -> None:
    effects = weather_effects(weather)
    assert 0.4 - 1e-12 <= effects.friction <= 1.0
    assert 15.0 <= effects.perception_range <= CLEAR_RANGE
    assert 0.0 <= effects.dropout < 0.2
    assert 0.0 <= effects.wind_acceleration <= 1.3


@pytest.mark.parametrize(
    ("weather", "friction", "reach"),
    [
        (Weather(wetness=100), 0.7, 150.0),
        (Weather(precipitation_deposits=100), 0.4, 150.0),
        (Weather(fog_density=100), 1.0, 50.0),
        (Weather(fog_density=100, fog_distance=60), 1.0, 110.0),
        (Weather(sun_altitude_angle=0), 1.0, 120.0),
        (Weather(sun_altitude_angle=-6), 1.0, 75.0),
        (Weather(sun_altitude_angle=-90), 1.0, 75.0),
        (Weather(precipitation=100), 0.7, 105.0),
    ],
)
def test_documented_figures(weather: Weather, friction: float, reach: float) -> None:
    effects = weather_effects(weather)
    assert effects.friction == pytest.approx(friction)
    assert effects.perception_range == pytest.approx(reach)
