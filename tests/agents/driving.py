"""Scenes that several ADSs drive, and what is asked of how they drive them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drivora_service.observations.trace import EgoCol, Light, TerminalEvent, Trace
from drivora_service.oracles.built_in import judge_all
from drivora_service.oracles.verdict import Oracle, Outcome
from drivora_service.scenario.model import LightTimes, Scenario, TrafficLights, Waypoint
from tests.simulation.episodes import ROAD, car, ego, network, place, scenario, speeds, track

GRID = "signal-grid"


def red_light_ahead() -> Scenario:
    """An ego that comes to a red light, which turns green."""
    return scenario(
        ego(place("grand_1_1", 30, on=GRID), place("grand_2_1", 60, on=GRID), initial_speed=8.0),
        on=GRID, traffic_lights=TrafficLights(times=LightTimes(offset=31.0)), seconds=60.0,
    )  # fmt: skip


def car_ahead(speed: float) -> Scenario:
    """An ego that comes up behind a car which stands in its lane, or drives slowly."""
    if speed == 0.0:
        npc = car(place("harbour_0_0", 70))
    else:
        npc = car(place("harbour_0_0", 40, speed=speed), place(ROAD, 100, speed=speed))
    start, end = place("harbour_0_0", 10), place(ROAD, 115)
    return scenario(ego(start, end, initial_speed=8.0), npc_vehicles=(npc,), seconds=30.0)


def assert_stops_at_red(trace: Trace, *, before_line: float = 4.0) -> NDArray[np.bool_]:
    """Asserts that the ego stood before the line at red and arrived; gives when it stood."""
    assert trace.ego_ends == (TerminalEvent.ARRIVED,)
    lights, distance = trace.ego_lights[:, 0], trace.ego_values[:, 0, EgoCol.LIGHT_DISTANCE]
    stands = (speeds(trace, "ego") < 0.1) & (trace.times > 3.0)
    assert (lights[stands] == Light.RED).sum() > 20
    assert 0.0 < distance[stands].min() <= distance[stands].max() < before_line
    return stands


def assert_keeps(trace: Trace, oracles: Sequence[Oracle]) -> None:
    """Asserts that no oracle was violated by an ego's fault."""
    broken = [
        f"{v.time}: {v.message}"
        for v in judge_all(trace, network(trace.network), oracles)
        if v.outcome is Outcome.VIOLATED and v.at_fault is not False
    ]
    assert not broken


def passes(trace: Trace, actor: str, point: Waypoint) -> float:
    """Returns the time at which an actor is nearest to a place, seconds."""
    way = track(trace, actor)
    return float(trace.times[int(np.nanargmin(np.hypot(way[:, 0] - point.x, way[:, 1] - point.y)))])
