"""What would have avoided a collision, against the simulation: the same run with such an ego."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.interface import AccelerationControl, Control, Observation, PoseControl
from drivora_service.observations.run_view import RunView
from drivora_service.observations.trace import Trace
from drivora_service.oracles.avoidability.braking_evasion import instant_braking
from drivora_service.oracles.avoidability.careful_driver import GRAVITY, CarefulDriver
from drivora_service.oracles.avoidability.evasion import find_evasion
from drivora_service.oracles.avoidability.replayed_contact import cut_out
from drivora_service.oracles.collision import Collision
from drivora_service.oracles.verdict import Verdict
from drivora_service.scenario.model import Scenario, Waypoint, Weather
from tests.simulation.episodes import (
    Scripted,
    car,
    contacts,
    ego,
    network,
    obstacle,
    place,
    run,
    scenario,
    walker,
)

TOWN, ROAD = "signal-grid", "grand_1_1"
"""112 m of it, straight east."""
DRIVER = CarefulDriver()
SLIPPERY = Weather(precipitation_deposits=100.0)


def spot(s: float, right: float = 0.0, speed: float | None = None) -> Waypoint:
    return place(ROAD, s, on=TOWN, right=right, speed=speed)


def standing() -> Scenario:
    return drive(npc_obstacles=(obstacle(spot(95.0)),))


def on_a_slippery_road() -> Scenario:
    return replace(standing(), weather=SLIPPERY)


def crossing_walker() -> Scenario:
    """It is hit by the front's corner, 7 s after the start."""
    way = (spot(90.0, right=9.5, speed=1.4), spot(90.0, right=-4.0, speed=1.4))
    return drive(npc_walkers=(walker(*way),))


def slower_leader() -> Scenario:
    way = (spot(30.0, speed=5.0), spot(110.0, speed=5.0))
    return drive(npc_vehicles=(car(*way, behavior="replay"),))


def drive(**others: Any) -> Scenario:
    """An ego at 12 m/s, and others that do what they do whatever it does."""
    driver = ego(spot(5.0), spot(110.0), initial_speed=12.0)
    return scenario(driver, on=TOWN, seconds=14.0, **others)


def braking_from(row: int, friction: float) -> Scripted:
    """Keeps its speed; from a row on it does as the careful driver who sees the risk there."""
    full = DRIVER.full_braking(friction * GRAVITY, 100.0)

    def answer(observation: Observation) -> AccelerationControl:
        since = (observation.step + 0.5 - row) * 0.05 - DRIVER.delay
        return AccelerationControl(-min(max(DRIVER.jerk * since, 0.0), full), 0.0)

    return Scripted(answer)


def judged(trace: Trace) -> Verdict:
    (verdict,) = Collision().judge(RunView(trace, network(TOWN)))
    return verdict


@pytest.mark.parametrize(
    "make", [standing, on_a_slippery_road, crossing_walker, slower_leader], ids=lambda f: f.__name__
)
def test_braking_at_the_latest_moment_avoids_it_and_braking_later_does_not(
    make: Callable[[], Scenario],
) -> None:
    blind = run(make(), braking_from(10_000, 1.0))
    verdict = judged(blind)
    evidence = verdict.evidence["avoidability"]
    assert verdict.step is not None
    latest = verdict.step - round(evidence["latest_before"] / blind.step_length)
    assert latest > 0
    friction = blind.meta["friction"]
    assert contacts(run(make(), braking_from(latest, friction))) == []
    assert contacts(run(make(), braking_from(latest + 2, friction))) != []
    assert evidence["friction"] == friction


def test_a_trace_says_how_much_grip_the_road_had_and_how_far_could_be_seen() -> None:
    dry = run(standing(), braking_from(0, 1.0)).meta
    slippery = run(on_a_slippery_road(), braking_from(0, 0.4)).meta
    assert dry["friction"] == 1.0
    assert slippery["friction"] == pytest.approx(0.4)
    assert dry["perception_range"] >= 100.0


@pytest.mark.parametrize("weather", [Weather(), SLIPPERY], ids=["dry", "slippery"])
def test_an_evasion_can_be_driven_and_passes_what_braking_no_longer_avoids(
    weather: Weather,
) -> None:
    motorway = "highway"
    way = (place("eb_1_1", 5.0, on=motorway), place("eb_1_1", 300.0, on=motorway))
    what = scenario(
        ego(*way, initial_speed=25.0),
        on=motorway,
        seconds=14.0,
        weather=weather,
        npc_obstacles=(obstacle(place("eb_1_1", 150.0, on=motorway)),),
    )
    blind = run(what, braking_from(10_000, 1.0))
    grip = blind.meta["friction"] * GRAVITY
    (contact,) = blind.contacts
    view = RunView(blind, network(motorway)).egos[0]
    replay = cut_out(view, contact.step - view.first, contact.other)
    row = instant_braking(replay, grip, 100.0, 0) + 1
    poses = find_evasion(
        replay, network(motorway), row, grip=grip, brakes=8.0, wheelbase=2.9, max_steer=0.7
    )
    assert poses is not None

    def answer(observation: Observation) -> Control:
        ahead = observation.step - replay.first - row
        if ahead < 0:
            return AccelerationControl(0.0, 0.0)
        if ahead >= len(poses):
            return AccelerationControl(-8.0, 0.0)
        x, y, yaw = poses[ahead].tolist()
        return PoseControl(x, y, yaw)

    trace = run(what, Scripted(answer))
    assert contacts(trace) == []
    driven = trace.states[replay.first + row + 1 :][: len(poses), 0, :2]
    off = np.hypot(*(driven - poses[: len(driven), :2]).T)
    assert off.max() < 0.5
    # The grip that it took, over fifths of a second.
    velocity = np.diff(driven, axis=0)[::4] / trace.step_length
    took = np.hypot(*np.diff(velocity, axis=0).T) / (4 * trace.step_length)
    assert took.max() < 1.1 * grip
