"""Planned motions are those of the episode, or are never behind them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.model import FrictionPatch, Scenario, Weather, WeatherChange
from drivora_service.simulation.followers.free_motion import plan_motions
from tests.simulation.episodes import (
    ROAD,
    car,
    network,
    obstacle,
    parked,
    place,
    row_of,
    run,
    scenario,
    standing,
    walker,
)


def crowded(behavior: str) -> Scenario:
    """Vehicles, one behind a standing one, walkers and obstacles."""
    return scenario(
        parked(),
        npc_vehicles=(
            car(place(ROAD, 10, speed=9.0), place(ROAD, 110, speed=4.0), behavior=behavior),
            car(
                place(ROAD, 40, speed=1.0),
                place(ROAD, 60, speed=1.0),
                name="slow",
                behavior=behavior,
                start_time=1.0,
            ),
            car(place(ROAD, 120), name="parked", behavior=behavior),
        ),
        npc_walkers=(
            walker(place(ROAD, 80, right=4.0), place(ROAD, 80, right=-4.0), start_time=2.5),
        ),
        npc_obstacles=(obstacle(place(ROAD, 95, right=3.0), start_time=3.0),),
    )


def changing(behavior: str) -> Scenario:
    """The same in weather that changes, on ice in places, and some of them join the run."""
    what = crowded(behavior)
    npc, slow, last = what.npc_vehicles
    (pedestrian,) = what.npc_walkers
    slower = tuple(place(ROAD, s, speed=v) for s, v in ((10, 9.0), (40, 9.0), (80, 2.0), (110, 2)))
    rain = Weather(precipitation=100.0, wetness=100.0, precipitation_deposits=100.0)
    return replace(
        what,
        npc_vehicles=(
            # Told how to brake, it plans by the grip of the time at which it joins.
            replace(npc, route=slower, deceleration=8.0, joins=True, start_time=1.52),
            slow,
            replace(last, joins=True),
        ),
        npc_walkers=(replace(pedestrian, joins=True),),
        friction_patches=(
            FrictionPatch(id="ice", location=place(ROAD, 36), length=2.0, width=8.0, friction=0.05),
        ),
        weather_changes=(
            WeatherChange(time=1.5, weather=rain),
            WeatherChange(time=4.0, weather=Weather()),
        ),
    )


def compared(what: Scenario) -> tuple[Trace, dict[str, tuple[np.ndarray, np.ndarray]]]:
    trace = run(what, standing())
    motions = plan_motions(what, network(), float(trace.times[-1]))
    assert [m.id for m in motions] == ["npc", "slow", "parked", "walker", "box"]
    return trace, {m.id: (m.poses, m.present) for m in motions}


@pytest.mark.parametrize("scene", [crowded, changing])
def test_actors_that_do_not_react_move_as_planned(scene: Callable[[str], Scenario]) -> None:
    trace, planned = compared(scene("replay"))
    for name, (poses, present) in planned.items():
        row = row_of(trace, name)
        assert np.array_equal(present, trace.present[:, row]), name
        recorded = trace.states[:, row, [Col.X, Col.Y, Col.YAW]]
        assert poses[present] == pytest.approx(recorded[present], abs=1e-9), name


def test_ice_and_the_weather_of_its_time_slow_what_joins() -> None:
    what = changing("replay")
    poses = {
        name: plan_motions(scene, network(), 9.0)[0].poses
        for name, scene in (
            ("told", what),
            ("dry", replace(what, weather_changes=())),
            ("bare", replace(what, friction_patches=())),
        )
    }
    assert not np.array_equal(poses["told"], poses["dry"], equal_nan=True)
    assert not np.array_equal(poses["told"], poses["bare"], equal_nan=True)


@pytest.mark.parametrize("scene", [crowded, changing])
def test_vehicles_that_react_are_never_further_than_planned(
    scene: Callable[[str], Scenario],
) -> None:
    trace, planned = compared(scene("reactive"))
    x, y, yaw = place(ROAD, 0).x, place(ROAD, 0).y, place(ROAD, 0).yaw or 0.0
    along = np.array([np.cos(yaw), np.sin(yaw)])
    behind = 0
    for name in ("npc", "slow"):
        poses, present = planned[name]
        both = present & trace.present[:, row_of(trace, name)]
        real = (trace.states[both, row_of(trace, name), :2] - (x, y)) @ along
        wanted = (poses[both, :2] - (x, y)) @ along
        assert (real <= wanted + 1e-6).all()
        behind += int((real < wanted - 1.0).sum())
    assert behind > 20, "one of them had to brake"
