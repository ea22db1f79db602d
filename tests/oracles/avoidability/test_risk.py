from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.observations.trace import Role, Trace
from drivora_service.oracles.avoidability.careful_driver import GRAVITY, CarefulDriver
from drivora_service.oracles.avoidability.replayed_contact import cut_out
from drivora_service.oracles.avoidability.risk import Perceived, Risk, perceive_risk
from drivora_service.testing.traces import Motion, SyntheticActor
from tests.oracles.avoidability.collisions import (
    LENGTH,
    STEP,
    WIDTH,
    collision,
    moving,
    standing_at,
    steady,
    view,
)

DRIVER = CarefulDriver()
TIME = np.arange(0.0, 20.0, STEP)


HEIGHTS = {"van": 2.5, "walker": 1.7}


def perceived(trace: Trace, friction: float = 1.0, sight: float = math.inf) -> Perceived:
    (contact,) = trace.contacts
    replay = cut_out(view(trace), contact.step, contact.other)
    return perceive_risk(
        replay,
        trace,
        0,
        DRIVER,
        grip=friction * GRAVITY,
        heights=np.array([HEIGHTS.get(actor.id, 1.5) for actor in trace.actors]),
        sight=sight,
    )


def before(trace: Trace, **more: float) -> float:
    """Seconds before the contact at which the risk showed."""
    (contact,) = trace.contacts
    return (contact.step - perceived(trace, **more).row) * STEP


def walker(motion: Motion) -> SyntheticActor:
    return SyntheticActor(motion=motion, id="walker", role=Role.NPC_WALKER, length=0.5, width=0.5)


def test_what_stands_in_the_way_is_a_risk_four_seconds_before() -> None:
    trace = collision(*standing_at(150.0, 15.0))
    assert perceived(trace).risk is Risk.MEETING
    assert before(trace) == pytest.approx(4.0, abs=0.15)


def test_where_stopping_takes_long_it_looks_further_ahead() -> None:
    """At 30 m/s with little grip: 1.5 times the time that stopping takes as a distance."""
    trace = collision(*standing_at(300.0, 30.0))
    full = 0.4 * GRAVITY
    needed = 1.15 + 0.5 * full / DRIVER.jerk + 30.0 / (2.0 * full)
    assert before(trace, friction=0.4) == pytest.approx(1.5 * needed, abs=0.2)
    assert 30.0 * before(trace, friction=0.4) > DRIVER.stopping_distance(30.0, full)


def test_a_vehicle_beside_cuts_in_once_it_has_moved_further_than_a_wander() -> None:
    """It is 3.5 m beside, drives 3 m/s slower, and begins to come over at 6 s with 1 m/s."""
    across = 3.5 - np.clip(TIME - 6.0, 0.0, 3.5)
    # At 8.6 s it is 0.9 m beside, where the boxes overlap across, and the ego reaches it.
    trace = collision(steady(0.0, 0.0, 15.0), moving(LENGTH + 26.0 + 12.0 * TIME, across, yaw=0.0))
    found = perceived(trace)
    assert found.row * STEP == pytest.approx(6.0 + DRIVER.wander, abs=STEP + 1e-9)
    assert found.risk is Risk.CUTTING_IN


def test_a_leader_is_a_risk_once_it_brakes_harder_than_the_regulation_says() -> None:
    """1 s behind at the same speed; it brakes at 7 m/s² from 5 s on."""
    braking = np.clip(TIME - 5.0, 0.0, 15.0 / 7.0)
    leader = moving(
        LENGTH + 15.0 + 15.0 * np.minimum(TIME, 5.0 + 15.0 / 7.0) - 3.5 * braking**2, yaw=0.0
    )
    trace = collision(steady(0.0, 0.0, 15.0), leader)
    found = perceived(trace)
    assert found.risk is Risk.LEADER_BRAKING
    assert found.row * STEP == pytest.approx(5.0, abs=0.2 + 1e-9)


def test_a_walker_is_a_risk_once_it_walks_into_the_way() -> None:
    """It stands beside the road for 6 s, then walks at 1.5 m/s and is hit after 2 s."""
    across = -4.0 + 1.5 * np.clip(TIME - 6.0, 0.0, None)
    trace = collision(
        steady(0.0, 0.0, 10.0), walker(moving(np.full_like(TIME, 83.0), across, yaw=math.pi / 2))
    )
    found = perceived(trace)
    assert found.risk is Risk.MEETING
    assert found.row * STEP == pytest.approx(6.0, abs=0.1 + 1e-9)


def test_what_a_van_hides_is_no_risk_before_it_can_be_seen() -> None:
    across = -6.0 + 1.5 * TIME
    crossing = walker(moving(np.full_like(TIME, 42.0), across, yaw=math.pi / 2))
    van = SyntheticActor(motion=steady(36.0, -2.6), id="van", length=6.0, width=WIDTH)
    open_road = collision(steady(0.0, 0.0, 10.0), crossing)
    hidden = collision(steady(0.0, 0.0, 10.0), crossing, van)
    assert before(hidden) < before(open_road) - 0.5
    assert perceived(hidden).hidden
    assert not perceived(open_road).hidden


def test_what_is_further_than_can_be_seen_is_no_risk() -> None:
    trace = collision(*standing_at(150.0, 15.0))
    assert 15.0 * before(trace, sight=30.0) == pytest.approx(30.0 - LENGTH, abs=1.0)


def test_a_vehicle_that_crosses_is_a_risk_once_it_is_about_to_meet_the_ego() -> None:
    crossing = steady(80.0, -80.0, 10.0, math.pi / 2)
    trace = collision(steady(0.0, 0.0, 10.0), crossing)
    assert perceived(trace).risk is Risk.MEETING
    assert before(trace) == pytest.approx(4.0, abs=0.15)


def test_an_actor_that_appears_in_the_way_was_no_risk_before() -> None:
    there = TIME > 5.0
    trace = collision(
        steady(0.0, 0.0, 10.0), SyntheticActor(motion=steady(60.0, 0.0), present=there)
    )
    assert perceived(trace).row * STEP == pytest.approx(5.05, abs=0.01)


def test_a_pause_shorter_than_the_evaluation_time_does_not_count() -> None:
    """It is out of sight behind a van that passes for less than 0.4 s."""
    passing = SyntheticActor(
        motion=steady(130.0, 3.0, 60.0, math.pi), id="van", length=6.0, width=WIDTH
    )
    walking = walker(steady(70.0, 9.0, 1.5, -math.pi / 2))
    alone = collision(steady(0.0, 0.0, 12.0), walking)
    both = collision(steady(0.0, 0.0, 12.0), walking, passing)
    assert before(both) == pytest.approx(before(alone), abs=1e-9)
