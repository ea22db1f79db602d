from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.oracles.avoidability.careful_driver import GRAVITY, CarefulDriver

DRIVER = CarefulDriver()
DRY = GRAVITY


def test_its_figures_are_those_of_the_regulation() -> None:
    assert DRIVER.evaluation_time == 0.4
    assert DRIVER.braking_delay == 0.75
    assert DRIVER.delay == pytest.approx(1.15)
    assert DRIVER.jerking_time == 0.6
    assert DRIVER.deceleration == pytest.approx(7.593, abs=0.001)
    assert DRIVER.jerk == pytest.approx(12.65, abs=0.01)
    assert DRIVER.wander == 0.375
    assert DRIVER.leader_braking == 5.0


def test_it_stops_from_60_kmh_within_what_its_figures_add_up_to() -> None:
    # 1.15 s at 16.667 m/s; 0.6 s losing 2.278 m/s; then 14.389 m/s at 7.593 m/s².
    by_hand = 1.15 * 16.6667 + (0.6 * 16.6667 - 12.6549 * 0.6**3 / 6) + 14.3888**2 / (2 * 7.5929)
    assert DRIVER.stopping_distance(60 / 3.6, DRY) == pytest.approx(by_hand, abs=0.01)
    assert DRIVER.stopping_distance(60 / 3.6, DRY) == pytest.approx(42.35, abs=0.1)


@pytest.mark.parametrize("friction", [0.4, 0.7, 1.0])
@pytest.mark.parametrize("speed", [1.0, 5.0, 15.0, 30.0])
def test_its_stopping_distance_is_that_of_small_steps(speed: float, friction: float) -> None:
    grip = friction * GRAVITY
    full = DRIVER.full_braking(grip, math.inf)
    distance, left, time, step = 0.0, speed, 0.0, 1e-4
    while left > 0.0:
        braking = min(max(DRIVER.jerk * (time - DRIVER.delay), 0.0), full)
        distance += left * step
        left -= braking * step
        time += step
    assert DRIVER.stopping_distance(speed, grip) == pytest.approx(distance, abs=0.01)


@given(
    speed=st.floats(0.5, 40.0),
    friction=st.floats(0.3, 1.0),
    less=st.floats(0.05, 1.0),
    brakes=st.floats(2.0, 12.0),
)
def test_less_grip_or_weaker_brakes_never_stop_it_sooner(
    speed: float, friction: float, less: float, brakes: float
) -> None:
    there = DRIVER.stopping_distance(speed, friction * GRAVITY, brakes)
    assert DRIVER.stopping_distance(speed, less * friction * GRAVITY, brakes) >= there - 1e-9
    assert DRIVER.stopping_distance(speed, friction * GRAVITY, less * brakes) >= there - 1e-9
