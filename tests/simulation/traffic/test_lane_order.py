"""SUMO's drivers see what stands or drives ahead of them, whatever has passed it on its lane."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drivora_service.observations.trace import TerminalEvent
from drivora_service.scenario.model import NpcVehicle
from tests.simulation.episodes import (
    car,
    closest,
    ego,
    place,
    run,
    scenario,
    speeds,
    standing,
    start,
    track,
)

LANE = "harbour_0_0"


def along(begin: float, end: float, speed: float, name: str, behavior: str) -> NpcVehicle:
    way = [place(LANE, s, speed=speed) for s in (*np.arange(begin, end, 10.0).tolist(), end)]
    return car(*way, name=name, behavior=behavior)


def driver(enters: float) -> NpcVehicle:
    return replace(along(10, 130, 8.0, "driver", "sumo"), start_time=enters)


@pytest.mark.parametrize("enters", [0.5, 5.0, 12.0])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_driver_stops_behind_a_wreck_that_another_vehicle_drove_through(
    enters: float, mirrored: bool
) -> None:
    """Whether SUMO knows of the passing as it happens or later, and whatever is there then."""
    egos = (
        ego(place(LANE, 80), place(LANE, 130), name="wreck"),
        ego(place("-north_2_0", 10), place("-north_2_0", 130), name="witness"),
    )
    through = along(30, 130, 12.0, "through", "replay")
    what = scenario(*egos, npc_vehicles=(through, driver(enters)), seconds=28.0)
    episode = start(what, standing(), standing(), mirrored=mirrored)
    while not episode.done:
        episode.step()
    trace = episode.finish()
    assert trace.ego_ends[0] is TerminalEvent.COLLISION
    assert speeds(trace, "driver")[-1] < 0.1
    assert 0.3 < closest(trace, "driver", "wreck") < 10.0


def test_a_driver_keeps_behind_a_slow_vehicle_that_a_fast_one_passed_on_its_lane() -> None:
    slow = along(50, 125, 2.0, "slow", "replay")
    fast = along(20, 130, 14.0, "fast", "replay")
    witness = ego(place("-north_2_0", 10), place("-north_2_0", 130))
    trace = run(scenario(witness, npc_vehicles=(slow, fast, driver(0.0)), seconds=20.0), standing())
    gaps = np.hypot(*(track(trace, "slow") - track(trace, "driver")).T)
    assert np.nanmin(gaps) > 4.0
    assert closest(trace, "driver", "slow") > 0.3
