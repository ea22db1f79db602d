"""Collisions are assessed by the grip and the sight of their time, as well as of their place."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import pytest

from drivora_service.metrics.ego_series import ego_series
from drivora_service.observations.recorded_conditions import CHANGES_KEY, PERCEPTION_RANGE
from drivora_service.observations.trace import Trace
from drivora_service.oracles.avoidability.braking_evasion import latest_braking
from drivora_service.oracles.avoidability.careful_driver import GRAVITY
from drivora_service.oracles.avoidability.evasion import find_evasion
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.required_braking import could_brake
from tests.oracles.avoidability.collisions import (
    ROAD,
    STEP,
    assessed,
    collision,
    cut,
    standing_at,
    view,
)
from tests.oracles.avoidability.test_patches import icy

SPEED = 15.0
DISTANCE = 200.0
"""Metres to the obstacle."""


def changed(trace: Trace, *changes: tuple[int, float], ranges: Mapping[int, float] = {}) -> Trace:
    """Lets the friction change at steps; the range of perception stays if none is given."""
    told = [
        {"step": step, "friction": friction, PERCEPTION_RANGE: ranges.get(step, 1000.0)}
        for step, friction in changes
    ]
    return replace(trace, meta={PERCEPTION_RANGE: 1000.0, **trace.meta, CHANGES_KEY: told})


def latest(trace: Trace) -> float:
    """Metres before the obstacle from which full braking at once avoids it."""
    replay = cut(trace)
    grip = replay.friction * GRAVITY
    row = latest_braking(replay, delay=0.0, full=grip, grip=grip, jerk=math.inf, earliest=0)
    assert row >= 0
    return DISTANCE - float(replay.path[row, 0])


def step_at(place: float) -> int:
    """The step in which an ego that does not brake is at a place."""
    return round(place / SPEED / STEP)


@pytest.mark.parametrize("before", [1.0, 0.5])
def test_braking_takes_the_way_of_the_grip_at_the_time(before: float) -> None:
    trace = collision(*standing_at(DISTANCE, SPEED), friction=before)
    needed = SPEED**2 / (2.0 * GRAVITY)
    assert latest(trace) == pytest.approx(needed / before, abs=1.0)
    # It has rained, or has dried, since long before.
    assert latest(changed(trace, (10, 0.25))) == pytest.approx(4.0 * needed, abs=1.0)
    assert latest(changed(trace, (10, 0.25), (20, 1.0))) == pytest.approx(needed, abs=1.0)
    # Once the ego stands it does not matter; before, it would.
    (contact,) = trace.contacts
    after = contact.step + round(9.0 / STEP)
    assert latest(changed(trace, (after, 0.01))) == latest(trace)
    assert latest(changed(trace, (contact.step + 1, 0.01))) > latest(trace) + 5.0


def test_rain_while_the_ego_would_brake_lengthens_the_rest_of_the_way() -> None:
    """Braking begins on the dry road 1 s before the rain: 9.81 m/s² until then, a quarter after."""
    dry = collision(*standing_at(DISTANCE, SPEED))
    speed = SPEED - GRAVITY
    needed = SPEED - 0.5 * GRAVITY + speed**2 / (0.5 * GRAVITY)
    at = step_at(DISTANCE - needed) + round(1.0 / STEP)
    assert latest(changed(dry, (at, 0.25))) == pytest.approx(needed, abs=0.8)


def test_of_a_patch_and_the_weather_the_lower_counts() -> None:
    """Rain leaves 0.5; the last 20 m have 0.25, which in snow (0.1) are not the worst any more."""
    dry = collision(*standing_at(DISTANCE, SPEED))
    patched = icy(dry, 200.0, 40.0, 0.25)
    rain = changed(patched, (10, 0.5))
    before = (SPEED**2 - 0.5 * GRAVITY * 20.0) / GRAVITY
    assert latest(rain) == pytest.approx(20.0 + before, abs=1.2)
    snow = changed(patched, (10, 0.1))
    assert latest(snow) == pytest.approx(SPEED**2 / (0.2 * GRAVITY), abs=1.2)
    assert latest(snow) == latest(changed(dry, (10, 0.1)))


def test_evasion_is_limited_by_the_grip_of_the_time() -> None:
    dry = collision(*standing_at(60.0, SPEED))

    def last(trace: Trace) -> int:
        replay = cut(trace)
        grip = replay.friction * GRAVITY
        rows = [
            row
            for row in range(replay.contact)
            if find_evasion(replay, ROAD, row, grip=grip, brakes=8.5, wheelbase=2.8, max_steer=0.6)
            is not None
        ]
        return max(rows, default=-1)

    wet = collision(*standing_at(60.0, SPEED), friction=0.2)
    assert last(changed(dry, (20, 0.2))) == last(wet) < last(dry) - 5
    # Rain that begins once the dry road has let the ego pass changes nothing.
    (contact,) = dry.contacts
    assert last(changed(dry, (contact.step + round(3.0 / STEP), 0.2))) == last(dry)


def test_evidence_and_series_have_the_friction_of_the_time() -> None:
    dry = collision(*standing_at(60.0, SPEED))
    (contact,) = dry.contacts
    rain = changed(dry, (contact.step - 10, 0.5))
    assert assessed(dry).evidence["friction"] == 1.0
    assert assessed(rain).evidence["friction"] == 0.5
    assert assessed(icy(rain, 60.0, 20.0, 0.3)).evidence["friction"] == 0.3
    assert assessed(icy(rain, 60.0, 20.0, 0.7)).evidence["friction"] == 0.5
    grip = ego_series(view(rain))["grip"].astype(float) / GRAVITY
    assert grip.tolist() == [1.0] * (contact.step - 10) + [0.5] * 11


def test_fog_hides_what_is_ahead_while_it_lasts() -> None:
    dry = collision(*standing_at(60.0, SPEED))
    (contact,) = dry.contacts
    step = contact.step - 20
    since = assessed(dry).evidence["risk_perceived_before"]
    assert since > 2.0
    fog = changed(dry, (0, 1.0), ranges={0: 25.0})
    assert assessed(fog).evidence["risk_perceived_before"] == pytest.approx(
        (25.0 - 4.5) / SPEED, abs=0.1
    )
    assert assessed(fog).evidence["was_hidden"]
    # It lifts one second before the contact.
    lifted = changed(dry, (0, 1.0), (step, 1.0), ranges={0: 5.0})
    assert assessed(lifted).evidence["risk_perceived_before"] == pytest.approx(1.0)
    # What was seen before fog comes up is known no longer than it lasts.
    comes = changed(dry, (step, 1.0), ranges={step: 25.0})
    assert assessed(comes).evidence["risk_perceived_before"] == since


def test_a_party_in_rain_could_not_brake() -> None:
    trace = collision(*standing_at(40.0, 10.0))
    (contact,) = trace.contacts

    def could(trace: Trace) -> bool:
        parties = [
            Party(trace, ROAD, trace.actors[row], contact.step, speed)
            for row, speed in ((0, 10.0), (contact.other, 0.0))
        ]
        return could_brake(parties[0], parties[1], 0)

    assert could(trace)
    assert not could(changed(trace, (5, 0.1)))
    assert could(changed(trace, (5, 0.8)))
    assert not could(changed(icy(trace, 20.0, 80.0, 0.1), (5, 0.8)))
