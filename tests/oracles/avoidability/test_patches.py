"""Collisions on slippery patches are assessed by the grip at the place."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from drivora_service.metrics.ego_series import ego_series
from drivora_service.observations.recorded_conditions import PATCHES_KEY
from drivora_service.observations.trace import Trace
from drivora_service.oracles.avoidability.braking_evasion import latest_braking
from drivora_service.oracles.avoidability.careful_driver import GRAVITY
from drivora_service.oracles.avoidability.evasion import find_evasion
from drivora_service.oracles.responsibility.party import Party
from drivora_service.oracles.responsibility.required_braking import could_brake
from drivora_service.oracles.verdict import Answer
from tests.oracles.avoidability.collisions import (
    LENGTH,
    ROAD,
    STEP,
    assessed,
    collision,
    cut,
    standing_at,
    steady,
    view,
)


def icy(trace: Trace, x: float, length: float, friction: float, **more: float) -> Trace:
    patch = {"id": "ice", "x": x, "y": 0.0, "z": 0.0, "yaw": 0.0, "length": length, "width": 50.0}
    return replace(
        trace, meta={**trace.meta, PATCHES_KEY: [{**patch, "friction": friction, **more}]}
    )


def room_needed(trace: Trace) -> float:
    """Metres before the obstacle at 200 m from which full braking at once avoids it."""
    replay = cut(trace)
    latest = latest_braking(
        replay, delay=0.0, full=GRAVITY, grip=GRAVITY, jerk=math.inf, earliest=0
    )
    assert latest >= 0
    return 200.0 - float(replay.path[latest, 0])


SPEED = 15.0


def test_braking_on_a_patch_takes_the_way_of_its_grip() -> None:
    dry = collision(*standing_at(200.0, SPEED))
    assert room_needed(dry) == pytest.approx(SPEED**2 / (2.0 * GRAVITY), abs=1.0)
    everywhere = icy(dry, 100.0, 1000.0, 0.25)
    assert room_needed(everywhere) == pytest.approx(SPEED**2 / (0.5 * GRAVITY), abs=1.0)
    nowhere = icy(dry, 100.0, 1000.0, 0.25, z=8.0)
    assert room_needed(nowhere) == room_needed(dry)


def test_only_the_part_of_the_way_on_a_patch_is_slippery() -> None:
    """The last 20 m before the obstacle are ice: what is left there was braked off before."""
    friction = 0.25
    # The obstacle is 200 m before the front at the start: the centre stops there at 200 m.
    trace = icy(collision(*standing_at(200.0, SPEED)), 200.0, 40.0, friction)
    on_ice = 2.0 * friction * GRAVITY * 20.0
    before = (SPEED**2 - on_ice) / (2.0 * GRAVITY)
    assert room_needed(trace) == pytest.approx(20.0 + before, abs=1.2)


def test_a_collision_that_a_patch_made_unavoidable() -> None:
    """30 m before it, at 15 m/s, a vehicle is avoided on dry road and not on ice."""
    ego = steady(0.0, 0.0, SPEED)
    late = steady(LENGTH + 90.0, 0.0)
    dry = collision(ego, late)
    replay = cut(dry)
    row = round(60.0 / SPEED / STEP)

    def avoidable(trace: Trace) -> bool:
        found = cut(trace)
        return (
            latest_braking(
                found, delay=0.0, full=GRAVITY, grip=GRAVITY, jerk=math.inf, earliest=row
            )
            >= row
        )

    assert replay.contact > row
    assert avoidable(dry)
    assert not avoidable(icy(dry, 90.0, 100.0, 0.2))


def test_evidence_has_the_least_friction_under_the_ego() -> None:
    dry = collision(*standing_at(60.0, SPEED))
    assert assessed(dry).evidence["friction"] == 1.0
    assert assessed(icy(dry, 60.0, 20.0, 0.3)).evidence["friction"] == 0.3
    assert assessed(icy(dry, 500.0, 20.0, 0.3)).evidence["friction"] == 1.0
    # Before anything was to be seen, ice does not matter.
    assert assessed(icy(dry, -30.0, 20.0, 0.3)).evidence["friction"] == 1.0
    assert assessed(dry).avoidable is Answer.YES


def test_evasion_is_limited_by_the_grip_of_the_place() -> None:
    dry = collision(*standing_at(60.0, SPEED))

    def last(trace: Trace) -> int:
        replay = cut(trace)
        rows = [
            row
            for row in range(replay.contact)
            if find_evasion(
                replay, ROAD, row, grip=GRAVITY, brakes=8.5, wheelbase=2.8, max_steer=0.6
            )
            is not None
        ]
        return max(rows, default=-1)

    assert last(icy(dry, 40.0, 200.0, 0.2)) < last(dry) - 5


def test_the_series_has_the_grip_by_row() -> None:
    trace = icy(collision(*standing_at(60.0, SPEED)), 30.0, 20.0, 0.3)
    ego = view(trace)
    grip = ego_series(ego)["grip"].astype(float) / GRAVITY
    x = ego.states[:, 0]
    assert (grip[(x > 22.0) & (x < 38.0)] == pytest.approx(0.3)) is True
    assert (grip[(x < 18.0) | (x > 42.0)] == 1.0).all()


def test_a_party_on_ice_could_not_brake() -> None:
    trace = collision(*standing_at(40.0, 10.0))
    (contact,) = trace.contacts

    def could(trace: Trace) -> bool:
        parties = [
            Party(trace, ROAD, trace.actors[row], contact.step, speed)
            for row, speed in ((0, 10.0), (contact.other, 0.0))
        ]
        return could_brake(parties[0], parties[1], 0)

    assert could(trace)
    assert not could(icy(trace, 20.0, 80.0, 0.1))
    assert could(icy(trace, 400.0, 80.0, 0.1))
