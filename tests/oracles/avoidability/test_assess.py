from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Light, Role
from drivora_service.oracles.avoidability.careful_driver import GRAVITY, CarefulDriver
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Answer
from drivora_service.oracles.verdicts.accountability import Accountability, accountability
from drivora_service.testing.networks import CROSSING, EAST
from drivora_service.testing.traces import Motion, SyntheticActor
from tests.oracles.avoidability.collisions import (
    LENGTH,
    ROAD,
    STEP,
    assessed,
    collision,
    moving,
    standing_at,
    steady,
)
from tests.oracles.judging import on_lane

DRIVER = CarefulDriver()
TIME = np.arange(0.0, 20.0, STEP)


def cut_in(entry_gap: float, closing: float) -> tuple[Motion, Motion]:
    """A vehicle comes over from 3.5 m beside at 1.8 m/s and is in the way ``entry_gap`` m ahead."""
    begun = 6.0
    across = 3.5 - np.clip(1.8 * (TIME - begun), 0.0, 3.5)
    at_entry = begun + 1.7 / 1.8
    along = LENGTH + entry_gap + 25.0 * at_entry + (25.0 - closing) * (TIME - at_entry)
    return steady(0.0, 0.0, 25.0), moving(along, across, yaw=0.0)


def test_a_short_cut_in_on_a_wet_road_is_not_avoidable_and_counts_apart() -> None:
    """Enters 6 m ahead, 8 m/s slower, on a friction of 0.5: 0.75 s until the contact."""
    trace = collision(*cut_in(6.0, 8.0), friction=0.5)
    (verdict,) = Collision().judge(RunView(trace, ROAD))
    assert verdict.at_fault is False
    assert verdict.avoidable is Answer.NO
    assert accountability(verdict) is Accountability.NOT_AT_FAULT
    assert accountability(replace(verdict, at_fault=True)) is Accountability.UNAVOIDABLE


def test_a_cut_in_with_room_is_avoidable() -> None:
    trace = collision(*cut_in(28.0, 8.0), friction=0.5)
    (verdict,) = Collision().judge(RunView(trace, ROAD))
    assert verdict.avoidable is Answer.YES
    assert verdict.physically_avoidable is Answer.YES
    assert accountability(verdict) is Accountability.AVOIDABLE
    evidence = verdict.evidence["avoidability"]
    assert evidence["risk"] == "cutting_in"
    assert evidence["latest_before"] <= evidence["risk_perceived_before"]
    json.dumps(evidence, allow_nan=False)


@pytest.mark.parametrize(
    ("room", "answer"), [(0.5, Answer.YES), (-0.5, Answer.NO)], ids=["more", "less"]
)
@pytest.mark.parametrize("friction", [0.4, 1.0])
def test_what_appears_within_the_stopping_distance_is_not_avoidable(
    room: float, answer: Answer, friction: float
) -> None:
    """A vehicle is there from one row to the next, ``room`` metres beyond the stopping distance."""
    speed = 14.0
    distance = DRIVER.stopping_distance(speed, friction * GRAVITY) + room
    appears = 60
    obstacle = SyntheticActor(
        motion=steady(LENGTH + speed * appears * STEP + distance, 0.0),
        present=np.arange(400) >= appears,
    )
    found = assessed(collision(steady(0.0, 0.0, speed), obstacle, friction=friction))
    assert found.avoidable is answer


def test_what_braking_and_steering_avoid_beyond_the_drivers_delay_stands_beside() -> None:
    """18 m at 14 m/s: too late for the driver, 9.99 m of full braking without delay."""
    appears = 60
    obstacle = SyntheticActor(
        motion=steady(LENGTH + 14.0 * appears * STEP + 18.0, 0.0),
        present=np.arange(400) >= appears,
    )
    found = assessed(collision(steady(0.0, 0.0, 14.0), obstacle))
    assert (found.avoidable, found.physically_avoidable) == (Answer.NO, Answer.YES)


def test_a_walker_who_steps_out_late_and_one_who_can_be_seen_coming() -> None:
    def crossing(walked: float) -> SyntheticActor:
        """It is hit after it has walked for some seconds, at 1.5 m/s."""
        begun = 8.0 - walked
        across = -1.5 * walked + 1.5 * np.clip(TIME - begun, 0.0, None)
        place = np.full_like(TIME, 82.0)
        return SyntheticActor(
            motion=moving(place, across, yaw=np.pi / 2),
            role=Role.NPC_WALKER,
            length=0.5,
            width=0.5,
        )

    for walked, answer in ((1.2, Answer.NO), (3.5, Answer.YES)):
        found = assessed(collision(steady(0.0, 0.0, 10.0), crossing(walked)))
        assert found.avoidable is answer


def test_an_ego_that_ran_a_red_light_could_have_stopped_at_it() -> None:
    """The crossing vehicle was hidden until 1 s before; the light was red all along."""
    inside = TIME >= 5.0
    other = SyntheticActor(motion=steady(508.0, -5.4 * 8.0, 8.0, np.pi / 2), present=TIME > 4.6)
    for light, answer in ((Light.RED, Answer.YES), (Light.GREEN, Answer.NO)):
        ego = on_lane(
            motion=steady(447.75, 0.0, 10.0),
            lane=np.where(inside, CROSSING, EAST),
            light=light,
            light_distance=50.0 - 10.0 * TIME + 1e-6,
        )
        found = assessed(collision(ego, other))
        assert found.avoidable is answer
        assert found.evidence["own_breach"] == ("red_light" if light is Light.RED else None)


def test_an_ego_that_swerved_into_the_oncoming_lane_could_have_kept_its_own() -> None:
    """It comes over at 4 m/s when the oncoming vehicle is 2 s away: no driver could brake then."""
    across = np.clip(4.0 * (TIME - 5.0), 0.0, 7.0)
    ego = on_lane(motion=moving(15.0 * TIME, across, yaw=0.0), lane_lateral=across)
    found = assessed(collision(ego, steady(217.0, 7.0, 15.0, np.pi)))
    assert found.evidence["own_breach"] == "off_its_side"
    assert found.avoidable is Answer.YES


def test_without_the_grip_of_the_road_it_is_not_measurable() -> None:
    found = assessed(collision(*standing_at(60.0, 10.0), friction=None))
    assert found.avoidable is Answer.NOT_MEASURABLE
    assert found.physically_avoidable is Answer.NOT_MEASURABLE
    assert "grip" in found.evidence["not_measurable"]


def test_a_contact_in_the_first_row_is_not_measurable() -> None:
    found = assessed(collision(*standing_at(-1.0, 10.0)))
    assert found.avoidable is Answer.NOT_MEASURABLE
