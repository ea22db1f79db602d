"""Braking for lights on behalf of policies that know none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivora_service.agents.interface import Observation
from drivora_service.agents.light_braking import light_acceleration
from drivora_service.observations.trace import Light


def at(light: Light, distance: float, speed: float) -> Observation:
    return Observation(
        ego=np.zeros(9), speed=speed, objects=np.zeros((0, 9)), object_sizes=np.zeros((0, 2)),
        object_kinds=np.zeros(0, dtype=np.int64), object_ids=np.zeros(0, dtype=np.int64),
        light=light, light_distance=distance, speed_limit=13.9,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("light", "distance", "speed"),
    [
        (Light.GREEN, 20.0, 10.0),
        (Light.NONE, math.inf, 10.0),
        (Light.YELLOW, 10.0, 10.0),
        (Light.RED, 3.0, 12.0),
        (Light.RED, -1.0, 5.0),
    ],
)
def test_what_asks_for_nothing_or_is_too_late(light: Light, distance: float, speed: float) -> None:
    assert light_acceleration(at(light, distance, speed), 8.0) == math.inf


@given(st.sampled_from([Light.RED, Light.YELLOW]), st.floats(20.0, 100.0), st.floats(0.0, 10.0))
def test_it_stands_before_the_line(light: Light, distance: float, speed: float) -> None:
    dt = 0.05
    for _ in range(2000):
        acceleration = min(light_acceleration(at(light, distance, speed), 8.0), 2.0)
        speed = max(speed + acceleration * dt, 0.0)
        distance -= speed * dt
    assert speed < 0.05
    assert 0.0 < distance < 3.0
