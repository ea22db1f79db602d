from __future__ import annotations

import math

import pytest

from drivora_service.oracles.avoidability.careful_driver import GRAVITY
from drivora_service.oracles.avoidability.evasion import find_evasion
from drivora_service.testing.traces import Motion
from tests.oracles.avoidability.collisions import (
    LENGTH,
    ROAD,
    collision,
    cut,
    standing_at,
    steady,
)


def steers(*motions: Motion, friction: float = 1.0, row: int = 0) -> bool:
    found = find_evasion(
        cut(collision(*motions)),
        ROAD,
        row,
        grip=friction * GRAVITY,
        brakes=math.inf,
        wheelbase=2.7,
        max_steer=0.6,
    )
    return found is not None


def needed(speed: float, friction: float) -> float:
    """Metres at a constant speed until the front's corner is 1.8 m aside, all grip spent on that.

    The centre moves a t²/2 aside, and the front swings out by half the length times a t / v.
    """
    side = friction * GRAVITY
    swing = 0.5 * LENGTH * side / speed
    time = (math.sqrt(swing**2 + 2.0 * side * 1.8) - swing) / side
    return speed * time


@pytest.mark.parametrize("friction", [0.5, 1.0])
def test_it_passes_what_it_can_no_longer_brake_for(friction: float) -> None:
    speed = 25.0
    stopping = speed**2 / (2.0 * friction * GRAVITY)
    distance = needed(speed, friction) + 10.0
    assert distance < stopping - 3.0
    assert steers(*standing_at(distance, speed), friction=friction)


@pytest.mark.parametrize("friction", [0.5, 1.0])
def test_it_cannot_move_aside_faster_than_the_grip_allows(friction: float) -> None:
    """Closer than it would take if the wheels were turned at once."""
    speed = 25.0
    assert not steers(*standing_at(needed(speed, friction) - 2.0, speed), friction=friction)


def test_it_stays_on_the_road() -> None:
    """Two vehicles side by side and one on each further lane: there is no way past."""
    speed, distance = 25.0, LENGTH + 30.0
    beside = [steady(distance, y) for y in (3.5, 7.0)]
    assert not steers(steady(0.0, 0.0, speed), steady(distance, 0.0), *beside)
    # Without the one on the lane beside, there is.
    assert steers(steady(0.0, 0.0, speed), steady(distance, 0.0), beside[1])


def test_others_beside_are_not_run_into() -> None:
    """A vehicle drives beside the ego all along, where it would have to go."""
    speed, distance = 25.0, 30.0
    ego, obstacle = standing_at(distance, speed)
    walls = [steady(float(x), y, speed) for y in (3.5, 7.0) for x in range(-10, 12, 5)]
    assert steers(ego, obstacle)
    assert not steers(ego, obstacle, *walls)
