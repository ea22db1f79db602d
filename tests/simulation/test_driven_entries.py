"""The speed with which vehicles enter that SUMO drives."""

from __future__ import annotations

import numpy as np
import pytest

from drivora_service.scenario.model import NpcVehicle
from tests.simulation.episodes import ROAD, car, contacts, ego, place, run, scenario, speeds

ASKED = 8.0


def entering(*others: NpcVehicle) -> np.ndarray:
    """The speeds of a vehicle that enters at 2 s, 20 m along the road, from that moment on."""
    enters = car(
        place(ROAD, 20, speed=ASKED),
        place(ROAD, 120, speed=ASKED),
        behavior="sumo",
        start_time=2.0,
    )
    trace = run(
        scenario(
            ego(place("-north_2_0", 10), place("-north_2_0", 130)),
            npc_vehicles=(enters, *others),
            seconds=6.0,
        )
    )
    assert not contacts(trace)
    found = speeds(trace, "npc")
    return found[np.isfinite(found)]


def parked(s: float) -> NpcVehicle:
    return car(place(ROAD, s), name="parked", behavior="replay")


@pytest.mark.parametrize("s", [115.0, 60.0])
def test_a_vehicle_that_stands_far_ahead_leaves_the_asked_speed(s: float) -> None:
    assert entering(parked(s))[0] == pytest.approx(ASKED)


def test_a_vehicle_that_stands_near_allows_what_is_safe() -> None:
    begin = entering(parked(30.0))
    assert 0.5 < begin[0] < 4.0
    # It comes to a stop behind it without braking hard.
    assert np.diff(begin).min() > -4.5 * 0.05
    assert begin[-1] < 0.5


def test_behind_a_moving_vehicle_it_begins_with_the_speed_of_that() -> None:
    ways = (place(ROAD, s, speed=3.0) for s in (60.0, 120.0))
    slow = car(*ways, name="slow", behavior="replay")
    assert entering(slow)[0] == pytest.approx(3.0, abs=0.05)


def test_on_an_empty_lane_it_begins_as_asked() -> None:
    assert entering()[0] == pytest.approx(ASKED)
