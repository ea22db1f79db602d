from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from drivora_service.oracles.avoidability.braking_evasion import (
    brakes_clear,
    careful_braking,
    instant_braking,
)
from drivora_service.oracles.avoidability.careful_driver import GRAVITY, CarefulDriver
from drivora_service.oracles.avoidability.replayed_contact import Replay
from tests.oracles.avoidability.collisions import (
    LENGTH,
    STEP,
    collision,
    cut,
    moving,
    standing_at,
    steady,
)

DRIVER = CarefulDriver()


def careful(replay: Replay, row: int, friction: float = 1.0) -> bool:
    return brakes_clear(
        replay,
        row,
        delay=DRIVER.delay,
        full=DRIVER.full_braking(friction * GRAVITY, math.inf),
        grip=friction * GRAVITY,
        jerk=DRIVER.jerk,
    )


@pytest.mark.parametrize("friction", [0.4, 0.7, 1.0])
@pytest.mark.parametrize("speed", [5.0, 12.0, 20.0, 30.0])
def test_a_standing_obstacle_is_avoided_from_the_stopping_distance_on(
    speed: float, friction: float
) -> None:
    """The last row that avoids it is that of the closed form, within one row."""
    replay = cut(collision(*standing_at(200.0, speed, seconds=45.0)))
    stopping = DRIVER.stopping_distance(speed, friction * GRAVITY)
    latest = careful_braking(replay, DRIVER, friction * GRAVITY, math.inf)
    room = 200.0 - replay.path[latest, 0] if replay.first == 0 else None
    if room is None:
        room = (replay.contact - latest) * STEP * speed - _beyond(replay, speed)
    assert stopping <= room + 0.05
    assert room - speed * STEP <= stopping + 0.05


def _beyond(replay: Replay, speed: float) -> float:
    """Metres that the boxes overlap in the row of the contact."""
    ego, other = replay.path[replay.contact, 1], replay.others[replay.contact, 0, 0]
    return float(LENGTH - (other - ego))


@pytest.mark.parametrize(("extra", "avoided"), [(0.3, True), (-0.3, False)])
@pytest.mark.parametrize("friction", [0.45, 1.0])
def test_both_sides_of_the_bound(friction: float, extra: float, avoided: bool) -> None:
    speed = 14.0
    distance = DRIVER.stopping_distance(speed, friction * GRAVITY) + extra
    replay = cut(collision(*standing_at(distance, speed)))
    assert careful(replay, 0, friction) is avoided


def test_a_leader_that_brakes_to_a_stop_leaves_room_for_its_own_stopping() -> None:
    """Behind a leader that brakes at 4 m/s² from 15 m/s: it stands 28 m further on."""
    time = np.arange(0.0, 20.0, STEP)
    braking = np.minimum(time, 15.0 / 4.0)
    gap = 20.0
    leader = moving(LENGTH + gap + 15.0 * braking - 2.0 * braking**2, yaw=0.0)
    replay = cut(collision(steady(0.0, 0.0, 15.0), leader))
    needed = DRIVER.stopping_distance(15.0, GRAVITY) - 15.0**2 / 8.0
    assert needed < gap
    # Who begins t seconds later than at once has 15 t metres less.
    spare = (gap - needed) / 15.0
    latest = careful_braking(replay, DRIVER, GRAVITY, math.inf)
    assert latest * STEP == pytest.approx(spare, abs=STEP + 0.02)


def test_it_need_not_stop_for_what_only_crosses() -> None:
    """A vehicle that crosses at 10 m/s has left the path when a braking ego comes there."""
    crossing = steady(40.0, -25.0, 10.0, math.pi / 2)
    replay = cut(collision(steady(0.0, 0.0, 16.0), crossing))
    latest = careful_braking(replay, DRIVER, GRAVITY, math.inf)
    # It could not have stopped before the crossing from there.
    assert replay.path[latest, 0] + DRIVER.stopping_distance(16.0, GRAVITY) > 40.0


def test_what_follows_the_ego_does_not_count() -> None:
    """It was recorded behind an ego that did not brake, and would run into one that does."""
    ego, obstacle = standing_at(60.0, 10.0)
    follower = steady(-8.0, 0.0, 10.0)
    replay = cut(collision(ego, obstacle, follower))
    assert careful(replay, 0)


def test_one_that_hits_the_ego_from_behind_is_not_avoided_by_braking() -> None:
    replay = cut(collision(steady(0.0, 0.0, 5.0), steady(-30.0, 0.0, 15.0)))
    assert careful_braking(replay, DRIVER, GRAVITY, math.inf) == -1


def test_others_in_the_way_count_as_well_as_the_one_hit() -> None:
    """Braking would avoid the first; the second crosses where the ego stops for it."""
    ego, obstacle = standing_at(60.0, 15.0)
    assert careful(cut(collision(ego, obstacle)), 0)
    crossing = steady(38.0, -45.0, 10.0, math.pi / 2)
    assert not careful(cut(collision(ego, obstacle, crossing)), 0)


@settings(max_examples=60, deadline=None)
@given(
    speed=st.floats(3.0, 30.0),
    other=st.floats(0.0, 20.0),
    gap=st.floats(1.0, 60.0),
    slowing=st.floats(0.0, 6.0),
    friction=st.floats(0.35, 1.0),
    rows=st.tuples(st.integers(0, 300), st.integers(0, 300)),
)
def test_earlier_is_never_worse_and_less_grip_never_helps(
    speed: float, other: float, gap: float, slowing: float, friction: float, rows: tuple[int, int]
) -> None:
    """For vehicles ahead on the ego's path."""
    time = np.arange(0.0, 20.0, STEP)
    braking = np.minimum(time, other / slowing if slowing > 0.0 else np.inf)
    ahead = moving(LENGTH + gap + other * braking - 0.5 * slowing * braking**2, yaw=0.0)
    try:
        replay = cut(collision(steady(0.0, 0.0, speed), ahead))
    except AssertionError:
        reject()
    early, late = sorted(min(row, replay.contact - 1) for row in rows)
    if careful(replay, late, friction):
        assert careful(replay, early, friction)
        assert careful(replay, late, min(1.2 * friction, 1.0))
    assert careful_braking(replay, DRIVER, 0.8 * friction * GRAVITY, math.inf) <= careful_braking(
        replay, DRIVER, friction * GRAVITY, math.inf
    )


@settings(max_examples=40, deadline=None)
@given(speed=st.floats(3.0, 30.0), distance=st.floats(5.0, 120.0), friction=st.floats(0.35, 1.0))
def test_no_delay_is_never_worse_than_the_drivers(
    speed: float, distance: float, friction: float
) -> None:
    replay = cut(collision(*standing_at(distance, speed, seconds=45.0)))
    grip = friction * GRAVITY
    assert instant_braking(replay, grip, math.inf, 0) >= careful_braking(
        replay, DRIVER, grip, math.inf
    )
