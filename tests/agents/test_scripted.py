"""The agent that drives as its document says."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from drivora_service.agents.catalogue import AgentCatalogue
from drivora_service.errors import AgentError
from drivora_service.observations.trace import Col, Trace
from drivora_service.scenario.model import AgentChoice, EgoVehicle
from tests.simulation.episodes import CAR, ROAD, network, place, run, scenario


def driven(trajectory: list[list[float]], seconds: float, speed: float) -> Trace:
    agent = AgentChoice(name="scripted", parameters={"trajectory": trajectory})
    vehicle = EgoVehicle(
        id="ego",
        model=CAR,
        route=(place(ROAD, 10.0), place(ROAD, 120.0)),
        initial_speed=speed,
        agent=agent,
    )
    return run(scenario(vehicle, seconds=seconds))


def on_road(s: float, left: float = 0.0) -> tuple[float, float]:
    x, y, yaw = network().lane(ROAD).position_at(s)
    return x - left * math.sin(yaw), y + left * math.cos(yaw)


def test_it_is_where_the_script_says_when_it_says() -> None:
    script = [[t, *on_road(10.0 + 8.0 * t, 0.5 * t)] for t in np.arange(0.0, 6.1, 0.5)]
    trace = driven(script, 6.0, 8.0)
    for time, x, y in script[1:-1]:
        row = round(time / trace.step_length)
        assert trace.states[row, 0, [Col.X, Col.Y]] == pytest.approx((x, y), abs=0.05)


def test_it_stays_at_the_last_place_with_its_heading() -> None:
    arcs = [10.0, 18.0, 24.0, 28.0, 30.0, 30.5]
    script = [[float(t), *on_road(s)] for t, s in enumerate(arcs)]
    trace = driven(script, 9.0, 8.0)
    assert trace.states[-1, 0, [Col.X, Col.Y]] == pytest.approx(on_road(30.5), abs=0.05)
    assert trace.speeds(0)[-40:] == pytest.approx(0.0, abs=0.01)
    heading = network().lane(ROAD).position_at(30.0)[2]
    assert trace.states[-1, 0, Col.YAW] == pytest.approx(heading, abs=0.02)


@pytest.mark.parametrize(
    ("trajectory", "found"),
    [
        ([[0.0, 1.0, 2.0]], "1 place"),
        ([[0.0, 1.0, 2.0], [0.0, 2.0, 2.0]], "do not ascend"),
        ([[0.0, 1.0]], "trajectory"),
        ("ahead", "trajectory"),
    ],
)
def test_a_script_that_cannot_be_driven_is_refused(trajectory: Any, found: str) -> None:
    with pytest.raises(AgentError, match=found) as failure:
        AgentCatalogue().create("scripted", {"trajectory": trajectory})
    assert failure.value.cause == "agent_parameters"
