"""The probability of a collision of DeepCollision, by hand-reckoned frames."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivora_service.feedback.collision_probability import collision_probability
from drivora_service.feedback.deepcollision import SAFETY, DeepcollisionFeedback
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Actor, Col, Role
from drivora_service.scenario.model import NpcObstacle
from tests.simulation.episodes import (
    ROAD,
    Blind,
    ego,
    network,
    obstacle,
    place,
    run,
    scenario,
    standing,
)

State = tuple[float, float, float, float]
"""x, y, heading and speed."""


def risk(mine: State, *others: tuple[State, Role], absent: tuple[int, ...] = ()) -> float:
    """The probability of one frame."""
    roles = [Role.EGO, *(role for _, role in others)]
    states = np.full((1, len(roles), len(Col)), 0.0)
    for row, (x, y, yaw, speed) in enumerate((mine, *(state for state, _ in others))):
        states[0, row, :5] = x, y, yaw, speed * math.cos(yaw), speed * math.sin(yaw)
    present = np.ones((1, len(roles)), dtype=np.bool_)
    for row in absent:
        present[0, row], states[0, row] = False, np.nan
    actors = tuple(
        Actor(row=row, id=f"{row}", role=role, model="m", length=4.0, width=2.0)
        for row, role in enumerate(roles)
    )
    return float(collision_probability(states, present, actors, 0)[0])


CAR, WALKER = Role.NPC_VEHICLE, Role.NPC_WALKER
EGO: State = (0.0, 0.0, 0.0, 12.0)


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        # One lane: |12² - 6²| / 6 / 2 + 5 = 14 m.
        (((7.0, 0.0, 0.0, 6.0), CAR), 0.5),
        (((14.0, 0.0, 0.0, 6.0), CAR), 0.0),
        (((-7.0, 0.0, 0.0, 6.0), CAR), 0.5),
        # A faster one: |12² - 18²| / 12 + 5 = 20 m.
        (((10.0, 0.5, 0.0, 18.0), CAR), 1.0 - math.hypot(10.0, 0.5) / 20.0),
        # The next lane: 5 m.
        (((0.0, 4.0, 0.0, 12.0), CAR), 0.2),
        (((3.0, 4.0, 0.0, 12.0), CAR), 0.0),
        # Across: 12² / 6 + 5 = 29 m; at 30° half of it, 17 m.
        (((0.0, 14.5, -math.pi / 2, 8.0), CAR), 0.5),
        (((0.0, 8.5, -math.radians(150.0), 8.0), CAR), 0.5),
        # A pedestrian ahead that goes along: 12² / 12 - 1.5² / 3 + 5 = 16.25 m; none behind.
        (((13.0, 0.0, 0.0, 1.5), WALKER), 0.2),
        (((-3.0, 0.0, 0.0, 1.5), WALKER), 0.0),
        # What stands on the lane stands in it whatever way it is turned: 17 m.
        (((8.5, 0.0, 1.0, 0.0), Role.NPC_OBSTACLE), 0.5),
    ],
)
def test_safety_distances(other: tuple[State, Role], expected: float) -> None:
    assert risk(EGO, other) == pytest.approx(expected)


def test_the_greatest_on_and_off_the_lane_count_together() -> None:
    ahead, near = ((7.0, 0.0, 0.0, 6.0), CAR), ((12.6, 0.0, 0.0, 6.0), CAR)
    beside, further = ((0.0, 4.0, 0.0, 12.0), CAR), ((0.0, -4.5, 0.0, 12.0), CAR)
    assert risk(EGO, ahead, near, beside, further) == pytest.approx(0.5 + 0.5 * 0.2)
    assert risk(EGO, ahead, near, beside, further, absent=(1, 3)) == pytest.approx(0.1 + 0.9 * 0.1)
    assert risk(EGO, ahead, absent=(0,)) == 0.0
    assert risk(EGO) == 0.0


def measured(*obstacles: NpcObstacle, drives: bool = True) -> float | None:
    what = scenario(ego(place(ROAD, 5), place(ROAD, 118)), npc_obstacles=obstacles, seconds=20.0)
    trace = run(what, Blind(8.0) if drives else standing())
    found = DeepcollisionFeedback().measure(RunView(trace, network()))
    return found.objectives[SAFETY]


def test_a_run_is_as_safe_as_its_riskiest_moment() -> None:
    assert measured() == 1.0
    assert measured(obstacle(place(ROAD, 60))) == 0.0
    aside = measured(obstacle(place(ROAD, 60, right=4.5)))
    assert aside is not None
    assert 0.0 < aside < 1.0
    assert measured(obstacle(place(ROAD, 60)), drives=False) == 1.0
